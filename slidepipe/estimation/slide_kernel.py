"""A pinched block under a hand that is a cubic spline: sticking and sliding as the contact decides, with derivatives.

Each step is the two-stage, second-order, stiffly accurate diagonally implicit Runge-Kutta rule, of the stages of
:mod:`slidepipe.estimation.stage_kernel`.

Columns of the derivatives: the hand's coefficients (axis by axis), the start (6), and the physics (4): log kappa,
log rho, growth of friction with speed (s/m), angle of gravity (rad). The start is the finger in {b} (3) where the
block sticks at first, else its pose and velocity (6).
"""

import numpy as np
from numba import njit

from slidepipe.estimation.stage_kernel import FAST, PHYSICS, START, stage, stage_derivatives, stage_matrices

GAMMA = 1.0 - 0.5 * 2.0**0.5
HELD = 1e3
"""By how much more a block that is held sticks than it slides."""


@njit(**FAST)
def spline_weights(s, out):
    """Weights of the four coefficients at the share s of a knot interval: value, and slope and curvature per interval.

    ``out`` is (3, 4).
    """
    r = 1.0 - s
    out[0, 0], out[0, 3] = r * r * r / 6.0, s * s * s / 6.0
    out[0, 1] = (3.0 * s * s * s - 6.0 * s * s + 4.0) / 6.0
    out[0, 2] = (3.0 * r * r * r - 6.0 * r * r + 4.0) / 6.0
    out[1, 0], out[1, 3] = -0.5 * r * r, 0.5 * s * s
    out[1, 1], out[1, 2] = 0.5 * s * (3.0 * s - 4.0), -0.5 * r * (3.0 * r - 4.0)
    out[2, 0], out[2, 1], out[2, 2], out[2, 3] = r, 3.0 * s - 2.0, 3.0 * r - 2.0, s


@njit(**FAST)
def interval_of(t, first, knot, count):
    """Index of the knot interval that holds t, of those that ``count`` coefficients span."""
    return min(max(int((t - first) / knot), 0), count - 4)


@njit(**FAST)
def hand_of(c, first, knot, t, w, out):
    """Pose and velocity (2, 3) of the hand at t; returns the first of its four coefficients, weights in ``w``."""
    low = interval_of(t, first, knot, c.shape[1])
    spline_weights((t - first) / knot - low, w)
    for axis in range(3):
        out[0, axis], out[1, axis] = 0.0, 0.0
        for j in range(4):
            out[0, axis] += w[0, j] * c[axis, low + j]
            out[1, axis] += w[1, j] * c[axis, low + j] / knot
    return low


@njit(**FAST)
def sticking_start(r, hand, w, low, knot, y, S):
    """State (6,) and derivatives (6, P) of a block that sticks to the hand with the finger at r (3,) in {b}."""
    count = (S.shape[1] - START - PHYSICS) // 3
    theta = hand[0, 2] - r[2]
    c, s = np.cos(theta), np.sin(theta)
    dx, dy, omega = c * r[0] - s * r[1], s * r[0] + c * r[1], hand[1, 2]
    y[0], y[1], y[2] = hand[0, 0] - dx, hand[0, 1] - dy, theta
    y[3], y[4], y[5] = hand[1, 0] + omega * dy, hand[1, 1] - omega * dx, omega
    S[:] = 0.0
    for j in range(4):
        value, slope = w[0, j], w[1, j] / knot
        column = low + j
        S[0, column], S[3, column] = value, slope
        column += count
        S[1, column], S[4, column] = value, slope
        column += count
        S[0, column], S[1, column], S[2, column] = dy * value, -dx * value, value
        S[3, column] = dy * slope + omega * dx * value
        S[4, column] = -dx * slope + omega * dy * value
        S[5, column] = slope
    at = 3 * count
    S[0, at], S[1, at], S[3, at], S[4, at] = -c, -s, omega * s, -omega * c
    S[0, at + 1], S[1, at + 1], S[3, at + 1], S[4, at + 1] = s, -c, omega * c, omega * s
    S[0, at + 2], S[1, at + 2], S[2, at + 2] = -dy, dx, -1.0
    S[3, at + 2], S[4, at + 2] = -omega * dx, -omega * dy


@njit(**FAST)
def slide(c, first, knot, y, S, opens, step, steps, held, physics, curve, times, pose, jacobian, path):
    """Carry a block from state y (6,) with derivatives S (6, P) through ``steps`` steps, in the ``held`` first stuck.

    ``pose`` (M, 3) and ``jacobian`` (M, 3, P) receive the block at the sorted ``times``, ``path`` (steps + 1, 7) the
    states and the sliding speed, negative where it sticks. A jacobian without rows is not computed.
    """
    wanted = len(jacobian) > 0
    w, hand, m = np.empty((3, 4)), np.empty((2, 3)), np.empty((8, 3, 3))
    middle, end, base = np.empty(6), np.empty(6), np.empty(6)
    columns = S.shape[1]
    old, S_middle, S_end = S.copy(), np.empty((6, columns)), np.empty((6, columns))
    rest, row = (1.0 - GAMMA) / GAMMA, 0
    path[0, :6], path[0, 6] = y, -1.0
    for index in range(steps):
        t, eta = opens + index * step, GAMMA * step
        hold = HELD if index < held else 1.0
        low = hand_of(c, first, knot, t + eta, w, hand)
        sliding = stage(y, hand, eta, physics, curve, hold, middle)
        if wanted:
            stage_matrices(middle, hand, eta, physics, curve, sliding, m)
            stage_derivatives(old, m, w, low, knot, eta, S_middle)
        for i in range(6):
            base[i] = y[i] + rest * (middle[i] - y[i])
        low = hand_of(c, first, knot, t + step, w, hand)
        sliding = stage(base, hand, eta, physics, curve, hold, end)
        if wanted:
            for i in range(6):
                for p in range(columns):
                    S_middle[i, p] = old[i, p] + rest * (S_middle[i, p] - old[i, p])
            stage_matrices(end, hand, eta, physics, curve, sliding, m)
            stage_derivatives(S_middle, m, w, low, knot, eta, S_end)
        while row < len(times) and (times[row] <= t + step or index == steps - 1):
            s = (times[row] - t) / step
            r = 1.0 - s
            h00, h10, h01, h11 = (1.0 + 2.0 * s) * r * r, s * r * r * step, s * s * (3.0 - 2.0 * s), -s * s * r * step
            for i in range(3):
                pose[row, i] = h00 * y[i] + h10 * y[3 + i] + h01 * end[i] + h11 * end[3 + i]
                if wanted:
                    for p in range(columns):
                        jacobian[row, i, p] = (
                            h00 * old[i, p] + h10 * old[3 + i, p] + h01 * S_end[i, p] + h11 * S_end[3 + i, p]
                        )
            row += 1
        y[:] = end
        if wanted:
            old, S_end = S_end, old
        path[index + 1, :6], path[index + 1, 6] = y, sliding
