"""Limits that name themselves: each check says what was reached, what is allowed, and when."""

from dataclasses import dataclass, field

import numpy as np

from slidepipe.arm import wam
from slidepipe.arm.dynamics import ArmLoad
from slidepipe.arm.inverse_kinematics import JointPath
from slidepipe.errors import InputError
from slidepipe.mechanics.planar import rotation
from slidepipe.mechanics.stepping import PlacedFinger
from slidepipe.planning.course import Course, CourseMotion, Motion
from slidepipe.series import FloatArray

ALIKE = 1e-12
DIGITS = (4, 6, 9, 17)
"""With which a value is told: more where it would look like the bound that it breaks."""
JUMP_S = 1e-8
"""Just before a boundary: beyond what counts as rounding."""
JUMP, AT_REST = 1e-4, 1e-9
"""What a hand that turns as fast as a wrist can may do in that time, and what a hand at rest may do."""


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
    hand_acceleration_m_s2 : float
    joint_acceleration_rad_s2 : (7,)
    region_centre_m : (2,)
        Where in {w} the hand is to come to rest, within ``region_radius_m``.
    """

    workspace_centre_m: FloatArray
    workspace_radius_m: float
    joint_speed_rad_s: FloatArray
    joint_torque_n_m: FloatArray
    tip_speed_m_s: float
    elbow_speed_m_s: float
    stick_load: float = 1.0
    hand_acceleration_m_s2: float = np.inf
    joint_acceleration_rad_s2: FloatArray = field(default_factory=lambda: np.full(wam.JOINT_COUNT, np.inf))
    region_centre_m: FloatArray = field(default_factory=lambda: np.zeros(2))
    region_radius_m: float = np.inf

    def __post_init__(self) -> None:
        for name in ("joint_speed_rad_s", "joint_torque_n_m", "joint_acceleration_rad_s2"):
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
        digits = next(n for n in DIGITS if self.satisfied or f"{self.value:.{n}g}" != f"{self.bound:.{n}g}")
        reached = f"{self.value:.{digits}g} {self.unit} at t = {self.time_s:.3f} s"
        return f"{self.name}: {reached}, {verdict} {self.bound:.{digits}g} {self.unit}"


def check_grasp(
    motion: Motion, course: Course, fingers: tuple[PlacedFinger, ...], half_size_m: FloatArray, limits: Limits
) -> list[Check]:
    """Sticking in phases 1 and 3, the contacts on the object's face, the hand's workspace, speed and acceleration."""
    time_s = motion.time_s
    first, last = time_s < course.slide_s, time_s >= course.stop_s
    from_centre = np.linalg.norm(motion.q_f[:, :2] - limits.workspace_centre_m, axis=1)
    used = "share of the friction used while sticking"
    checks = [
        worst(f"{used} before the slide", time_s[first], motion.load[first], limits.stick_load, "of 1"),
        worst(f"{used} after the slide", time_s[last], motion.load[last], limits.stick_load, "of 1"),
        worst(
            "contact point from the middle of the face to its edge",
            time_s,
            _face_share(motion.r_b, fingers, half_size_m),
            1.0,
            "of 1",
        ),
        worst("hand from the middle of the workspace", time_s, from_centre, limits.workspace_radius_m, "m"),
        worst("hand speed", time_s, np.linalg.norm(motion.dq_f[:, :2], axis=1), limits.tip_speed_m_s, "m/s"),
    ]
    if np.isfinite(limits.hand_acceleration_m_s2):
        size = np.linalg.norm(motion.ddq_f[:, :2], axis=1)
        checks.append(worst("hand acceleration", time_s, size, limits.hand_acceleration_m_s2, "m/s^2"))
    if np.isfinite(limits.region_radius_m):
        off = np.linalg.norm(motion.q_f[-1:, :2] - limits.region_centre_m, axis=1)
        checks.append(
            worst("hand at rest from the middle of its region", time_s[-1:], off, limits.region_radius_m, "m")
        )
    return checks


def check_continuity(motion: CourseMotion) -> list[Check]:
    """That the hand begins and ends at rest, and that neither its place nor its velocity jumps between phases."""
    edges = motion.course.boundaries
    ends = motion.sample(edges[[0, -1]])
    before, after = motion.sample(edges[1:] - JUMP_S), motion.sample(edges[1:])
    return [
        worst("hand speed at rest", edges[[0, -1]], np.max(np.abs(ends.dq_f), axis=1), AT_REST, "m/s or rad/s"),
        worst("jump in the hand's pose", edges[1:], np.max(np.abs(after.q_f - before.q_f), axis=1), JUMP, "m or rad"),
        worst(
            "jump in the hand's velocity", edges[1:], np.max(np.abs(after.dq_f - before.dq_f), axis=1), JUMP,
            "m/s or rad/s",
        ),
    ]  # fmt: skip


def _face_share(r_b: FloatArray, fingers: tuple[PlacedFinger, ...], half_size_m: FloatArray) -> FloatArray:
    """How far out on the face (T,) the outermost finger is: one at its edge."""
    places = np.array([placed.place for placed in fingers])
    at = r_b[:, None, :2] + np.einsum("tij,nj->tni", rotation(r_b[:, 2])[:, :2, :2], places)
    return np.asarray(np.max(np.abs(at) / half_size_m, axis=(1, 2)))


def check_arm(path: JointPath, load: ArmLoad, limits: Limits) -> list[Check]:
    """Joint ranges, speeds and torques, and the speed of the elbow."""
    lower, upper = np.array([link.range_rad for link in wam.LINKS]).T
    half = (upper - lower) / 2
    off_middle = np.abs(path.position_rad - (upper + lower) / 2)
    checks = []
    for quantity, values, bounds, unit in (
        ("angle from the middle of its range", off_middle, half, "rad"),
        ("speed", np.abs(path.velocity_rad_s), limits.joint_speed_rad_s, "rad/s"),
        ("acceleration", np.abs(path.acceleration_rad_s2), limits.joint_acceleration_rad_s2, "rad/s^2"),
        ("torque", np.abs(load.torque_n_m), limits.joint_torque_n_m, "N m"),
    ):
        if not np.all(np.isfinite(bounds)):
            continue
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
    # The first of those that are alike but for rounding.
    index = int(np.argmax(values >= np.max(values) * (1.0 - ALIKE)))
    return Check(name, float(values[index]), bound, unit, float(time_s[index]))
