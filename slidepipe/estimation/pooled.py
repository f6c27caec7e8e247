"""Many trials at once: friction of an experiment, its spread from trial to trial, and the trials that stand out.

The model is that of random effects. A trial has its own value, since a surface wears, a spring relaxes and a finger is
never put down twice in one way. These values scatter about the experiment's with the *between-trial* spread tau,
and each estimate about its trial with the *within-trial* noise s_i that came with it. In logarithms, as friction
is positive and its noise a share of it: ``y_i ~ N(m, s_i^2 + tau^2)``.

With few trials the spread between them is hardly known, and an interval that takes its best guess for the truth is too
short. So tau is not guessed but integrated over, numerically, and m with it in closed form. What is known of tau
beforehand, a half Student-t of four degrees of freedom and a scale of 5 %, matters for two or three trials only.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq
from scipy.special import ndtr
from scipy.stats import chi2
from scipy.stats import t as student_t

from slidepipe.errors import InputError
from slidepipe.series import BoolArray, FloatArray

BETWEEN_SCALE = 0.05
"""How far values of the same experiment usually lie apart, as a share: the scale of what is known of tau."""
DEGREES_OF_FREEDOM = 4.0
NODES = 600
FEWEST_TO_FLAG = 3
FALSE_ALARM = 0.05
"""Chance that any of the trials of a sound experiment is flagged."""


@dataclass(frozen=True, slots=True)
class Belief:
    """What was believed of a value before these trials: log-normal about ``mean``, ``std`` in the value's own unit."""

    mean: float
    std: float

    def __post_init__(self) -> None:
        for name in ("mean", "std"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0.0):
                raise InputError(f"pooled: the belief's {name} must be a positive number, got {value!r}")


@dataclass(frozen=True, slots=True)
class Pooled:
    """What K trials tell together; everything in the unit of the values.

    Attributes
    ----------
    mean : float
        The experiment's value: median of the posterior.
    std : float
        Its standard deviation.
    interval_95 : tuple of float
        95 % interval of it.
    within_std : float
        Noise of a usual trial's estimate: root mean square of the given ones.
    between_std : float
        Spread of the trials' own values about the experiment's: median of the posterior. One trial tells nothing of
        it, and what stands here then is what was known beforehand.
    between_interval_95 : tuple of float
    predictive_std : float
        How far the value of the next trial may lie from ``mean``: one standard deviation.
    predictive_interval_95 : tuple of float
        95 % interval of the next trial's own value.
    same_value_p : float
        Chance of estimates that lie at least so far apart if all trials had one value (Cochran's Q); 1 for one trial.
    surprise_p : (K,)
        Chance of a value at least so far from what the other trials tell; 1 for one trial.
    outlying : (K,) bool
        Trials whose surprise is below 5 % shared among all of them; never any of less than three.
    """

    mean: float
    std: float
    interval_95: tuple[float, float]
    within_std: float
    between_std: float
    between_interval_95: tuple[float, float]
    predictive_std: float
    predictive_interval_95: tuple[float, float]
    same_value_p: float
    surprise_p: FloatArray
    outlying: BoolArray


def pool(
    values: FloatArray, stds: FloatArray, *, prior: Belief | None = None, between_scale: float = BETWEEN_SCALE
) -> Pooled:
    """Pool the estimates of several trials.

    An outlying trial is flagged, and its value stays in: whether it is left out is for the one who saw it to say.

    Parameters
    ----------
    values, stds : (K,)
        Estimates of the same positive quantity, one a trial, and their standard deviations.
    prior : Belief, optional
        What was believed before; without it the trials alone speak.
    between_scale : float
        Scale of what is known of the spread between trials beforehand, as a share of the value.

    Raises
    ------
    InputError
        There is no value, they are not positive and finite, or not as many as standard deviations.

    Examples
    --------
    >>> told = pool(np.array([20.1, 20.6, 20.3, 20.4]), np.array([0.05, 0.04, 0.05, 0.04]))
    >>> round(told.mean, 2), [round(end, 1) for end in told.interval_95]
    (20.35, [19.9, 20.8])
    >>> round(told.within_std, 3), round(told.between_std, 2), bool(told.outlying.any())
    (0.045, 0.28, False)
    """
    y, noise = _logarithms(values, stds, between_scale)
    tau = _nodes(y, noise, between_scale)
    told = _posterior(y, noise, tau, prior, between_scale)
    centre, between = np.exp(told.quantile(0.5, told.variance)), told.spread_quantiles()
    surprise = _surprises(y, noise, tau, prior, between_scale)
    low, high = (float(centre * end) for end in between[[0, 2]])
    return Pooled(
        mean=float(centre),
        std=float(centre * told.std(told.variance)),
        interval_95=told.interval(told.variance),
        within_std=float(centre * np.sqrt(np.mean(noise**2))),
        between_std=float(centre * between[1]),
        between_interval_95=(low, high),
        predictive_std=float(centre * told.std(told.variance + tau**2)),
        predictive_interval_95=told.interval(told.variance + tau**2),
        same_value_p=_same_value(y, noise),
        surprise_p=surprise,
        outlying=np.asarray((surprise < FALSE_ALARM / len(y)) & (len(y) >= FEWEST_TO_FLAG)),
    )


def standing_out(errors: FloatArray) -> BoolArray:
    """(K,) which of K trials ended where the others say that none should: final errors ``(K, n)`` in any units.

    Each error beside the mean of the others, in their own standard deviations, by Student's t; flagged below 5 % shared
    among all errors. Never any of less than four trials, nor along an axis on which the others do not differ.

    Examples
    --------
    >>> standing_out(np.array([[1.0, 0.1], [1.1, 0.0], [0.9, 0.2], [1.0, 0.1], [1.1, 9.0]]))
    array([False, False, False, False,  True])
    """
    errors = np.asarray(errors, dtype=float)
    count = len(errors)
    if count <= FEWEST_TO_FLAG:
        return np.zeros(count, dtype=bool)
    others = np.stack([np.delete(errors, index, axis=0) for index in range(count)])
    spread = others.std(axis=1, ddof=1) * np.sqrt(1.0 + 1.0 / (count - 1))
    away = np.divide(errors - others.mean(axis=1), spread, out=np.zeros_like(errors), where=spread > 0.0)
    surprise = 2.0 * student_t.sf(np.abs(away), count - 2)
    return np.asarray(np.any(surprise < FALSE_ALARM / errors.size, axis=1))


@dataclass(frozen=True, slots=True)
class _Posterior:
    """Mixture over tau (N,): its weights, and centre and variance of the normal of m that each one leaves."""

    tau: FloatArray
    weight: FloatArray
    centre: FloatArray
    variance: FloatArray

    def below(self, y: float, variance: FloatArray) -> float:
        """Chance of less than ``y`` where each normal has its centre and this variance."""
        return float(self.weight @ ndtr((y - self.centre) / np.sqrt(variance)))

    def quantile(self, share: float, variance: FloatArray) -> float:
        reach = 40.0 * float(np.sqrt(variance.max()))
        low, high = float(self.centre.min()) - reach, float(self.centre.max()) + reach
        return float(brentq(lambda y: self.below(y, variance) - share, low, high, xtol=1e-13))

    def interval(self, variance: FloatArray) -> tuple[float, float]:
        low, high = (float(np.exp(self.quantile(share, variance))) for share in (0.025, 0.975))
        return low, high

    def std(self, variance: FloatArray) -> float:
        mean = self.weight @ self.centre
        return float(np.sqrt(self.weight @ (variance + (self.centre - mean) ** 2)))

    def spread_quantiles(self) -> FloatArray:
        """(3,) tau at 2.5 %, 50 % and 97.5 %."""
        total = np.cumsum(self.weight) - self.weight / 2.0
        return np.exp(np.interp([0.025, 0.5, 0.975], total, np.log(self.tau)))


def _logarithms(values: FloatArray, stds: FloatArray, between_scale: float) -> tuple[FloatArray, FloatArray]:
    values, stds = np.atleast_1d(np.asarray(values, dtype=float)), np.atleast_1d(np.asarray(stds, dtype=float))
    if values.ndim != 1 or not len(values) or values.shape != stds.shape:
        raise InputError(
            f"pooled: values and stds must be one or more, as many of each, got {values.shape} and {stds.shape}"
        )
    for name, numbers in (("values", values), ("stds", stds), ("between_scale", np.array([between_scale]))):
        bad = np.flatnonzero(~(np.isfinite(numbers) & (numbers > 0.0)))
        if len(bad):
            raise InputError(f"pooled: {name} must be positive numbers, got {float(numbers[bad[0]])!r}")
    return np.log(values), stds / values


def _nodes(y: FloatArray, noise: FloatArray, between_scale: float) -> FloatArray:
    """Values of tau evenly spread in its logarithm, from where it does not matter to where it cannot be."""
    least, most = min(float(noise.min()), between_scale), max(float(np.ptp(y)), float(noise.max()), between_scale)
    return np.geomspace(1e-3 * least, 1e2 * most, NODES)


def _posterior(
    y: FloatArray, noise: FloatArray, tau: FloatArray, prior: Belief | None, between_scale: float
) -> _Posterior:
    precision = 1.0 / (noise**2 + tau[:, None] ** 2)
    about, sharpness = (0.0, 0.0) if prior is None else (np.log(prior.mean), (prior.mean / prior.std) ** 2)
    total = precision.sum(axis=1) + sharpness
    centre = (precision @ y + about * sharpness) / total
    misfit = np.sum(precision * (y - centre[:, None]) ** 2, axis=1) + sharpness * (about - centre) ** 2
    known = -(DEGREES_OF_FREEDOM + 1.0) / 2.0 * np.log1p((tau / between_scale) ** 2 / DEGREES_OF_FREEDOM)
    # The last term is the width of a step of the nodes, which are even in the logarithm.
    log_weight = 0.5 * (np.log(precision).sum(axis=1) - np.log(total) - misfit) + known + np.log(tau)
    weight = np.exp(log_weight - log_weight.max())
    return _Posterior(tau, weight / weight.sum(), centre, 1.0 / total)


def _surprises(
    y: FloatArray, noise: FloatArray, tau: FloatArray, prior: Belief | None, between_scale: float
) -> FloatArray:
    """(K,) how likely each value is, or one farther off, by what the others tell."""
    if len(y) == 1:
        return np.ones(1)
    surprise = np.empty(len(y))
    for index in range(len(y)):
        rest = np.arange(len(y)) != index
        others = _posterior(y[rest], noise[rest], tau, prior, between_scale)
        below = others.below(float(y[index]), others.variance + tau**2 + noise[index] ** 2)
        surprise[index] = 2.0 * min(below, 1.0 - below)
    return surprise


def _same_value(y: FloatArray, noise: FloatArray) -> float:
    weight = noise**-2
    return float(chi2.sf(np.sum(weight * (y - weight @ y / weight.sum()) ** 2), len(y) - 1)) if len(y) > 1 else 1.0
