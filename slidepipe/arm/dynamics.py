"""Torques and speeds of the nominal arm along a joint path."""

from dataclasses import dataclass, replace

import mujoco
import numpy as np

from slidepipe.arm import wam
from slidepipe.arm.inverse_kinematics import JointPath
from slidepipe.arm.model import ELBOW, HAND
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
        The part beyond gravity over the tick that follows (:func:`middles`), in which it is held.
    elbow_speed_m_s : (T,)
        Speed of the point past the elbow where the vendor's safety module measures.
    """

    torque_n_m: FloatArray
    feedforward_n_m: FloatArray
    elbow_speed_m_s: FloatArray


@dataclass(frozen=True, slots=True)
class HandWrench:
    """Force and moment (T, 6) at the hand in the base frame, N and N m: at the samples, and half a tick after each."""

    at_sample: FloatArray
    in_middle: FloatArray


def arm_load(model: mujoco.MjModel, path: JointPath) -> ArmLoad:
    """Torques and speeds along a path of evenly spaced samples."""
    middle = middles(path)
    q, dq, still = path.position_rad, path.velocity_rad_s, np.zeros_like(path.position_rad)
    torque = inverse_dynamics(model, q, dq, path.acceleration_rad_s2) + _friction(dq)
    moving = inverse_dynamics(
        model, middle.position_rad, middle.velocity_rad_s, middle.acceleration_rad_s2
    ) + _friction(middle.velocity_rad_s)
    resting = inverse_dynamics(model, middle.position_rad, still, still)
    feedforward = moving - resting
    feedforward[-1] = 0.0
    return ArmLoad(torque, feedforward, elbow_speed(model, q, dq))


def middles(path: JointPath) -> JointPath:
    """Motion in the middle of the tick that follows each sample; at rest after the last.

    The acceleration is the tick's mean, for it may jump within the tick.
    """
    q, dq = path.position_rad, path.velocity_rad_s
    ahead_q, ahead_dq = np.concatenate([q[1:], q[-1:]]), np.concatenate([dq[1:], dq[-1:]])
    tick_s = path.time_s[1] - path.time_s[0]
    return JointPath(path.time_s + 0.5 * tick_s, 0.5 * (q + ahead_q), 0.5 * (dq + ahead_dq), (ahead_dq - dq) / tick_s)


def with_wrench(load: ArmLoad, model: mujoco.MjModel, path: JointPath, wrench: HandWrench) -> ArmLoad:
    """The same with a wrench that the hand also has to exert."""
    torque = load.torque_n_m + _hand_torque(model, path.position_rad, wrench.at_sample)
    extra = _hand_torque(model, middles(path).position_rad, wrench.in_middle)
    extra[-1] = 0.0
    return ArmLoad(torque, load.feedforward_n_m + extra, load.elbow_speed_m_s)


def beside_joint_control(load: ArmLoad, path: JointPath) -> ArmLoad:
    """The same with what the vendor's joint control adds by itself taken off the feedforward."""
    return replace(load, feedforward_n_m=load.feedforward_n_m - lag_torque(path))


def lag_torque(path: JointPath) -> FloatArray:
    """Torque (T, 7) in N m that the vendor's joint control adds along a path which is followed exactly.

    It compares the wanted speed with a measured one that is low-passed, and so late. Left in, it throws a wrist that
    reverses within 30 ms off by 12 mrad, and passes for missing mass where the arm is identified.
    """
    tick_s = float(path.time_s[1] - path.time_s[0])
    new = 1.0 - float(np.exp(-wam.VELOCITY_FILTER_RAD_S * tick_s))
    raw = np.diff(path.position_rad, axis=0, prepend=path.position_rad[:1]) / tick_s
    # A loop, for importing scipy.signal would take longer than finding a plan does.
    late, before = np.empty_like(raw), np.zeros(raw.shape[1])
    for index, measured in enumerate(raw):
        late[index] = before = before + new * (measured - before)
    return np.asarray(np.array(wam.KD) * (path.velocity_rad_s - late))


def _hand_torque(model: mujoco.MjModel, q: FloatArray, wrench: FloatArray) -> FloatArray:
    """Torques (T, 7) by the transposed Jacobian of the hand."""
    data, site = mujoco.MjData(model), model.site(HAND).id
    jacobian, torque = np.empty((6, model.nv)), np.empty_like(q)
    for index in range(len(q)):
        data.qpos[:] = q[index]
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_jacSite(model, data, jacobian[:3], jacobian[3:], site)
        torque[index] = wrench[index] @ jacobian
    return torque


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
