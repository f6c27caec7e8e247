"""The paper's two regrasps, Sections VIII-A and VIII-B, in plain values: what the rooms' tests start from."""

import numpy as np

from slidepipe.arm.model import Tool
from slidepipe.mechanics.dynamics import Block
from slidepipe.mechanics.limit_surface import SoftFinger
from slidepipe.mechanics.planar import MotionPlane
from slidepipe.planning.limits import Limits
from slidepipe.planning.planner import Setup
from slidepipe.planning.three_phase import Regrasp

FRICTION = 0.38
BLOCK = Block(length=0.06, width=0.1, m=0.023)

LIMITS = Limits(
    workspace_centre_m=np.zeros(2),
    workspace_radius_m=0.5,
    joint_speed_rad_s=np.array([4.0, 4.0, 5.0, 5.0, 6.0, 6.0, 12.0]),
    joint_torque_n_m=np.array([77.3, 160.6, 95.6, 29.4, 11.6, 11.6, 2.7]),
    tip_speed_m_s=3.0,
    elbow_speed_m_s=2.5,
)

LINEAR = Regrasp(
    q_o_start=np.zeros(3),
    r_start=np.array([-0.01, -0.02, np.pi]),
    r_goal=np.array([0.01, 0.02, np.pi]),
    q_f_end=np.array([0.01, 0.02, np.pi]),
    T1=0.3,
    T23=0.2,
    T4=1.1,
)
ROTATIONAL = Regrasp(
    q_o_start=np.zeros(3),
    r_start=np.array([-0.01, 0.04, 0.75 * np.pi]),
    r_goal=np.array([0.01, 0.04, np.pi]),
    q_f_end=np.array([0.01, 0.04, np.pi]),
    T1=0.3,
    T23=0.2,
    T4=0.3,
)


def linear_finger(friction: float = FRICTION, normal_force_n: float = 1.25) -> SoftFinger:
    """Section VIII-A's contact; 1.25 N in all, or 2.5 N for the paper's other reading."""
    return SoftFinger(mu=friction, f_N=normal_force_n, a=0.0174, c=0.6)


def rotational_finger(friction: float = FRICTION, normal_force_n: float = 2.5) -> SoftFinger:
    """Section VIII-B's contact; 2.5 N in all, or 5 N for the paper's other reading."""
    return SoftFinger(mu=friction, f_N=normal_force_n, a=0.05, c=0.6)


def linear_setup(finger: SoftFinger | None = None, limits: Limits = LIMITS) -> Setup:
    """Section VIII-A before the arm."""
    return Setup(
        block=BLOCK,
        finger=finger or linear_finger(),
        plane=MotionPlane(np.array([0.4, -0.4, 0.5]), np.pi / 2),
        tool=Tool(length_m=0.1, angle_rad=3.4),
        posture_rad=np.array([1.38, -1.06, -1.18, 1.98, 0.9, -0.37, -0.09]),
        limits=limits,
    )


def rotational_setup(finger: SoftFinger | None = None, limits: Limits = LIMITS) -> Setup:
    """Section VIII-B before the arm."""
    return Setup(
        block=BLOCK,
        finger=finger or rotational_finger(),
        plane=MotionPlane(np.array([0.65, 0.1, 0.4]), np.pi / 2),
        tool=Tool(length_m=0.1, angle_rad=3.7),
        posture_rad=np.array([0.72, 0.89, -1.09, 1.58, -0.24, -0.22, 0.0]),
        limits=limits,
    )
