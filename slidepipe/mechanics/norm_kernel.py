# mypy: disallow-untyped-defs=False, disallow-untyped-calls=False, disallow-untyped-decorators=False
"""The convex problem behind every grasp of several fingers: the smallest sum of norms, by a primal-dual Newton method.

Minimise ``p/2 |x|^2 + sum_i |K_i x + e_i|`` over x in two or three dimensions. Its dual variables, |g_i| <= 1, are the
contacts' friction in scaled form, g_i = S_i^-1 f_i with S_i the semi-axes of the ellipsoid of eq. (10): of length one
where a contact slides, inside the ball where it does not, which is where the sum has a kink. The norms are smoothed,
``sqrt(|z|^2 + eps^2)``, and eps shrinks along the path; x and g are linearised as variables of their own (the method of
Andersen, Christiansen, Conn and Overton for sums of norms), so that the kinks do no harm.
"""

import numpy as np
from numba import njit

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
def smoothed_sum(p, K, e, x, eps):
    """Value of the smoothed sum at x."""
    total = 0.0
    for j in range(len(x)):
        total += 0.5 * p * x[j] * x[j]
    for i in range(len(K)):
        square = eps[i] * eps[i]
        for k in range(3):
            z = e[i, k]
            for j in range(len(x)):
                z += K[i, k, j] * x[j]
            square += z * z
        total += np.sqrt(square)
    return total


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
def assemble(p, K, e, x, g, eps, z, rho, H, b):
    """Newton's matrix and right side; ``z`` and ``rho`` are filled. Returns how far g is off z / rho."""
    m, off = len(x), 0.0
    H[:] = 0.0
    for j in range(m):
        b[j] = -p * x[j]
        H[j, j] = p
    for i in range(len(K)):
        square, gap = eps[i] * eps[i], 0.0
        for k in range(3):
            z[i, k] = e[i, k]
            for j in range(m):
                z[i, k] += K[i, k, j] * x[j]
            square += z[i, k] * z[i, k]
        rho[i] = np.sqrt(square)
        for j in range(m):
            along = 0.0
            for k in range(3):
                along += z[i, k] * K[i, k, j]
            b[j] -= along / rho[i]
            for row in range(m):
                for k in range(3):
                    H[row, j] += K[i, k, row] * (K[i, k, j] - g[i, k] * along / rho[i]) / rho[i]
        for k in range(3):
            gap += (g[i, k] - z[i, k] / rho[i]) ** 2
        off = max(off, gap)
    trace = 0.0
    for j in range(m):
        trace += H[j, j]
    for j in range(m):
        H[j, j] += 1e-15 * trace
    return np.sqrt(off)


@njit(cache=True, error_model="numpy")
def step_length(p, K, e, x, dx, eps, slope):
    """Share of Newton's step that makes the smoothed sum smaller; ``slope`` is its derivative along the step."""
    start, t = smoothed_sum(p, K, e, x, eps), 1.0
    for _ in range(40):
        if smoothed_sum(p, K, e, x + t * dx, eps) <= start + 1e-4 * t * slope + 1e-14 * start:
            break
        t *= 0.5
    return t


@njit(cache=True, error_model="numpy")
def move_forces(K, dx, t, z, rho, g):
    """Take the linearised step of the scaled forces, and keep each within its ball."""
    for i in range(len(K)):
        d0, d1, d2 = 0.0, 0.0, 0.0
        for j in range(len(dx)):
            d0 += K[i, 0, j] * dx[j]
            d1 += K[i, 1, j] * dx[j]
            d2 += K[i, 2, j] * dx[j]
        along = (z[i, 0] * d0 + z[i, 1] * d1 + z[i, 2] * d2) / rho[i]
        g0 = g[i, 0] + t * ((z[i, 0] + d0 - g[i, 0] * along) / rho[i] - g[i, 0])
        g1 = g[i, 1] + t * ((z[i, 1] + d1 - g[i, 1] * along) / rho[i] - g[i, 1])
        g2 = g[i, 2] + t * ((z[i, 2] + d2 - g[i, 2] * along) / rho[i] - g[i, 2])
        size = max(1.0, np.sqrt(g0 * g0 + g1 * g1 + g2 * g2))
        g[i, 0], g[i, 1], g[i, 2] = g0 / size, g1 / size, g2 / size


@njit(cache=True, error_model="numpy")
def sharpen(z, eps):
    """Take the smoothing from the contacts that clearly slide, however slowly."""
    for i in range(len(z)):
        size = np.sqrt(z[i, 0] ** 2 + z[i, 1] ** 2 + z[i, 2] ** 2)
        if size > SLIDES * eps[i]:
            eps[i] = FINEST * size


@njit(cache=True, error_model="numpy")
def smallest_sum(p, K, e, x, g):
    """Minimise into ``x`` (m,) and ``g`` (n, 3); ``K`` is (n, 3, m), ``e`` (n, 3). Returns the rounds taken."""
    m, n = len(x), len(K)
    x[:], g[:] = 0.0, 0.0
    z, rho = np.empty((n, 3)), np.empty(n)
    H, dx = np.empty((m, m)), np.empty(m)
    level = 0.0
    for i in range(n):
        level = max(level, np.sqrt(e[i, 0] ** 2 + e[i, 1] ** 2 + e[i, 2] ** 2))
    if level == 0.0:
        return 0
    finest, sharp, extra, best = FINEST * level, False, 0, 1e300
    eps = np.full(n, level)
    for rounds in range(ROUNDS):
        off = assemble(p, K, e, x, g, eps, z, rho, H, dx)
        if level > finest and off < CLOSE:
            level = max(finest, SHRINK * level)
            eps[:] = level
            off = assemble(p, K, e, x, g, eps, z, rho, H, dx)
        elif level <= finest:
            # Forces of contacts at rest cannot be told from z / rho better than rounding lets them.
            extra = 0 if off < 0.5 * best else extra + 1
            best = min(best, off)
            if off < SETTLED or extra > PATIENCE:
                if sharp:
                    return rounds
                sharp, extra, best = True, 0, 1e300
                sharpen(z, eps)
                off = assemble(p, K, e, x, g, eps, z, rho, H, dx)
        slope = 0.0
        gradient = dx.copy()
        solve_small(H, dx)
        for j in range(m):
            slope -= gradient[j] * dx[j]
        t = step_length(p, K, e, x, dx, eps, slope)
        move_forces(K, dx, t, z, rho, g)
        for j in range(m):
            x[j] += t * dx[j]
    return ROUNDS
