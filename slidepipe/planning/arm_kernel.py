"""What a motion asks of the arm, compiled: shares of its limits by its local model."""

import numpy as np
from numba import njit

from slidepipe.planning.profile_kernel import FAST

RATES, CURVATURE, MASS, ELBOW_RATES = 0, 3, 9, 16
POSE, ANGLES, WEIGHT, DRY, VISCOUS, MIDDLE, HALF, SPEED, ACCELERATION, TORQUE, ARM_ROWS = range(19, 30)
"""Rows of the arm's local model. The first are blocks: rates along x, y and about the normal; their rates along xx, yy,
tt, xy, xt and yt; the mass matrix; the elbow's Jacobian. A limit's row holds one over it."""
FAR_M, FAR_RAD = 0.15, 0.4
"""From the local model's pose."""
OFF_ANGLE, OFF_SPEED, OFF_ACCELERATION, OFF_TORQUE, OFF_ELBOW, OFFSETS = range(6)
"""Rows of what the local model misses at a node: the arm's own values, along a motion that was followed, less its."""


@njit(**FAST)
def arm_values(arm, row, values):
    """What the local model alone says of a node: ``values`` (OFFSETS, 7) of angle, speed, acceleration and torque.

    ``arm`` (ARM_ROWS, 7) is what :func:`slidepipe.arm.local_model.rows` makes; the elbow's speed stands first in its
    row.
    """
    x, y, t = row[9] - arm[POSE, 0], row[10] - arm[POSE, 1], row[11] - arm[POSE, 2]
    v_x, v_y, v_t, a_x, a_y, a_t = row[12], row[13], row[14], row[15], row[16], row[17]
    # Farther away the rates stay as they are there: second order is worse than first order far off.
    n_x, n_y, n_t = min(max(x, -FAR_M), FAR_M), min(max(y, -FAR_M), FAR_M), min(max(t, -FAR_RAD), FAR_RAD)
    w_x, w_y, w_t = v_x * (n_x == x), v_y * (n_y == y), v_t * (n_t == t)
    xx, yy, tt, xy, xt, yt = w_x * w_x, w_y * w_y, w_t * w_t, 2.0 * w_x * w_y, 2.0 * w_x * w_t, 2.0 * w_y * w_t
    for i in range(arm.shape[1]):
        along, across, about = arm[RATES, i], arm[RATES + 1, i], arm[RATES + 2, i]
        c_xx, c_yy, c_tt = arm[CURVATURE, i], arm[CURVATURE + 1, i], arm[CURVATURE + 2, i]
        c_xy, c_xt, c_yt = arm[CURVATURE + 3, i], arm[CURVATURE + 4, i], arm[CURVATURE + 5, i]
        d_x, d_y, d_t = (
            c_xx * n_x + c_xy * n_y + c_xt * n_t,
            c_xy * n_x + c_yy * n_y + c_yt * n_t,
            c_xt * n_x + c_yt * n_y + c_tt * n_t,
        )
        g_x, g_y, g_t = along + d_x, across + d_y, about + d_t
        moved = g_x * x + g_y * y + g_t * t - 0.5 * (d_x * n_x + d_y * n_y + d_t * n_t)
        values[OFF_ANGLE, i] = arm[ANGLES, i] + moved
        values[OFF_SPEED, i] = g_x * v_x + g_y * v_y + g_t * v_t
        bent = c_xx * xx + c_yy * yy + c_tt * tt + c_xy * xy + c_xt * xt + c_yt * yt
        values[OFF_ACCELERATION, i] = g_x * a_x + g_y * a_y + g_t * a_t + bent
        values[OFF_TORQUE, i] = arm[WEIGHT, i]
    for k in range(arm.shape[1]):
        change = values[OFF_ACCELERATION, k]
        for i in range(arm.shape[1]):
            values[OFF_TORQUE, i] += arm[MASS + k, i] * change
    total = 0.0
    for axis in range(3):
        v = 0.0
        for i in range(arm.shape[1]):
            v += arm[ELBOW_RATES + axis, i] * values[OFF_SPEED, i]
        total += v * v
    values[OFF_ELBOW, 0] = np.sqrt(total)


@njit(**FAST)
def arm_share(arm, offsets, row, values):
    """Largest share of a joint's range, speed, acceleration or torque, or of the elbow's speed, that a node asks."""
    arm_values(arm, row, values)
    worst = (values[OFF_ELBOW, 0] + offsets[OFF_ELBOW, 0]) * arm[POSE, 3]
    for joint in range(arm.shape[1]):
        q = values[OFF_ANGLE, joint] + offsets[OFF_ANGLE, joint] - arm[MIDDLE, joint]
        speed = abs(values[OFF_SPEED, joint] + offsets[OFF_SPEED, joint])
        change = abs(values[OFF_ACCELERATION, joint] + offsets[OFF_ACCELERATION, joint])
        torque = abs(values[OFF_TORQUE, joint] + offsets[OFF_TORQUE, joint])
        torque += arm[DRY, joint] + arm[VISCOUS, joint] * speed
        worst = max(worst, abs(q) * arm[HALF, joint], speed * arm[SPEED, joint])
        worst = max(worst, change * arm[ACCELERATION, joint], torque * arm[TORQUE, joint])
    return worst
