"""Cholesky factors in compiled loops: a few hundred unknowns, where threaded linear algebra only waits for others."""

import numpy as np
from numba import njit

from slidepipe.estimation.stage_kernel import FAST


@njit(**FAST)
def factor(H, damping, L, scale):
    """Cholesky factor of H, scaled to a unit diagonal and damped; False where it is not positive definite."""
    size = len(H)
    for i in range(size):
        scale[i] = 1.0 / np.sqrt(max(H[i, i], 1e-30))
    for i in range(size):
        for j in range(i + 1):
            total = H[i, j] * scale[i] * scale[j]
            if i == j:
                total += damping + 1e-13
            for k in range(j):
                total -= L[i, k] * L[j, k]
            if i == j:
                if total <= 0.0:
                    return False
                L[i, i] = np.sqrt(total)
            else:
                L[i, j] = total / L[j, j]
    return True


@njit(**FAST)
def solve(L, scale, b, x):
    """Solve with the factor: x such that H x = b."""
    size = len(b)
    for i in range(size):
        total = b[i] * scale[i]
        for k in range(i):
            total -= L[i, k] * x[k]
        x[i] = total / L[i, i]
    for i in range(size - 1, -1, -1):
        total = x[i]
        for k in range(i + 1, size):
            total -= L[k, i] * x[k]
        x[i] = total / L[i, i]
    for i in range(size):
        x[i] *= scale[i]


@njit(**FAST)
def inverse_of(H):
    """Inverse of an information matrix; of a parameter that nothing tells, a huge variance."""
    size = len(H)
    L, scale, unit, inverse = np.zeros((size, size)), np.empty(size), np.zeros(size), np.empty((size, size))
    factor(H, 0.0, L, scale)
    for i in range(size):
        unit[:] = 0.0
        unit[i] = 1.0
        solve(L, scale, unit, inverse[i])
    return inverse
