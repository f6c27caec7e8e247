"""The arm near one pose of the hand, to first order: what a motion in the plane asks of each joint, for a sum.

A search asks it thousands of times where the arm itself is asked once.
"""

from dataclasses import dataclass, replace

import mujoco
import numpy as np

from slidepipe.arm import wam
from slidepipe.arm.inverse_kinematics import HandPath, InverseKinematics
from slidepipe.arm.model import ELBOW
from slidepipe.mechanics.planar import MotionPlane
from slidepipe.series import FloatArray

STEP = 1e-4
"""Of the hand, m and rad, for the joints' rates."""


@dataclass(frozen=True, slots=True)
class LocalModel:
    """First order about a pose of the hand.

    Attributes
    ----------
    pose : (3,)
        Of the hand in {w}, m and rad.
    angles_rad : (7,)
    rates : (7, 3)
        Joint rates for the hand's rates along x, y and about the normal.
    torques : (7, 3)
        Joint torques for its accelerations, N m.
    weight_n_m : (7,)
        Torques that hold the arm still.
    elbow : (3, 3)
        Velocity of the elbow's point for the hand's rates.
    middle_rad, half_rad, speed_rad_s, acceleration_rad_s2, torque_n_m : (7,)
        Middle and half of the joints' ranges, and their limits.
    elbow_speed_m_s : float
    """

    pose: FloatArray
    angles_rad: FloatArray
    rates: FloatArray
    torques: FloatArray
    weight_n_m: FloatArray
    elbow: FloatArray
    middle_rad: FloatArray
    half_rad: FloatArray
    speed_rad_s: FloatArray
    acceleration_rad_s2: FloatArray
    torque_n_m: FloatArray
    elbow_speed_m_s: float

    def rows(self) -> FloatArray:
        """(19, 7) as the compiled search reads it."""
        elbow = np.zeros((3, 7))
        elbow[:, :3] = self.elbow
        pose = np.array([*self.pose, self.elbow_speed_m_s, 0.0, 0.0, 0.0])
        return np.ascontiguousarray(
            np.vstack(
                [self.rates.T, self.torques.T, elbow, pose, self.angles_rad, self.weight_n_m, wam.COULOMB_FRICTION,
                 wam.VISCOUS_FRICTION, self.middle_rad, self.half_rad, self.speed_rad_s, self.acceleration_rad_s2,
                 self.torque_n_m]
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
    poses = np.vstack([pose, pose + STEP * np.eye(3)])
    path = HandPath(np.zeros(4), *plane.lift(poses))
    kinematics.approach(path)
    angles = kinematics.solve(path)
    rates = (angles[1:] - angles[0]).T / STEP
    data, jacobian = mujoco.MjData(model), np.empty((3, model.nv))
    data.qpos[:] = angles[0]
    mujoco.mj_inverse(model, data)
    weight = data.qfrc_inverse.copy()
    inertia = np.empty((model.nv, model.nv))
    mujoco.mj_fullM(model, data, inertia)
    mujoco.mj_jacSite(model, data, jacobian, None, model.site(ELBOW).id)
    lower, upper = np.array([link.range_rad for link in wam.LINKS]).T
    return LocalModel(
        pose=np.asarray(pose, dtype=float),
        angles_rad=angles[0],
        rates=rates,
        torques=inertia @ rates,
        weight_n_m=weight,
        elbow=jacobian @ rates,
        middle_rad=(upper + lower) / 2,
        half_rad=(upper - lower) / 2,
        speed_rad_s=np.asarray(speed_rad_s, dtype=float),
        acceleration_rad_s2=np.asarray(acceleration_rad_s2, dtype=float),
        torque_n_m=np.asarray(torque_n_m, dtype=float),
        elbow_speed_m_s=elbow_speed_m_s,
    )
