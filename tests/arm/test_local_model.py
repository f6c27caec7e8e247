"""The arm's local model beside the arm itself."""

import numpy as np
import pytest
from paper_cases import linear_setup

from slidepipe.arm.inverse_kinematics import HandPath, InverseKinematics, joint_path
from slidepipe.arm.local_model import local_model
from slidepipe.arm.model import nominal_model
from slidepipe.planning import arm_kernel

SETUP = linear_setup()
MODEL = nominal_model(SETUP.tool)
POSE = np.array([0.01, 0.02, np.pi])
VELOCITY, ACCELERATION = np.array([0.3, 0.4, 0.5]), np.array([3.0, -4.0, 6.0])


def path(time_s: np.ndarray) -> HandPath:
    """A hand that passes near the model's pose at t = 0.05 s."""
    t = np.asarray(time_s)[:, None] - 0.05
    poses = POSE + np.array([0.02, -0.01, 0.05]) + t * VELOCITY + 0.5 * t**2 * ACCELERATION
    return HandPath(np.asarray(time_s), *SETUP.plane.lift(poses))


def test_angles_and_their_rates_are_those_of_the_arm_closely() -> None:
    limits = SETUP.limits
    arm = local_model(
        MODEL,
        InverseKinematics(MODEL, SETUP.posture_rad),
        SETUP.plane,
        POSE,
        speed_rad_s=limits.joint_speed_rad_s,
        acceleration_rad_s2=limits.joint_acceleration_rad_s2,
        torque_n_m=limits.joint_torque_n_m,
        elbow_speed_m_s=limits.elbow_speed_m_s,
    )
    time_s = np.array([0.0, 0.05, 0.1])
    exact = joint_path(InverseKinematics(MODEL, SETUP.posture_rad), path, time_s, time_s[[0, -1]])
    row = np.concatenate([np.zeros(9), POSE + np.array([0.02, -0.01, 0.05]), VELOCITY, ACCELERATION])
    told = np.zeros((arm_kernel.OFFSETS, 7))
    arm_kernel.arm_values(arm.rows(), row, told)
    np.testing.assert_allclose(told[arm_kernel.OFF_ANGLE], exact.position_rad[1], atol=4e-3)
    np.testing.assert_allclose(told[arm_kernel.OFF_SPEED], exact.velocity_rad_s[1], atol=0.1)
    np.testing.assert_allclose(told[arm_kernel.OFF_ACCELERATION], exact.acceleration_rad_s2[1], atol=2.0)


def test_limits_are_tightened_evenly() -> None:
    arm = local_model(
        MODEL,
        InverseKinematics(MODEL, SETUP.posture_rad),
        SETUP.plane,
        POSE,
        speed_rad_s=np.full(7, 4.0),
        acceleration_rad_s2=np.full(7, np.inf),
        torque_n_m=np.full(7, 10.0),
        elbow_speed_m_s=2.5,
    )
    tight, none = arm.tightened_evenly(0.5), np.zeros((arm_kernel.OFFSETS, 7))
    row = np.concatenate([np.zeros(9), POSE, [0.1, 0.1, 0.0], np.zeros(3)])
    share, tighter = (arm_kernel.arm_share(one.rows(), none, row, np.empty_like(none)) for one in (arm, tight))
    assert tighter == pytest.approx(2.0 * share, rel=1e-9)
