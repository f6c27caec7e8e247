"""Limits are tightened where a plan broke them, and by as much."""

from dataclasses import replace

import numpy as np

from slidepipe.arm import wam
from slidepipe.planning.automatic import local_arm
from slidepipe.planning.planner import Plan
from slidepipe.planning.search import Task
from slidepipe.planning.tighten import TO_SPARE, tightened_arm, tightened_hand


def with_limits(plan: Plan, **limits: object) -> Plan:
    return replace(plan, setup=replace(plan.setup, limits=replace(plan.setup.limits, **limits)))


def test_only_what_was_broken_of_the_hands_limits_is_tightened(linear_plan: Plan) -> None:
    speed = float(np.max(np.linalg.norm(linear_plan.motion.dq_f[:, :2], axis=1)))
    broken = with_limits(linear_plan, tip_speed_m_s=speed / 1.1)
    within = tightened_hand(broken.setup, broken).limits
    np.testing.assert_allclose(within.tip_speed_m_s, TO_SPARE * speed / 1.1**2)
    assert within.stick_load == broken.setup.limits.stick_load
    assert within.hand_acceleration_m_s2 == broken.setup.limits.hand_acceleration_m_s2
    assert tightened_hand(linear_plan.setup, linear_plan) == linear_plan.setup


def test_only_what_was_broken_of_the_arms_limits_is_tightened(linear_plan: Plan) -> None:
    task = Task(np.zeros(3), linear_plan.course.r_start, linear_plan.course.r_goal, None)
    torque = np.max(np.abs(linear_plan.load.torque_n_m), axis=0)
    bound = np.where(np.arange(7) == 3, torque / 1.2, linear_plan.setup.limits.joint_torque_n_m)
    broken = with_limits(linear_plan, joint_torque_n_m=bound)
    arm = local_arm(task, broken.setup)
    tight = tightened_arm(arm, broken)
    np.testing.assert_allclose(tight.torque_n_m[3], TO_SPARE * arm.torque_n_m[3] / 1.2)
    others = np.arange(wam.JOINT_COUNT) != 3
    np.testing.assert_array_equal(tight.torque_n_m[others], arm.torque_n_m[others])
    np.testing.assert_array_equal(tight.speed_rad_s, arm.speed_rad_s)
