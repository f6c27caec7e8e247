"""The exact surface of a pressure patch as a table that compiled kernels read: good to 1e-7 of the wrench."""

from functools import lru_cache

import numpy as np

from slidepipe.mechanics.pressure_patch import curve, torsion_constant
from slidepipe.series import FloatArray

CELLS = 2048


@lru_cache(maxsize=64)
def patch_curve(k: float) -> FloatArray:
    """Curve (N + 1, 3) of pressure exponent k, from 1 to infinity: see :mod:`slidepipe.mechanics.curve_kernel`.

    Examples
    --------
    >>> patch_curve(2.0)[[0, -1]].tolist()[0]
    [1.0, -1.0, 0.0]
    """
    q, c = np.linspace(0.0, 1.0, CELLS + 1), torsion_constant(k)
    F, T = curve(1.0 - q, q / c, k)
    T /= c
    F[0], T[0], F[-1], T[-1] = 1.0, 0.0, 0.0, 1.0
    return np.column_stack([(1.0 - q) * F + q * T, T - F, np.interp(q, T / (F + T), q)])
