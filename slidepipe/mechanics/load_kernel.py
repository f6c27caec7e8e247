# mypy: disallow-untyped-defs=False, disallow-untyped-calls=False, disallow-untyped-decorators=False
"""The load of a grasp under a wrench, compiled: forces show it to be enough, a direction shows it to be least."""

import numpy as np
from numba import njit

from slidepipe.mechanics.norm_kernel import power, share_used, smallest_sum

NO_RANK = 1e-12
"""Share of its largest friction below which a grasp is taken to have none in a direction."""
OUTSIDE = 1e-9
"""Share of a wrench that may point there, by rounding, before nothing can hold it."""
NO_LEVER = 1e-12
"""Lever of all contacts together, m, below which they touch at one point, without a patch."""


@njit(cache=True, error_model="numpy")
def many_loads(r, s, shapes, curves, w, loads):
    """Fill ``loads`` (T,) row by row."""
    forces, direction = np.empty((r.shape[1], 3)), np.empty(3)
    for row in range(len(w)):
        loads[row] = certified_load(r[row], s[row], shapes, curves, w[row], forces, direction)[0]


@njit(cache=True, error_model="numpy")
def grasp_columns(r, s):
    """K_i = G_i S_i side by side, (3, 3 n), eq. (15)."""
    K = np.zeros((3, 3 * len(r)))
    for i in range(len(r)):
        K[0, 3 * i] = s[i, 0]
        K[1, 3 * i + 1] = s[i, 1]
        K[2, 3 * i] = -r[i, 1] * s[i, 0]
        K[2, 3 * i + 1] = r[i, 0] * s[i, 1]
        K[2, 3 * i + 2] = s[i, 2]
    return K


@njit(cache=True, error_model="numpy")
def across(w):
    """Orthonormal vectors (r, r - 1) at right angles to ``w`` (r,), r = 2 or 3."""
    size = np.sqrt(np.sum(w * w))
    N = np.zeros((len(w), len(w) - 1))
    if len(w) == 2:
        N[0, 0], N[1, 0] = -w[1] / size, w[0] / size
        return N
    least = np.argmin(np.abs(w))
    axis = np.zeros(3)
    axis[least] = 1.0
    first = np.cross(w, axis)
    first /= np.sqrt(np.sum(first * first))
    N[:, 0], N[:, 1] = first, np.cross(w / size, first)
    return N


@njit(cache=True, error_model="numpy")
def certified_load(r, s, shapes, curves, w, forces, direction):
    """Load and its lower bound; fills ``forces`` (n, 3) and ``direction`` (3,). ``r``, ``s`` are (n, 3), ``w`` (3,).

    ``shapes`` and ``curves`` are those of :mod:`slidepipe.mechanics.norm_kernel`.
    """
    n = len(r)
    forces[:], direction[:] = 0.0, 0.0
    if not np.any(w != 0.0):
        return 0.0, 0.0
    K = grasp_columns(r, s)
    # One length makes moments of forces, and U / sigma makes sum_i K_i K_i^T the unit matrix where there is friction.
    lever = np.sqrt(np.sum(K[2] ** 2) / np.sum(K[:2] ** 2))
    lever = lever if lever > NO_LEVER else 1.0
    units = np.array([1.0, 1.0, 1.0 / lever])
    scaled, wanted = K * units.reshape(3, 1), w * units
    U, sigma, _ = np.linalg.svd(scaled, False)  # noqa: FBT003
    rank = 3 if sigma[2] > NO_RANK * sigma[0] else 2
    if rank == 2 and abs(np.sum(U[:, 2] * wanted)) > OUTSIDE * np.sqrt(np.sum(wanted**2)):
        away = U[:, 2] * units * np.sign(np.sum(U[:, 2] * wanted))
        direction[:] = away / np.sqrt(np.sum(away**2))
        forces[:] = np.nan
        return np.inf, np.inf
    white = np.ascontiguousarray((U[:, :rank] / sigma[:rank]).T)
    columns, goal = white @ scaled, white @ wanted
    N = across(goal)
    start = goal / np.sum(goal**2)
    x, g = np.empty(rank - 1), np.empty((n, 3))
    blocks = np.ascontiguousarray(columns.T)
    smallest_sum(0.0, (blocks @ N).reshape(n, 3, rank - 1), (blocks @ start).reshape(n, 3), x, g, shapes, curves)
    # The forces add up to the wrench exactly; the largest of them is the load.
    given = columns @ g.reshape(3 * n)
    share = np.sum(goal * given) / np.sum(goal**2)
    g += (blocks @ (share * goal - given)).reshape(n, 3)
    forces[:] = s * g / share
    direction[:] = units * (white.T @ (start + N @ x))
    moved = (np.ascontiguousarray(K.T) @ direction).reshape(n, 3)
    most, used = 0.0, 0.0
    for i in range(n):
        most += power(shapes[i], curves, moved[i, 0], moved[i, 1], moved[i, 2])
        used = max(used, share_used(shapes[i], curves, g[i, 0], g[i, 1], g[i, 2]))
    direction /= most
    return used / share, np.sum(w * direction)
