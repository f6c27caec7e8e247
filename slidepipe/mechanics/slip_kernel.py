# mypy: disallow-untyped-defs=False, disallow-untyped-calls=False, disallow-untyped-decorators=False
"""Friction of n fingers on one object by Gauss' principle, compiled."""

import numpy as np
from numba import njit

from slidepipe.mechanics.norm_kernel import power, share_used, smallest_sum


@njit(cache=True, error_model="numpy")
def grasp_friction(M, s, shapes, curves, r, free, wanted, forces, motion, slip):
    """Solve Gauss' principle into ``forces`` (n, 3), ``motion`` (3,) and ``slip`` (n, 3); returns (residual, size).

    With ``motion = free + M^-1/2 x`` it is the smallest ``|x|^2 / 2 + sum_i h_i(S_i (G_i^T motion - wanted_i))``,
    h_i the norm for an ellipsoid; ``size`` is the largest norm of these arguments without friction, W.
    """
    n, size, residual = len(s), 0.0, 0.0
    root = np.sqrt(M)
    K, e, x, g = np.zeros((n, 3, 3)), np.empty((n, 3)), np.empty(3), np.empty((n, 3))
    for i in range(n):
        K[i, 0, 0], K[i, 0, 2] = s[i, 0] / root[0], -s[i, 0] * r[i, 1] / root[2]
        K[i, 1, 1], K[i, 1, 2] = s[i, 1] / root[1], s[i, 1] * r[i, 0] / root[2]
        K[i, 2, 2] = s[i, 2] / root[2]
        e[i, 0] = s[i, 0] * (free[0] - r[i, 1] * free[2] - wanted[i, 0])
        e[i, 1] = s[i, 1] * (free[1] + r[i, 0] * free[2] - wanted[i, 1])
        e[i, 2] = s[i, 2] * (free[2] - wanted[i, 2])
        size = max(size, np.sqrt(np.sum(e[i] * e[i])))
    smallest_sum(1.0, K, e, x, g, shapes, curves)
    motion[:] = free + x / root
    # What the forces make of the motion, eq. (17), as a share of all that they could.
    unmet, most = x.copy(), 0.0
    for i in range(n):
        forces[i] = -s[i] * g[i]
        for j in range(3):
            unmet[j] += K[i, 0, j] * g[i, 0] + K[i, 1, j] * g[i, 1] + K[i, 2, j] * g[i, 2]
        most += np.sqrt(np.sum(K[i] ** 2))
    residual = np.sqrt(np.sum(unmet * unmet)) / most
    for i in range(n):
        z = e[i].copy()
        for j in range(3):
            z += K[i, :, j] * x[j]
        slip[i, 0], slip[i, 1], slip[i, 2] = -z[0] / s[i, 0], -z[1] / s[i, 1], wanted[i, 2] - motion[2]
        if size > 0.0:
            residual = max(residual, unmet_share(shapes[i], curves, g[i], z, size))
    return residual, size


@njit(cache=True, error_model="numpy")
def unmet_share(shape, curves, g, z, size):
    """How far scaled friction is from the best for a slip: a ball's is moved along it and cut back; else by power."""
    if shape < 0:
        moved = g + z / size
        return np.sqrt(np.sum((g - moved / max(1.0, np.sqrt(np.sum(moved * moved)))) ** 2))
    short = power(shape, curves, z[0], z[1], z[2]) - np.sum(g * z)
    return max(short / size, share_used(shape, curves, g[0], g[1], g[2]) - 1.0, 0.0)
