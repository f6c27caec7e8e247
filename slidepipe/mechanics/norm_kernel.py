# mypy: disallow-untyped-defs=False, disallow-untyped-calls=False, disallow-untyped-decorators=False
"""The convex problem behind every grasp of several fingers: the smallest sum of norms, by a primal-dual Newton method.

Minimise ``p/2 |x|^2 + sum_i h_i(K_i x + e_i)`` over x in two or three dimensions, where h_i is the norm for an
ellipsoid and else the support function of a curve (see :mod:`slidepipe.mechanics.curve_kernel`). Its dual variables are
the contacts' friction in scaled form, g_i = S_i^-1 f_i with S_i the semi-axes of the ellipsoid of eq. (10): on the
surface where a contact slides, inside it where it does not, which is where the sum has a kink. The norms are smoothed,
``sqrt(h^2 + eps^2)``, and eps shrinks along the path; x and g are linearised as variables of their own (the method of
Andersen, Christiansen, Conn and Overton for sums of norms), so that the kinks do no harm. It needs of h no more than
half the first and second derivatives of its square, ``m = h g`` and M: z itself and 1 for the norm.

``shapes`` (n,) says which of the ``curves`` (S, N + 1, 3) each contact has, -1 for an ellipsoid.
"""

import numpy as np
from numba import njit

from slidepipe.mechanics.curve_kernel import gauge, local_ellipsoid, support

ROUNDS = 400
FINEST = 1e-11
"""The last eps, as a share of the largest |e_i|."""
SHRINK = 0.1
CLOSE = 0.1
"""How far the forces may be off the path, as a share of the friction, before eps shrinks."""
SETTLED = 1e-13
PATIENCE = 7
"""Rounds without gain at the end after which rounding is all that is left."""
SLIDES = 30.0
"""How many eps a contact must slide at the end for its norm to be taken without smoothing."""


@njit(cache=True, error_model="numpy")
def power(shape, curves, z1, z2, z3):
    """Support function at a scaled twist."""
    if shape < 0 or (z1 == 0.0 and z2 == 0.0 and z3 == 0.0):
        return np.sqrt(z1 * z1 + z2 * z2 + z3 * z3)
    return support(curves[shape], z1, z2, z3)[0]


@njit(cache=True, error_model="numpy")
def share_used(shape, curves, g1, g2, g3):
    """The surface's gauge at scaled friction: above one outside."""
    if shape < 0:
        return np.sqrt(g1 * g1 + g2 * g2 + g3 * g3)
    return gauge(curves[shape], g1, g2, g3)


@njit(cache=True, error_model="numpy")
def powers(shapes, curves, z, h):
    """Fill ``h`` (T, n) with the support functions at scaled twists ``z`` (T, n, 3)."""
    for row in range(len(z)):
        for i in range(len(shapes)):
            h[row, i] = power(shapes[i], curves, z[row, i, 0], z[row, i, 1], z[row, i, 2])


@njit(cache=True, error_model="numpy")
def frictions(shapes, curves, z, g):
    """Fill ``g`` (T, n, 3) with the scaled friction at scaled twists ``z`` that are not zero."""
    for row in range(len(z)):
        for i in range(len(shapes)):
            z1, z2, z3 = z[row, i, 0], z[row, i, 1], z[row, i, 2]
            if shapes[i] < 0:
                size = np.sqrt(z1 * z1 + z2 * z2 + z3 * z3)
                g[row, i, 0], g[row, i, 1], g[row, i, 2] = z1 / size, z2 / size, z3 / size
            else:
                _, g[row, i, 0], g[row, i, 1], g[row, i, 2] = support(curves[shapes[i]], z1, z2, z3)


@njit(cache=True, error_model="numpy")
def smoothed_sum(p, K, e, x, eps, shapes, curves):
    """Value of the smoothed sum at x."""
    total = 0.0
    for j in range(len(x)):
        total += 0.5 * p * x[j] * x[j]
    for i in range(len(K)):
        z1, z2, z3 = e[i, 0], e[i, 1], e[i, 2]
        for j in range(len(x)):
            z1 += K[i, 0, j] * x[j]
            z2 += K[i, 1, j] * x[j]
            z3 += K[i, 2, j] * x[j]
        h = power(shapes[i], curves, z1, z2, z3)
        total += np.sqrt(h * h + eps[i] * eps[i])
    return total


@njit(cache=True, error_model="numpy")
def half_square(shape, curves, z, K, bent):
    """Turn the scaled twist ``z`` (3,) into m, and fill ``bent`` (3, m) with M K; returns h."""
    m = K.shape[1]
    if shape < 0 or (z[0] == 0.0 and z[1] == 0.0 and z[2] == 0.0):
        bent[:] = K
        return np.sqrt(z[0] * z[0] + z[1] * z[1] + z[2] * z[2])
    h, c, s, m_ll, m_lt, m_tt, m_nn = local_ellipsoid(curves[shape], z[0], z[1], z[2])
    xx, xy, yy = c * c * m_ll + s * s * m_nn, c * s * (m_ll - m_nn), s * s * m_ll + c * c * m_nn
    xt, yt = c * m_lt, s * m_lt
    for j in range(m):
        bent[0, j] = xx * K[0, j] + xy * K[1, j] + xt * K[2, j]
        bent[1, j] = xy * K[0, j] + yy * K[1, j] + yt * K[2, j]
        bent[2, j] = xt * K[0, j] + yt * K[1, j] + m_tt * K[2, j]
    z[0], z[1], z[2] = (
        xx * z[0] + xy * z[1] + xt * z[2],
        xy * z[0] + yy * z[1] + yt * z[2],
        xt * z[0] + yt * z[1] + m_tt * z[2],
    )
    return h


@njit(cache=True, error_model="numpy")
def solve_small(H, b):
    """Solve ``H y = b`` in place of b, for two or three unknowns, by elimination with pivots; H is lost."""
    m = len(b)
    for j in range(m):
        pivot = j
        for i in range(j + 1, m):
            if abs(H[i, j]) > abs(H[pivot, j]):
                pivot = i
        for k in range(m):
            H[j, k], H[pivot, k] = H[pivot, k], H[j, k]
        b[j], b[pivot] = b[pivot], b[j]
        for i in range(j + 1, m):
            share = H[i, j] / H[j, j]
            for k in range(j, m):
                H[i, k] -= share * H[j, k]
            b[i] -= share * b[j]
    for j in range(m - 1, -1, -1):
        for k in range(j + 1, m):
            b[j] -= H[j, k] * b[k]
        b[j] /= H[j, j]


@njit(cache=True, error_model="numpy")
def assemble(p, K, e, x, g, eps, shapes, curves, m, bent, rho, H, b):
    """Newton's matrix and right side; ``m``, ``bent`` and ``rho`` are filled. Returns how far g is off m / rho."""
    size, off = len(x), 0.0
    H[:] = 0.0
    for j in range(size):
        b[j] = -p * x[j]
        H[j, j] = p
    for i in range(len(K)):
        for k in range(3):
            m[i, k] = e[i, k]
            for j in range(size):
                m[i, k] += K[i, k, j] * x[j]
        h, gap = half_square(shapes[i], curves, m[i], K[i], bent[i]), 0.0
        rho[i] = np.sqrt(h * h + eps[i] * eps[i])
        for j in range(size):
            along = 0.0
            for k in range(3):
                along += m[i, k] * K[i, k, j]
            b[j] -= along / rho[i]
            for row in range(size):
                for k in range(3):
                    H[row, j] += K[i, k, row] * (bent[i, k, j] - g[i, k] * along / rho[i]) / rho[i]
        for k in range(3):
            gap += (g[i, k] - m[i, k] / rho[i]) ** 2
        off = max(off, gap)
    trace = 0.0
    for j in range(size):
        trace += H[j, j]
    for j in range(size):
        H[j, j] += 1e-15 * trace
    return np.sqrt(off)


@njit(cache=True, error_model="numpy")
def step_length(p, K, e, x, dx, eps, shapes, curves, slope):
    """Share of Newton's step that makes the smoothed sum smaller; ``slope`` is its derivative along the step."""
    start, t = smoothed_sum(p, K, e, x, eps, shapes, curves), 1.0
    for _ in range(40):
        if smoothed_sum(p, K, e, x + t * dx, eps, shapes, curves) <= start + 1e-4 * t * slope + 1e-14 * start:
            break
        t *= 0.5
    return t


@njit(cache=True, error_model="numpy")
def move_forces(K, dx, t, shapes, curves, m, bent, rho, g):
    """Take the linearised step of the scaled forces, and keep each within its surface."""
    for i in range(len(K)):
        d0, d1, d2, along = 0.0, 0.0, 0.0, 0.0
        for j in range(len(dx)):
            d0 += bent[i, 0, j] * dx[j]
            d1 += bent[i, 1, j] * dx[j]
            d2 += bent[i, 2, j] * dx[j]
            along += (m[i, 0] * K[i, 0, j] + m[i, 1] * K[i, 1, j] + m[i, 2] * K[i, 2, j]) * dx[j]
        along /= rho[i]
        g0 = g[i, 0] + t * ((m[i, 0] + d0 - g[i, 0] * along) / rho[i] - g[i, 0])
        g1 = g[i, 1] + t * ((m[i, 1] + d1 - g[i, 1] * along) / rho[i] - g[i, 1])
        g2 = g[i, 2] + t * ((m[i, 2] + d2 - g[i, 2] * along) / rho[i] - g[i, 2])
        size = max(1.0, share_used(shapes[i], curves, g0, g1, g2))
        g[i, 0], g[i, 1], g[i, 2] = g0 / size, g1 / size, g2 / size


@njit(cache=True, error_model="numpy")
def sharpen(rho, eps):
    """Take the smoothing from the contacts that clearly slide, however slowly."""
    for i in range(len(rho)):
        size = np.sqrt(max(rho[i] * rho[i] - eps[i] * eps[i], 0.0))
        if size > SLIDES * eps[i]:
            eps[i] = FINEST * size


@njit(cache=True, error_model="numpy")
def smallest_sum(p, K, e, x, g, shapes, curves):
    """Minimise into ``x`` (m,) and ``g`` (n, 3); ``K`` is (n, 3, m), ``e`` (n, 3). Returns the rounds taken."""
    size, n = len(x), len(K)
    x[:], g[:] = 0.0, 0.0
    m, bent, rho = np.empty((n, 3)), np.empty((n, 3, size)), np.empty(n)
    H, dx = np.empty((size, size)), np.empty(size)
    level = 0.0
    for i in range(n):
        level = max(level, np.sqrt(e[i, 0] ** 2 + e[i, 1] ** 2 + e[i, 2] ** 2))
    if level == 0.0:
        return 0
    finest, sharp, extra, best = FINEST * level, False, 0, 1e300
    eps = np.full(n, level)
    for rounds in range(ROUNDS):
        off = assemble(p, K, e, x, g, eps, shapes, curves, m, bent, rho, H, dx)
        if level > finest and off < CLOSE:
            level = max(finest, SHRINK * level)
            eps[:] = level
            off = assemble(p, K, e, x, g, eps, shapes, curves, m, bent, rho, H, dx)
        elif level <= finest:
            # Forces of contacts at rest cannot be told from m / rho better than rounding lets them.
            extra = 0 if off < 0.5 * best else extra + 1
            best = min(best, off)
            if off < SETTLED or extra > PATIENCE:
                if sharp:
                    return rounds
                sharp, extra, best = True, 0, 1e300
                sharpen(rho, eps)
                off = assemble(p, K, e, x, g, eps, shapes, curves, m, bent, rho, H, dx)
        slope = 0.0
        gradient = dx.copy()
        solve_small(H, dx)
        for j in range(size):
            slope -= gradient[j] * dx[j]
        t = step_length(p, K, e, x, dx, eps, shapes, curves, slope)
        move_forces(K, dx, t, shapes, curves, m, bent, rho, g)
        for j in range(size):
            x[j] += t * dx[j]
    return ROUNDS
