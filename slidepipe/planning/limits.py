"""Limits that name themselves: each check says what was reached, what is allowed, and when."""

from dataclasses import dataclass

import numpy as np

from slidepipe.arm import wam
from slidepipe.arm.dynamics import ArmLoad
from slidepipe.arm.inverse_kinematics import JointPath
from slidepipe.errors import InputError
from slidepipe.planning.three_phase import Motion, Regrasp
from slidepipe.series import FloatArray


@dataclass(frozen=True, slots=True)
class Limits:
    """What a motion may ask for.

    Attributes
    ----------
    workspace_centre_m : (2,)
        In {w}; the hand stays within ``workspace_radius_m`` of it.
    joint_speed_rad_s, joint_torque_n_m : (7,)
    tip_speed_m_s, elbow_speed_m_s : float
    stick_load : float
        Largest share of the friction that the sticking phases may use, below one.
    """

    workspace_centre_m: FloatArray
    workspace_radius_m: float
    joint_speed_rad_s: FloatArray
    joint_torque_n_m: FloatArray
    tip_speed_m_s: float
    elbow_speed_m_s: float
    stick_load: float = 1.0

    def __post_init__(self) -> None:
        for name in ("joint_speed_rad_s", "joint_torque_n_m"):
            if np.shape(getattr(self, name)) != (wam.JOINT_COUNT,):
                raise InputError(f"limits: {name} must be {wam.JOINT_COUNT} numbers, got {getattr(self, name)!r}")


@dataclass(frozen=True, slots=True)
class Check:
    """One limit: the value nearest to its bound, and when."""

    name: str
    value: float
    bound: float
    unit: str
    time_s: float

    @property
    def satisfied(self) -> bool:
        """Whether the value is within the bound."""
        return self.value <= self.bound

    def __str__(self) -> str:
        """One line for a person."""
        verdict = "within" if self.satisfied else "beyond"
        reached = f"{self.value:.4g} {self.unit} at t = {self.time_s:.3f} s"
        return f"{self.name}: {reached}, {verdict} {self.bound:.4g} {self.unit}"


def check_grasp(motion: Motion, regrasp: Regrasp, half_size_m: FloatArray, limits: Limits) -> list[Check]:
    """Sticking in phases 1 and 3, the contact on the object's face, and the hand's workspace and speed."""
    time_s, (_, t_slide, _, t_settle, _) = motion.time_s, regrasp.boundaries
    first, last = time_s < t_slide, time_s >= t_settle
    from_centre = np.linalg.norm(motion.q_f[:, :2] - limits.workspace_centre_m, axis=1)
    share = np.max(np.abs(motion.r_b[:, :2]) / half_size_m, axis=1)
    used = "share of the friction used while sticking"
    return [
        worst(f"{used} before the slide", time_s[first], motion.load[first], limits.stick_load, "of 1"),
        worst(f"{used} after the slide", time_s[last], motion.load[last], limits.stick_load, "of 1"),
        worst("contact point from the middle of the face to its edge", time_s, share, 1.0, "of 1"),
        worst("hand from the middle of the workspace", time_s, from_centre, limits.workspace_radius_m, "m"),
        worst("hand speed", time_s, np.linalg.norm(motion.dq_f[:, :2], axis=1), limits.tip_speed_m_s, "m/s"),
    ]


def check_arm(path: JointPath, load: ArmLoad, limits: Limits) -> list[Check]:
    """Joint ranges, speeds and torques, and the speed of the elbow."""
    lower, upper = np.array([link.range_rad for link in wam.LINKS]).T
    half = (upper - lower) / 2
    off_middle = np.abs(path.position_rad - (upper + lower) / 2)
    checks = []
    for quantity, values, bounds, unit in (
        ("angle from the middle of its range", off_middle, half, "rad"),
        ("speed", np.abs(path.velocity_rad_s), limits.joint_speed_rad_s, "rad/s"),
        ("torque", np.abs(load.torque_n_m), limits.joint_torque_n_m, "N m"),
    ):
        checks += [
            worst(f"joint {joint + 1} {quantity}", path.time_s, values[:, joint], float(bounds[joint]), unit)
            for joint in range(wam.JOINT_COUNT)
        ]
    return [
        *checks,
        worst("elbow speed", path.time_s, load.elbow_speed_m_s, limits.elbow_speed_m_s, "m/s"),
    ]


def worst(name: str, time_s: FloatArray, values: FloatArray, bound: float, unit: str) -> Check:
    """Check a quantity over time (T,) at its largest."""
    index = int(np.argmax(values))
    return Check(name, float(values[index]), bound, unit, float(time_s[index]))
