"""The arm's self-motion, compiled: its joints moving while the hand stays, and where on it a posture is nearest."""

import numpy as np
from numba import njit

LEAST_SLOPE = 0.25
"""Of the way to the posture beside that of a self-motion which does not curve: a step is at most four times as long."""


@njit(cache=True)
def towards_posture(jacobian, twist, away):
    """Newton's step, rad: onto the target (7,), and along the free direction (7,) to where it is square to the posture.

    ``jacobian`` (6, 7) is the hand's, velocities first, and ``twist`` (6,) leads from the hand to its target, both in
    one frame; ``away`` (7,) are the joint angles less those of the posture. The free direction n turns with the joints:
    from ``J n = 0`` follows ``dn = -J^+ dJ n``, and ``n . away = 0`` is solved to first order with that and the pose.
    """
    left, sizes, right = np.linalg.svd(jacobian)
    along = np.ascontiguousarray(right)
    free = along[6]
    multiplier = np.ascontiguousarray(left) @ ((along[:6] @ away) / sizes)
    onto_target = ((np.ascontiguousarray(left.T) @ twist) / sizes) @ along[:6]
    turned = np.empty(7)
    turning(jacobian, free, multiplier, turned)
    slope = max(1.0 - turned @ free, LEAST_SLOPE)
    return onto_target, free * ((turned @ onto_target - free @ away) / slope)


@njit(cache=True)
def turning(jacobian, free, multiplier, turned):
    """Fill ``turned`` (7,) with ``multiplier . dJ/dq_k n``: a joint turns the axes and levers of those after it."""
    before = np.zeros(3)
    after = np.zeros(3)
    for k in range(7):
        velocity, axis = jacobian[:3, k], jacobian[3:, k]
        # All joints together leave the hand where it is: what those from k on do is what those before it do, reversed.
        turned[k] = (
            triple(multiplier[3:], axis, -before)
            + triple(multiplier[:3], axis, after)
            + triple(multiplier[:3], before, velocity)
        )
        before += free[k] * axis
        after -= free[k] * velocity


@njit(cache=True)
def triple(a, b, c):
    """``a . (b x c)``."""
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
