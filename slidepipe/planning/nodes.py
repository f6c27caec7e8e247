"""Chebyshev nodes on a phase: where the compiled motion is known, and what integrates and interpolates from there."""

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.polynomial import chebyshev
from scipy.interpolate import BarycentricInterpolator

from slidepipe.series import FloatArray

FINE, COARSE = 16, 8
"""Nodes of a phase: exact to rounding for every motion that an arm can make, and good to a micrometre for a search."""


@dataclass(frozen=True, slots=True)
class Nodes:
    """Chebyshev points of the second kind on [0, 1].

    Attributes
    ----------
    points : (N,)
    integral : (N, N)
        From values at the points to the integral from zero to each of them.
    powers : (N, N)
        From values at the points to coefficients of powers, the constant first.
    rate : (N, N)
        From values at the points to their rates there.
    """

    points: FloatArray
    integral: FloatArray
    powers: FloatArray
    rate: FloatArray

    def between(self, values: FloatArray, share: FloatArray) -> FloatArray:
        """Values (T, ...) at shares (T,) of the phase, from those (N, ...) at the points."""
        return np.asarray(BarycentricInterpolator(self.points, values, wi=_weights(len(self.points)))(share))


@cache
def nodes(count: int) -> Nodes:
    """Nodes of a phase, made once.

    Examples
    --------
    >>> four = nodes(4)
    >>> round(float((four.integral @ four.points**2)[-1]), 12)
    0.333333333333
    """
    points = 0.5 * (1.0 - np.cos(np.pi * np.arange(count) / (count - 1)))
    powers = np.linalg.inv(np.vander(points, increasing=True))
    # By way of Chebyshev polynomials, for powers lose five digits at sixteen points.
    coefficients = np.linalg.inv(chebyshev.chebvander(2.0 * points - 1.0, count - 1))
    antiderivatives = 0.5 * chebyshev.chebint(coefficients, lbnd=-1.0)
    integral = chebyshev.chebvander(2.0 * points - 1.0, count) @ antiderivatives
    rate = 2.0 * chebyshev.chebvander(2.0 * points - 1.0, count - 2) @ chebyshev.chebder(coefficients)
    return Nodes(*(np.ascontiguousarray(values, dtype=float) for values in (points, integral, powers, rate)))


def _weights(count: int) -> FloatArray:
    """Barycentric weights of Chebyshev points of the second kind: of alternating sign, half as large at the ends."""
    weights = np.where(np.arange(count) % 2, -1.0, 1.0)
    weights[[0, -1]] *= 0.5
    return weights
