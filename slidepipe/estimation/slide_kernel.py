"""A pinched block under a hand that is a cubic spline: sticking and sliding as the contact decides, with derivatives.

Each step is the two-stage, second-order, stiffly accurate diagonally implicit Runge-Kutta rule. A stage is the contact
problem of :mod:`slidepipe.mechanics.contact_kernel`, so a slide begins, turns and ends without being told when, and
however slow it is; the derivatives of a stage follow from its own linear equations, three unknowns at a time.

Columns of the derivatives: the hand's coefficients (axis by axis), the start (6), and the physics (4): log kappa,
log rho, growth of friction with speed (s/m), angle of gravity (rad). The start is the finger in {b} (3) where the
block sticks at first, else its pose and velocity (6).
"""

import numpy as np
from numba import njit

from slidepipe.mechanics.contact_kernel import contact_force

FAST = {"cache": True, "error_model": "numpy", "fastmath": {"contract", "arcp", "nsz", "reassoc"}}
GAMMA = 1.0 - 0.5 * 2.0**0.5
START, PHYSICS = 6, 4
SLOWEST = 1e-9
"""Sliding slower than this has no direction, m/s."""
ROUNDS, SETTLED = 12, 1e-11


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
def _inverse(m, out):
    a = m[1, 1] * m[2, 2] - m[1, 2] * m[2, 1]
    b = m[1, 2] * m[2, 0] - m[1, 0] * m[2, 2]
    c = m[1, 0] * m[2, 1] - m[1, 1] * m[2, 0]
    d = 1.0 / (m[0, 0] * a + m[0, 1] * b + m[0, 2] * c)
    out[0, 0], out[1, 0], out[2, 0] = a * d, b * d, c * d
    out[0, 1] = (m[0, 2] * m[2, 1] - m[0, 1] * m[2, 2]) * d
    out[1, 1] = (m[0, 0] * m[2, 2] - m[0, 2] * m[2, 0]) * d
    out[2, 1] = (m[0, 1] * m[2, 0] - m[0, 0] * m[2, 1]) * d
    out[0, 2] = (m[0, 1] * m[1, 2] - m[0, 2] * m[1, 1]) * d
    out[1, 2] = (m[0, 2] * m[1, 0] - m[0, 0] * m[1, 2]) * d
    out[2, 2] = (m[0, 0] * m[1, 1] - m[0, 1] * m[1, 0]) * d


@njit(**FAST)
def _product(a, b, out):
    for i in range(3):
        for j in range(3):
            out[i, j] = a[i, 0] * b[0, j] + a[i, 1] * b[1, j] + a[i, 2] * b[2, j]


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
def _stage(y, hand, eta, physics, new):
    """Solve one stage from y (6,) for ``new`` (6,); returns the size of the sliding velocity, negative if it sticks.

    ``physics`` is kappa, rho, m/I, growth, g_x, g_y.
    """
    kappa, rho, per_i, growth = physics[0], physics[1], physics[2], physics[3]
    vx, vy = y[3] + eta * physics[4], y[4] + eta * physics[5]
    dx, dy = hand[0, 0] - y[0] - eta * y[3], hand[0, 1] - y[1] - eta * y[4]
    size, sliding, k = 0.0, -1.0, 0.0
    for _ in range(ROUNDS):
        fx, fy, mz, k = contact_force(
            None,
            eta,
            eta * per_i,
            kappa * (1.0 + growth * size),
            rho,
            dx,
            dy,
            hand[1, 0] - vx + y[5] * dy,
            hand[1, 1] - vy - y[5] * dx,
            hand[1, 2] - y[5],
            k,
        )
        new[3], new[4] = vx + eta * fx, vy + eta * fy
        new[5] = y[5] + eta * per_i * (mz + dx * fy - dy * fx)
        new[0], new[1], new[2] = y[0] + eta * new[3], y[1] + eta * new[4], y[2] + eta * new[5]
        nx, ny = hand[0, 0] - new[0], hand[0, 1] - new[1]
        moved = abs(nx - dx) + abs(ny - dy)
        dx, dy = nx, ny
        sx, sy = hand[1, 0] - new[3] + new[5] * dy, hand[1, 1] - new[4] - new[5] * dx
        sz = rho * (hand[1, 2] - new[5])
        size = np.sqrt(sx * sx + sy * sy + sz * sz)
        sliding = size if k > 0.0 else -1.0
        if moved < SETTLED:
            break
    return sliding


@njit(**FAST)
def _stage_matrices(new, hand, eta, physics, sliding, m):
    """Matrices of a stage's derivatives, in ``m`` (8, 3, 3).

    The change of the new velocity is m[0] times that of the old, m[1] of the old pose, m[2] of the hand's pose, m[3]
    of its velocity; the columns of m[4] belong to the physics but the last, and the first of m[5] to that.
    """
    kappa, rho, per_i, growth = physics[0], physics[1], physics[2], physics[3]
    dx, dy, omega = hand[0, 0] - new[0], hand[0, 1] - new[1], new[5]
    spin = hand[1, 2] - omega
    m[:] = 0.0
    by_v, by_d, left, inverse = m[6], m[7], m[5], m[0]
    by_v[0, 0], by_v[1, 1], by_v[2, 2] = -1.0, -1.0, -rho
    by_v[0, 2], by_v[1, 2] = dy, -dx
    by_d[0, 1], by_d[1, 0] = omega, -omega
    if sliding < 0.0:
        for i in range(3):
            for j in range(3):
                left[i, j] = by_v[i, j] - eta * by_d[i, j]
        _inverse(left, inverse)
        for i in range(3):
            for j in range(3):
                scale = rho if j == 2 else 1.0
                m[3, i, j] = -inverse[i, j] * scale
                m[1, i, j] = inverse[i, 0] * by_d[0, j] + inverse[i, 1] * by_d[1, j]
                m[2, i, j] = -m[1, i, j]
        m[0] = 0.0
        m[5] = 0.0
        return
    size = max(sliding, SLOWEST)
    ux, uy, uz = (
        (hand[1, 0] - new[3] + omega * dy) / size,
        (hand[1, 1] - new[4] - omega * dx) / size,
        rho * spin / size,
    )
    force = kappa * (1.0 + growth * size)
    fx, fy, fz = force * ux, force * uy, force * uz
    across, along = force / size, kappa * growth
    b, e, eb, scratch = np.empty((3, 3)), np.zeros((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    u = (ux, uy, uz)
    for i in range(3):
        for j in range(3):
            b[i, j] = (along - across) * u[i] * u[j] + (across if i == j else 0.0)
    e[0, 0], e[1, 1] = 1.0, 1.0
    e[2, 0], e[2, 1], e[2, 2] = -per_i * dy, per_i * dx, per_i * rho
    _product(e, b, eb)
    _product(eb, by_d, m[2])
    m[2, 2, 0] += per_i * fy
    m[2, 2, 1] -= per_i * fx
    _product(eb, by_v, scratch)
    for i in range(3):
        for j in range(3):
            left[i, j] = (1.0 if i == j else 0.0) - eta * scratch[i, j] + eta * eta * m[2, i, j]
    _inverse(left, inverse)
    # Right-hand sides, then all times the inverse.
    for i in range(3):
        scratch[i, 0] = e[i, 0] * fx + e[i, 1] * fy + e[i, 2] * fz
        scratch[i, 1] = rho * eb[i, 2] * spin + (per_i * rho * fz if i == 2 else 0.0)
        scratch[i, 2] = kappa * size * (e[i, 0] * ux + e[i, 1] * uy + e[i, 2] * uz)
        eb[i, 2] *= rho
    _scaled_product(inverse, m[2], eta, b)
    m[2] = b
    m[1] = -b
    _scaled_product(inverse, eb, eta, m[3])
    _scaled_product(inverse, scratch, eta, m[4])
    m[5] = 0.0
    for i in range(3):
        m[5, i, 0] = eta * (-inverse[i, 0] * physics[5] + inverse[i, 1] * physics[4])


@njit(**FAST)
def _scaled_product(a, b, scale, out):
    for i in range(3):
        for j in range(3):
            out[i, j] = scale * (a[i, 0] * b[0, j] + a[i, 1] * b[1, j] + a[i, 2] * b[2, j])


@njit(**FAST)
def _stage_derivatives(S, m, w, low, knot, eta, new):
    """Derivatives (6, P) after a stage from those before it."""
    count = (S.shape[1] - START - PHYSICS) // 3
    columns = S.shape[1]
    for p in range(columns):
        q0, q1, v0, v1, v2 = S[0, p], S[1, p], S[3, p], S[4, p], S[5, p]
        for i in range(3):
            new[3 + i, p] = m[0, i, 0] * v0 + m[0, i, 1] * v1 + m[0, i, 2] * v2 + m[1, i, 0] * q0 + m[1, i, 1] * q1
    for axis in range(3):
        for j in range(4):
            p = axis * count + low + j
            value, slope = w[0, j], w[1, j] / knot
            for i in range(3):
                new[3 + i, p] += m[2, i, axis] * value + m[3, i, axis] * slope
    for i in range(3):
        for j in range(3):
            new[3 + i, columns - PHYSICS + j] += m[4, i, j]
        new[3 + i, columns - 1] += m[5, i, 0]
    for i in range(3):
        for p in range(columns):
            new[i, p] = S[i, p] + eta * new[3 + i, p]


@njit(**FAST)
def slide(c, first, knot, y, S, opens, step, steps, physics, times, pose, jacobian, path):
    """Carry a block from state y (6,) with derivatives S (6, P) through ``steps`` steps.

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
        low = hand_of(c, first, knot, t + eta, w, hand)
        sliding = _stage(y, hand, eta, physics, middle)
        if wanted:
            _stage_matrices(middle, hand, eta, physics, sliding, m)
            _stage_derivatives(old, m, w, low, knot, eta, S_middle)
        for i in range(6):
            base[i] = y[i] + rest * (middle[i] - y[i])
        low = hand_of(c, first, knot, t + step, w, hand)
        sliding = _stage(base, hand, eta, physics, end)
        if wanted:
            for i in range(6):
                for p in range(columns):
                    S_middle[i, p] = old[i, p] + rest * (S_middle[i, p] - old[i, p])
            _stage_matrices(end, hand, eta, physics, sliding, m)
            _stage_derivatives(S_middle, m, w, low, knot, eta, S_end)
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
