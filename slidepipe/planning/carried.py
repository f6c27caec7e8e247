"""What the object asks of the arm beyond what it would if it were a part of the gripper.

The arm's table has gripper and object as one mass at the hand. But the object slides: while it does, it accelerates
otherwise than the hand, and its centre of mass is beside the contact. Light as the object is, the difference throws
the wrist off by some milliradians in a slide.
"""

import numpy as np

from slidepipe.mechanics.dynamics import GRAVITY, Block
from slidepipe.mechanics.planar import MotionPlane
from slidepipe.planning.course import Motion
from slidepipe.series import FloatArray


def carried_wrench(motion: Motion, block: Block, plane: MotionPlane) -> FloatArray:
    """Force and moment (T, 6) on the object at the contact, in the arm's base frame in N and N m.

    Without the force that a point mass in the contact would need, which is in the arm's table already.

    Examples
    --------
    >>> still = Motion(np.zeros(1), *np.zeros((6, 1, 3)), r_b=np.zeros((1, 3)), dr_b=np.zeros((1, 3)), load=np.zeros(1))
    >>> float(np.abs(carried_wrench(still, Block(0.02, 0.1, 0.06), MotionPlane(np.zeros(3), 0.0))).max())
    0.0
    """
    arm = motion.q_o[:, :2] - motion.q_f[:, :2]
    extra = block.m * (motion.ddq_o[:, :2] - motion.ddq_f[:, :2])
    whole = block.m * (motion.ddq_o[:, :2] + np.array([0.0, GRAVITY]))
    moment = block.inertia * motion.ddq_o[:, 2] + arm[:, 0] * whole[:, 1] - arm[:, 1] * whole[:, 0]
    nothing = np.zeros((len(arm), 1))
    force = np.concatenate([extra, nothing], axis=1) @ plane.axes.T
    return np.concatenate([force, moment[:, None] * plane.axes[:, 2]], axis=1)
