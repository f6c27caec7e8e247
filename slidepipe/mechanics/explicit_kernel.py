"""One explicit step of a slide, of order eight (Dormand and Prince's, as scipy has it): for slides that are fast."""

import numpy as np
from numba import njit
from scipy.integrate import DOP853

from slidepipe.mechanics.curve_kernel import support
from slidepipe.mechanics.hand_kernel import FAST, hand_velocity, piece_of

GRAVITY = 9.81
STAGES = DOP853.n_stages
A, B, C, E3, E5 = (np.ascontiguousarray(table) for table in (DOP853.A, DOP853.B, DOP853.C, DOP853.E3, DOP853.E5))
STABLE = 5.0
"""Longest stable step, in times in which the direction of the friction settles."""


@njit(**FAST)
def sliding_friction(curve, force, rho, d_x, d_y, d_w):
    """Friction of a sliding velocity, eq. (14): of an ellipsoid if ``curve`` is None; zero where it does not slide."""
    if d_x == 0.0 and d_y == 0.0 and d_w == 0.0:
        return 0.0, 0.0, 0.0
    if curve is None:
        share = force / np.sqrt(d_x * d_x + d_y * d_y + rho * rho * d_w * d_w)
        return share * d_x, share * d_y, share * rho * rho * d_w
    _, g1, g2, g3 = support(curve, d_x, d_y, rho * d_w)
    return force * g1, force * g2, force * rho * g3


@njit(**FAST)
def slide_rate(hand, body, t, near, y, rate):
    """Rate of the sliding state at a time in or after piece ``near``, eqs. (18) to (21)."""
    h0, h1, h2 = hand_velocity(hand[0], hand[1], body[4], t, near)
    c, s = np.cos(y[2]), np.sin(y[2])
    r_x, r_y = c * y[0] - s * y[1], s * y[0] + c * y[1]
    d_x = h0 - y[3] + y[5] * r_y
    d_y = h1 - y[4] - y[5] * r_x
    d_w = h2 - y[5]
    f_x, f_y, moment = sliding_friction(body[7], body[2], body[3], d_x, d_y, d_w)
    rate[0] = c * d_x + s * d_y
    rate[1] = -s * d_x + c * d_y
    rate[2] = y[5]
    rate[3] = f_x / body[0]
    rate[4] = f_y / body[0] - GRAVITY
    rate[5] = (moment + r_x * f_y - r_y * f_x) / body[1]


@njit(**FAST)
def stable_step(body, y, speed):
    """Longest step that is stable at a sliding speed, with spin counted by rho."""
    arm = y[0] * y[0] + y[1] * y[1] + body[3] * body[3]
    return STABLE * speed / (body[2] * (1.0 / body[0] + arm / body[1]))


@njit(**FAST)
def explicit_step(hand, body, tolerance, scales, t, y, h, work, new):
    """Step from y at t into ``new``; ``work[0]`` holds the rate at t, and the last row then that after the step.

    Returns the error over ``tolerance * scales``.
    """
    near = piece_of(hand[0], t)
    for stage in range(1, STAGES):
        combine(A[stage], stage, y, h, work, new)
        slide_rate(hand, body, t + C[stage] * h, near, new, work[stage])
    combine(B, STAGES, y, h, work, new)
    slide_rate(hand, body, t + h, near, new, work[STAGES])
    five, three = 0.0, 0.0
    for i in range(6):
        e5, e3 = 0.0, 0.0
        for j in range(STAGES + 1):
            e5 += E5[j] * work[j, i]
            e3 += E3[j] * work[j, i]
        scale = 1.0 / (tolerance * scales[i])
        five += (e5 * scale) ** 2
        three += (e3 * scale) ** 2
    if five == 0.0 and three == 0.0:
        return 0.0
    return h * five / np.sqrt((five + 0.01 * three) * 6.0)


@njit(**FAST)
def combine(weights, stages, y, h, work, new):
    """``y`` plus h times a weighted sum of the rates so far."""
    n0, n1, n2, n3, n4, n5 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for j in range(stages):
        w = weights[j]
        if w != 0.0:
            n0 += w * work[j, 0]
            n1 += w * work[j, 1]
            n2 += w * work[j, 2]
            n3 += w * work[j, 3]
            n4 += w * work[j, 4]
            n5 += w * work[j, 5]
    new[0], new[1], new[2] = y[0] + h * n0, y[1] + h * n1, y[2] + h * n2
    new[3], new[4], new[5] = y[3] + h * n3, y[4] + h * n4, y[5] + h * n5
