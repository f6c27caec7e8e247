"""Limits that a plan broke where its search did not look, tightened by as much for the next search."""

from dataclasses import replace

import numpy as np

from slidepipe.arm import wam
from slidepipe.arm.local_model import LocalModel
from slidepipe.planning.planner import Plan, Setup
from slidepipe.series import FloatArray

WHOLE_RANGE_RAD = np.array([0.5 * (link.range_rad[1] - link.range_rad[0]) for link in wam.LINKS])
TO_SPARE = 0.97
"""Of a limit that was broken; much less, and the search ends elsewhere."""


def tightened_arm(arm: LocalModel, chosen: Plan) -> LocalModel:
    """The local model with the limits that the arm itself broke tightened by as much."""
    limits, joints = chosen.setup.limits, chosen.joints
    off = np.max(np.abs(joints.position_rad - arm.middle_rad), axis=0)
    speed = np.max(np.abs(joints.velocity_rad_s), axis=0)
    acceleration = np.max(np.abs(joints.acceleration_rad_s2), axis=0)
    torque = np.max(np.abs(chosen.load.torque_n_m), axis=0)
    elbow = np.max(chosen.load.elbow_speed_m_s)
    return arm.tightened(
        half=_factor(off, WHOLE_RANGE_RAD),
        speed=_factor(speed, limits.joint_speed_rad_s),
        acceleration=_factor(acceleration, limits.joint_acceleration_rad_s2),
        torque=_factor(torque, limits.joint_torque_n_m),
        elbow=float(_factor(np.array([elbow]), np.array([limits.elbow_speed_m_s]))[0]),
    )


def tightened_hand(setup: Setup, chosen: Plan) -> Setup:
    """The setup with the limits of hand and grip that a plan broke between the search's nodes tightened by as much."""
    limits, motion, course = chosen.setup.limits, chosen.motion, chosen.course
    sticking = (motion.time_s < course.slide_s) | (motion.time_s >= course.stop_s)
    reached = np.array([
        np.max(motion.load[sticking]),
        np.max(np.linalg.norm(motion.dq_f[:, :2], axis=1)),
        np.max(np.linalg.norm(motion.ddq_f[:, :2], axis=1)),
    ])  # fmt: skip
    bounds = np.array([limits.stick_load, limits.tip_speed_m_s, limits.hand_acceleration_m_s2])
    load, speed, acceleration = _factor(reached, bounds)
    within = setup.limits
    tightened = replace(
        within,
        stick_load=float(load) * within.stick_load,
        tip_speed_m_s=float(speed) * within.tip_speed_m_s,
        hand_acceleration_m_s2=float(acceleration) * within.hand_acceleration_m_s2,
    )
    return replace(setup, limits=tightened)


def _factor(reached: FloatArray, bound: FloatArray) -> FloatArray:
    return np.where(reached > bound, TO_SPARE * bound / reached, 1.0)
