"""The arm near one pose of the hand, to second order: what a motion in the plane asks of each joint, for a sum.

A search asks it thousands of times where the arm itself is asked once.
"""

from dataclasses import dataclass, replace

import mujoco
import numpy as np

from slidepipe.arm import wam
from slidepipe.arm.inverse_kinematics import HandPath, InverseKinematics
from slidepipe.arm.model import ELBOW
from slidepipe.errors import InfeasibleError
from slidepipe.mechanics.planar import MotionPlane
from slidepipe.series import FloatArray

STEPS = ((0.04, 0.04, 0.2), (0.003, 0.003, 0.01), (1e-4, 1e-4, 1e-4))
"""Of the hand, m and rad, for the joints' rates and how they change: about as far as a motion goes, else nearer."""


@dataclass(frozen=True, slots=True)
class LocalModel:
    """Second order about a pose of the hand for the joints' angles, and the arm's mass and weight there.

    Attributes
    ----------
    pose : (3,)
        Of the hand in {w}, m and rad.
    angles_rad : (7,)
    rates : (7, 3)
        Joint rates for the hand's rates along x, y and about the normal.
    curvature : (7, 6)
        How those rates change along xx, yy, tt, xy, xt and yt; those with a turn are zero, for a hand turns so far
        that first order is nearer the truth.
    mass : (7, 7)
        Mass matrix, kg m^2.
    weight_n_m : (7,)
        Torques that hold the arm still.
    elbow : (3, 7)
        Velocity of the elbow's point for the joints' rates.
    middle_rad, half_rad, speed_rad_s, acceleration_rad_s2, torque_n_m : (7,)
        Middle and half of the joints' ranges, and their limits.
    elbow_speed_m_s : float
    """

    pose: FloatArray
    angles_rad: FloatArray
    rates: FloatArray
    curvature: FloatArray
    mass: FloatArray
    weight_n_m: FloatArray
    elbow: FloatArray
    middle_rad: FloatArray
    half_rad: FloatArray
    speed_rad_s: FloatArray
    acceleration_rad_s2: FloatArray
    torque_n_m: FloatArray
    elbow_speed_m_s: float

    def rows(self) -> FloatArray:
        """(30, 7) as the compiled search reads it: one over each limit."""
        pose = np.array([*self.pose, 1.0 / self.elbow_speed_m_s, 0.0, 0.0, 0.0])
        return np.ascontiguousarray(
            np.vstack(
                [self.rates.T, self.curvature.T, self.mass, self.elbow, pose, self.angles_rad, self.weight_n_m,
                 wam.COULOMB_FRICTION, wam.VISCOUS_FRICTION, self.middle_rad, 1.0 / self.half_rad,
                 1.0 / self.speed_rad_s, 1.0 / self.acceleration_rad_s2, 1.0 / self.torque_n_m]
            )
        )  # fmt: skip

    def tightened(
        self,
        *,
        half: FloatArray,
        speed: FloatArray | float = 1.0,
        acceleration: FloatArray | float = 1.0,
        torque: FloatArray | float = 1.0,
        elbow: float = 1.0,
    ) -> "LocalModel":
        """The same with limits multiplied, where the first order was too hopeful."""
        return replace(
            self,
            speed_rad_s=self.speed_rad_s * speed,
            acceleration_rad_s2=self.acceleration_rad_s2 * acceleration,
            torque_n_m=self.torque_n_m * torque,
            elbow_speed_m_s=self.elbow_speed_m_s * elbow,
            half_rad=self.half_rad * half,
        )

    def tightened_evenly(self, share: float) -> "LocalModel":
        """The same with all limits multiplied."""
        return self.tightened(half=np.full(7, share), speed=share, acceleration=share, torque=share, elbow=share)


def local_model(
    model: mujoco.MjModel,
    kinematics: InverseKinematics,
    plane: MotionPlane,
    pose: FloatArray,
    *,
    speed_rad_s: FloatArray,
    acceleration_rad_s2: FloatArray,
    torque_n_m: FloatArray,
    elbow_speed_m_s: float,
) -> LocalModel:
    """Build the local model about a pose (3,) of the hand in {w}; the limits are those of its joints and its elbow.

    Raises
    ------
    InfeasibleError
        The pose is out of reach.
    """
    near = _joints_near(kinematics, plane, np.asarray(pose, dtype=float))
    data, jacobian = mujoco.MjData(model), np.empty((3, model.nv))
    data.qpos[:] = near.angles_rad
    mujoco.mj_inverse(model, data)
    weight = data.qfrc_inverse.copy()
    inertia = np.empty((model.nv, model.nv))
    mujoco.mj_fullM(model, data, inertia)
    mujoco.mj_jacSite(model, data, jacobian, None, model.site(ELBOW).id)
    lower, upper = np.array([link.range_rad for link in wam.LINKS]).T
    return LocalModel(
        pose=np.asarray(pose, dtype=float),
        angles_rad=near.angles_rad,
        rates=near.rates,
        curvature=near.curvature,
        mass=inertia,
        weight_n_m=weight,
        elbow=jacobian,
        middle_rad=(upper + lower) / 2,
        half_rad=(upper - lower) / 2,
        speed_rad_s=np.asarray(speed_rad_s, dtype=float),
        acceleration_rad_s2=np.asarray(acceleration_rad_s2, dtype=float),
        torque_n_m=np.asarray(torque_n_m, dtype=float),
        elbow_speed_m_s=elbow_speed_m_s,
    )


@dataclass(frozen=True, slots=True)
class _Joints:
    """Joint angles (7,) at a pose, their rates (7, 3) and how those change (7, 6)."""

    angles_rad: FloatArray
    rates: FloatArray
    curvature: FloatArray


def _joints_near(kinematics: InverseKinematics, plane: MotionPlane, pose: FloatArray) -> _Joints:
    """Joints about a pose by differences over the longest step at which all poses can be reached."""
    refusals = []
    for step in STEPS:
        try:
            return _differences(kinematics, plane, pose, np.array(step))
        except InfeasibleError as refusal:
            refusals.append(refusal)
    raise refusals[-1]


def _differences(kinematics: InverseKinematics, plane: MotionPlane, pose: FloatArray, step: FloatArray) -> _Joints:
    moves = np.diag(step)
    poses = pose + np.vstack([np.zeros(3), moves, -moves, moves[0] + moves[1]])
    path = HandPath(np.zeros(len(poses)), *plane.lift(poses))
    kinematics.approach(path)
    middle, *rest = kinematics.solve(path)
    ahead, behind, across = np.array(rest[:3]), np.array(rest[3:6]), rest[6]
    curvature = np.zeros((len(middle), 6))
    curvature[:, :2] = ((ahead + behind - 2.0 * middle) / step[:, None] ** 2).T[:, :2]
    curvature[:, 3] = (across - ahead[0] - ahead[1] + middle) / (step[0] * step[1])
    return _Joints(middle, ((ahead - behind) / (2.0 * step[:, None])).T, curvature)
