"""A parameter that a fit holds: fits at several of its values, and how likely each of these is by what they cost."""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from slidepipe.series import FloatArray

FINE = 400


@dataclass(frozen=True, slots=True)
class Told:
    """A value, its standard deviation and 95 % interval; it counts as told up to the deviation ``enough_sd``."""

    value: float
    sd: float
    low: float
    high: float
    enough_sd: float = np.inf

    @property
    def told(self) -> bool:
        """Whether the motion tells it."""
        return self.sd <= self.enough_sd


@dataclass(frozen=True, slots=True)
class Profile:
    """Posterior of a parameter under a flat prior over the values that were tried.

    Attributes
    ----------
    tried : (K,)
        The values that fits were made at, increasing.
    fine, weight : (N,)
        Values between them, and their shares of the posterior.
    """

    tried: FloatArray
    fine: FloatArray
    weight: FloatArray

    def own(self, enough_sd: float = np.inf) -> Told:
        """What it says of the parameter itself; the interval is from quantiles, since it may be cut off at an end.

        Examples
        --------
        >>> told = profile_of(np.linspace(0.0, 4.0, 9), (np.linspace(0.0, 4.0, 9) - 2.0) ** 2 / 0.25)
        >>> round(told.own().value, 2), round(told.own().sd, 2), round(told.own().high, 1)
        (2.0, 0.5, 3.0)
        """
        mean = float(self.weight @ self.fine)
        low, high = np.interp([0.025, 0.975], np.cumsum(self.weight) - self.weight / 2.0, self.fine)
        return Told(mean, float(np.sqrt(self.weight @ (self.fine - mean) ** 2)), float(low), float(high), enough_sd)

    def mean(self, values: FloatArray) -> float:
        """Mean of something (K,) that each fit found."""
        return float(self.weight @ self._between(values))

    def sd(self, values: FloatArray, sds: FloatArray) -> float:
        """Standard deviation of it: that of each fit (K,), and what it changes from fit to fit."""
        away = self._between(values) - self.mean(values)
        return float(np.sqrt(self.weight @ (away**2 + np.interp(self.fine, self.tried, sds) ** 2)))

    def _between(self, values: FloatArray) -> FloatArray:
        return np.asarray(CubicSpline(self.tried, values)(self.fine))


def profile_of(tried: FloatArray, cost: FloatArray, scale: float = 1.0) -> Profile:
    """Posterior from what fits at the values ``tried`` (K,) cost (K,): twice the negative log-likelihood.

    ``scale`` divides the cost: how much wider the likelihood is than it says.
    """
    fine = np.linspace(tried[0], tried[-1], FINE + 1)
    between = CubicSpline(tried, (cost - np.min(cost)) / scale)(fine)
    weight = np.exp(-0.5 * (between - between.min()))
    return Profile(tried, fine, weight / weight.sum())
