"""One stage of the block's implicit step, its derivatives, and the numbers that both share.

A stage is the contact problem of :mod:`slidepipe.mechanics.contact_kernel`, so a slide begins, turns and ends without
being told when, and however slow it is; the derivatives follow from its own linear equations, three unknowns at a time.
"""

import numpy as np
from numba import njit

from slidepipe.mechanics.contact_kernel import contact_force
from slidepipe.mechanics.curve_kernel import local_ellipsoid, support

FAST = {"cache": True, "error_model": "numpy", "fastmath": {"contract", "arcp", "nsz", "reassoc"}}
START, PHYSICS = 6, 4
SLOWEST = 1e-9
"""Sliding slower than this has no direction, m/s."""
ROUNDS, SETTLED = 12, 1e-11


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
def stage(y, hand, eta, physics, curve, hold, new):
    """Solve one stage from y (6,) for ``new`` (6,); returns the size of the sliding velocity, negative if it sticks.

    ``physics`` is kappa, rho, m/I, growth, g_x, g_y; ``curve`` the limit surface, None the ellipsoid; ``hold`` how many
    times kappa the contact has.
    """
    kappa, rho, per_i, growth = hold * physics[0], physics[1], physics[2], physics[3]
    vx, vy = y[3] + eta * physics[4], y[4] + eta * physics[5]
    dx, dy = hand[0, 0] - y[0] - eta * y[3], hand[0, 1] - y[1] - eta * y[4]
    size, sliding, k = 0.0, -1.0, 0.0
    for _ in range(ROUNDS):
        fx, fy, mz, k = contact_force(
            curve,
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
def _surface_at(curve, ux, uy, uz, stiff):
    """Friction over kappa (3) of a sliding direction, and in ``stiff`` (3, 3) how it turns with the direction."""
    if curve is None:
        u = (ux, uy, uz)
        for i in range(3):
            for j in range(3):
                stiff[i, j] = (1.0 if i == j else 0.0) - u[i] * u[j]
        return ux, uy, uz
    h, f1, f2, f3 = support(curve, ux, uy, uz)
    _, c, s, m_ll, m_lt, m_tt, m_nn = local_ellipsoid(curve, ux, uy, uz)
    stiff[0, 0], stiff[1, 1] = c * c * m_ll + s * s * m_nn, s * s * m_ll + c * c * m_nn
    stiff[0, 1] = c * s * (m_ll - m_nn)
    stiff[0, 2], stiff[1, 2], stiff[2, 2] = c * m_lt, s * m_lt, m_tt
    f = (f1, f2, f3)
    for i in range(3):
        for j in range(i, 3):
            stiff[i, j] = (stiff[i, j] - f[i] * f[j]) / h
            stiff[j, i] = stiff[i, j]
    return f1, f2, f3


@njit(**FAST)
def stage_matrices(new, hand, eta, physics, curve, sliding, m):
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
    across, along = force / size, kappa * growth
    b, e, eb, scratch = np.empty((3, 3)), np.zeros((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    gx, gy, gz = _surface_at(curve, ux, uy, uz, b)
    fx, fy, fz = force * gx, force * gy, force * gz
    u, g = (ux, uy, uz), (gx, gy, gz)
    for i in range(3):
        for j in range(3):
            b[i, j] = along * g[i] * u[j] + across * b[i, j]
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
        scratch[i, 2] = kappa * size * (e[i, 0] * gx + e[i, 1] * gy + e[i, 2] * gz)
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
def stage_derivatives(S, m, w, low, knot, eta, new):
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
