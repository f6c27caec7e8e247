"""Torques and speeds of the nominal arm along a joint path."""

from dataclasses import dataclass

import mujoco
import numpy as np

from slidepipe.arm import wam
from slidepipe.arm.inverse_kinematics import JointPath
from slidepipe.arm.model import ELBOW
from slidepipe.series import FloatArray

FRICTION_SPEED_RAD_S = 0.02
"""Joint speed over which the compensation of dry friction changes its sign."""


@dataclass(frozen=True, slots=True)
class ArmLoad:
    """What a joint path asks of the arm.

    Attributes
    ----------
    torque_n_m : (T, 7)
        Inverse dynamics of the nominal arm with its joint friction, gravity included.
    feedforward_n_m : (T, 7)
        The part beyond gravity, taken in the middle of the tick that follows, over which it is held.
    elbow_speed_m_s : (T,)
        Speed of the point past the elbow where the vendor's safety module measures.
    """

    torque_n_m: FloatArray
    feedforward_n_m: FloatArray
    elbow_speed_m_s: FloatArray


def arm_load(model: mujoco.MjModel, path: JointPath) -> ArmLoad:
    """Torques and speeds along a path of evenly spaced samples."""
    half = 0.5 * (path.time_s[1] - path.time_s[0])
    q, dq, ddq = path.position_rad, path.velocity_rad_s, path.acceleration_rad_s2
    middle_q, middle_dq = q + half * dq + 0.5 * half**2 * ddq, dq + half * ddq
    still = np.zeros_like(q)
    torque = inverse_dynamics(model, q, dq, ddq) + _friction(dq)
    middle = inverse_dynamics(model, middle_q, middle_dq, ddq) + _friction(middle_dq)
    feedforward = middle - inverse_dynamics(model, middle_q, still, still)
    feedforward[-1] = 0.0
    return ArmLoad(torque, feedforward, elbow_speed(model, q, dq))


def inverse_dynamics(model: mujoco.MjModel, q: FloatArray, dq: FloatArray, ddq: FloatArray) -> FloatArray:
    """Torques (T, 7) of the arm without its joint friction, N m, for angles, speeds and accelerations (T, 7)."""
    data, torque = mujoco.MjData(model), np.empty_like(q)
    for index in range(len(q)):
        data.qpos[:], data.qvel[:], data.qacc[:] = q[index], dq[index], ddq[index]
        mujoco.mj_inverse(model, data)
        torque[index] = data.qfrc_inverse
    return torque


def _friction(dq: FloatArray) -> FloatArray:
    dry = np.array(wam.COULOMB_FRICTION) * np.tanh(dq / FRICTION_SPEED_RAD_S)
    return np.asarray(dry + np.array(wam.VISCOUS_FRICTION) * dq)


def elbow_speed(model: mujoco.MjModel, q: FloatArray, dq: FloatArray) -> FloatArray:
    """Speed (T,) of the point where the vendor's safety module measures, m/s, for joint angles and speeds (T, 7)."""
    data, jacobian, site = mujoco.MjData(model), np.empty((3, model.nv)), model.site(ELBOW).id
    speed = np.empty(len(q))
    for index in range(len(q)):
        data.qpos[:] = q[index]
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_jacSite(model, data, jacobian, None, site)
        speed[index] = np.linalg.norm(jacobian @ dq[index])
    return speed
