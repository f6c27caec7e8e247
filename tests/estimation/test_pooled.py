"""Pooling beside published meta-analyses, brute force and simulation."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import lognorm, norm
from scipy.stats import t as student_t

from slidepipe.errors import InputError
from slidepipe.estimation import pooled as module
from slidepipe.estimation.pooled import Belief, pool, standing_out

# BCG vaccine trials: log relative risks and their variances (Colditz et al. 1994), a textbook example.
BCG = np.array([-0.8893, -1.5854, -1.3481, -1.4416, -0.2175, -0.7861, -1.6209, 0.0120, -0.4694, -1.3713, -0.3394,
                0.4459, -0.0173])  # fmt: skip
BCG_VARIANCE = np.array([0.3256, 0.1946, 0.4154, 0.0200, 0.0512, 0.0069, 0.2230, 0.0040, 0.0564, 0.0730, 0.0124,
                         0.5325, 0.0714])  # fmt: skip
REML_TAU_SQUARED, REML_MEAN, REML_ERROR, REML_Q = 0.3132, -0.7145, 0.1798, 152.2330
"""As published for these data."""


def brute_force(y: np.ndarray, noise: np.ndarray, scale: float, prior: Belief | None) -> tuple[float, float]:
    """Median and spread of log value, by summing the joint density over a fine grid of value and tau."""
    m = np.linspace(y.mean() - 0.6, y.mean() + 0.6, 1201)[:, None, None]
    tau = np.geomspace(1e-5, 3.0, 1500)[None, :, None]
    density = norm.logpdf(y, m, np.hypot(noise, tau)).sum(axis=2)
    density += (student_t.logpdf(tau / scale, 4) + np.log(tau))[..., 0]
    if prior is not None:
        density += norm.logpdf(m, np.log(prior.mean), prior.std / prior.mean)[..., 0]
    weight = np.exp(density - density.max()).sum(axis=1)
    weight /= weight.sum()
    mean = weight @ m[:, 0, 0]
    median = np.interp(0.5, np.cumsum(weight) - weight / 2.0, m[:, 0, 0])
    return float(median), float(np.sqrt(weight @ (m[:, 0, 0] - mean) ** 2))


@pytest.mark.parametrize("prior", [None, Belief(20.5, 0.8)])
def test_posterior_is_that_of_brute_force(prior: Belief | None) -> None:
    values, stds = np.array([20.1, 21.0, 20.6, 19.2]), np.array([0.3, 0.1, 0.2, 0.4])
    told = pool(values, stds, prior=prior)
    median, spread = brute_force(np.log(values), stds / values, module.BETWEEN_SCALE, prior)
    assert told.std / told.mean == pytest.approx(spread, rel=0.01)
    assert np.log(told.mean) == pytest.approx(median, abs=0.003 * spread)


def test_textbook_example() -> None:
    noise = np.sqrt(BCG_VARIANCE)
    tau = np.geomspace(0.05, 3.0, 4000)
    known = np.log(tau) - 2.5 * np.log1p(tau**2 / 4.0)  # what the posterior has beyond the restricted likelihood
    told = module._posterior(BCG, noise, tau, None, 1.0)
    best = int(np.argmax(np.log(told.weight) - known))
    assert tau[best] ** 2 == pytest.approx(REML_TAU_SQUARED, abs=3e-4)
    assert told.centre[best] == pytest.approx(REML_MEAN, abs=2e-4)
    assert np.sqrt(told.variance[best]) == pytest.approx(REML_ERROR, abs=2e-4)
    weight = 1.0 / BCG_VARIANCE
    assert weight @ (BCG - weight @ BCG / weight.sum()) ** 2 == pytest.approx(REML_Q, rel=0.004)  # of four digits
    assert pool(np.exp(BCG), noise * np.exp(BCG)).same_value_p < 1e-20


@pytest.mark.parametrize(("count", "between"), [(2, 0.02), (3, 0.0), (3, 0.04), (6, 0.02)])
def test_intervals_hold_where_there_are_few_trials(count: int, between: float) -> None:
    random, tries = np.random.default_rng(count), 250
    held = [0, 0]
    for _ in range(tries):
        noise = 0.004 * random.uniform(0.7, 1.4, count)
        values = 20.0 * np.exp(between * random.normal(size=count) + noise * random.normal(size=count))
        told = pool(values, noise * values)
        following = 20.0 * np.exp(between * random.normal())
        held[0] += told.interval_95[0] < 20.0 < told.interval_95[1]
        held[1] += told.predictive_interval_95[0] < following < told.predictive_interval_95[1]
    assert min(held) >= 0.92 * tries


def test_one_trial_is_its_own_estimate_and_tells_nothing_of_the_spread() -> None:
    told = pool(np.array([20.0]), np.array([0.1]))
    # The median of a half Student-t: its scale times the 75 % quantile.
    assert told.between_std / told.mean == pytest.approx(0.05 * student_t.ppf(0.75, 4), rel=0.01)
    assert told.mean == pytest.approx(20.0, rel=1e-6)
    assert told.std > 10 * told.within_std
    assert told.same_value_p == told.surprise_p[0] == 1.0
    assert not told.outlying.any()


def test_a_firm_belief_prevails_and_a_vague_one_does_not_matter() -> None:
    values, stds = np.array([20.0, 20.2]), np.array([0.1, 0.1])
    assert pool(values, stds, prior=Belief(25.0, 0.001)).mean == pytest.approx(25.0, rel=1e-3)
    vague, alone = pool(values, stds, prior=Belief(25.0, 1e4)), pool(values, stds)
    assert vague.mean == pytest.approx(alone.mean, rel=1e-4)
    low, high = lognorm.interval(0.95, 0.02, scale=22.0)
    belief = pool(np.array([22.0]), np.array([1e3]), prior=Belief(22.0, 0.44))
    assert belief.interval_95 == pytest.approx((low, high), rel=1e-3)


def test_an_outlying_trial_is_flagged_and_stays_in() -> None:
    values = np.array([20.0, 20.1, 19.9, 20.05, 24.0, 20.0])
    told = pool(values, np.full(6, 0.1))
    assert told.outlying.tolist() == [False, False, False, False, True, False]
    assert told.surprise_p[4] < 1e-3
    assert told.mean > pool(np.delete(values, 4), np.full(5, 0.1)).mean


def test_sound_trials_are_seldom_flagged() -> None:
    random = np.random.default_rng(3)
    flagged = [0, 0]
    for _ in range(200):
        values = np.exp(0.03 * random.normal(size=6))
        flagged[0] += pool(values, np.full(6, 0.004)).outlying.any()
        flagged[1] += standing_out(random.normal(size=(6, 3))).any()
    assert max(flagged) <= 20
    assert flagged[1] >= 1


@given(
    st.lists(st.floats(5.0, 50.0), min_size=2, max_size=6),
    st.floats(0.01, 100.0),
    st.randoms(use_true_random=False),
)
def test_units_and_order_do_not_matter(values: list[float], unit: float, random) -> None:
    order = random.sample(range(len(values)), len(values))
    here, stds = np.array(values), 0.01 * np.array(values)
    told, other = pool(here, stds), pool(unit * here[order], unit * stds[order])
    assert other.mean == pytest.approx(unit * told.mean, rel=1e-9)
    assert other.interval_95 == pytest.approx(tuple(unit * end for end in told.interval_95), rel=1e-9)
    assert other.surprise_p == pytest.approx(told.surprise_p[order], rel=1e-6, abs=1e-12)
    assert min(values) * (1 - 1e-9) <= told.mean <= max(values) * (1 + 1e-9)


@pytest.mark.parametrize(
    ("values", "stds", "message"),
    [
        ([], [], r"values and stds must be one or more, as many of each, got \(0,\) and \(0,\)"),
        ([1.0, 2.0], [0.1], r"as many of each, got \(2,\) and \(1,\)"),
        ([1.0, -2.0], [0.1, 0.1], r"values must be positive numbers, got -2.0"),
        ([1.0, 2.0], [0.1, np.nan], r"stds must be positive numbers, got nan"),
    ],
)
def test_what_cannot_be_pooled(values: list[float], stds: list[float], message: str) -> None:
    with pytest.raises(InputError, match=f"^pooled: .*{message}$"):
        pool(np.array(values), np.array(stds))
    with pytest.raises(InputError, match="the belief's std must be a positive number, got 0"):
        Belief(1.0, 0)
