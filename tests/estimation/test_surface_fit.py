"""Force and motion: pairs made by the mechanics' exact surface give its friction back."""

import numpy as np
import pytest

from slidepipe.errors import EstimationError, InputError
from slidepipe.estimation.surface_fit import ForceMotion, Supports, fit_surface
from slidepipe.mechanics.grasp_surface import GraspSurface
from slidepipe.mechanics.limit_surface import PointContact, SoftFinger

POINTS = np.array([[0.05, 0.0], [-0.03, 0.04], [-0.02, -0.05]])
SHARES = np.array([0.5, 0.2, 0.3])
TOTAL_N = 4.0


def pairs(count: int, *, noise_n: float = 0.0, noise_n_m: float = 0.0, seed: int = 1) -> ForceMotion:
    random = np.random.default_rng(seed)
    surface = GraspSurface([PointContact(1.0, TOTAL_N * share) for share in SHARES], POINTS)
    step = random.normal(size=(count, 3)) * [0.01, 0.01, 0.2]
    wrench = surface.friction(step)
    return ForceMotion(wrench + random.normal(size=(count, 3)) * [noise_n, noise_n, noise_n_m], step)


def test_exact_pairs_give_every_support_back() -> None:
    fit = fit_surface(pairs(20), Supports(POINTS))
    assert fit.friction_n == pytest.approx(TOTAL_N, rel=1e-6)
    assert fit.shares == pytest.approx(SHARES, abs=1e-6)
    assert fit.exact_error.median < 1e-4
    assert fit.ellipsoid_error.median == pytest.approx(fit.models_apart.median, abs=1e-3)
    assert fit.ellipsoid_error.median > 0.05
    assert fit_surface(pairs(20), Supports(POINTS, SHARES)).friction_n == pytest.approx(TOTAL_N, rel=1e-6)


def test_a_support_that_bears_nothing_is_found_out() -> None:
    spare = np.vstack([POINTS, [[0.1, 0.1]]])
    fit = fit_surface(pairs(40, noise_n=0.05, noise_n_m=0.002), Supports(spare))
    assert fit.shares[3] < 0.01
    assert fit.shares[:3] == pytest.approx(SHARES, abs=0.03)


def test_standard_deviations_hold() -> None:
    errors = []
    for seed in range(60):
        fit = fit_surface(pairs(30, noise_n=0.4, noise_n_m=0.02, seed=seed), Supports(POINTS))
        errors.append([(fit.friction_n - TOTAL_N) / fit.friction_std_n, *((fit.shares - SHARES) / fit.shares_std)])
    assert np.mean(np.abs(errors) < 1.96) > 0.88
    assert np.std(errors) == pytest.approx(1.0, abs=0.2)


def test_an_ellipsoid_is_found_by_the_ellipsoid() -> None:
    random, finger = np.random.default_rng(0), SoftFinger(mu=0.5, f_N=6.0, a=0.02, c=0.6)
    step = random.normal(size=(40, 3)) * [0.01, 0.01, 0.5]
    fit = fit_surface(ForceMotion(finger.friction(step), step), Supports(POINTS))
    assert fit.ellipsoid.f_N == pytest.approx(3.0, rel=1e-6)
    assert fit.ellipsoid.a == pytest.approx(0.012, rel=1e-6)
    assert fit.ellipsoid_error.median < 1e-6


def test_what_cannot_be_fitted() -> None:
    good = pairs(20)
    with pytest.raises(EstimationError, match="9 pairs, at least 10 are needed"):
        pairs(9)
    with pytest.raises(EstimationError, match="the wrenches point against the sliding"):
        fit_surface(ForceMotion(-good.wrench, good.step), Supports(POINTS))
    with pytest.raises(InputError, match="step of pair 3 must be finite and not zero"):
        ForceMotion(good.wrench, np.where(np.arange(20)[:, None] == 2, 0.0, good.step))
    with pytest.raises(InputError, match=r"step must be \(M, 3\), one row a pair, got \(19, 3\)"):
        ForceMotion(good.wrench, good.step[1:])
    with pytest.raises(InputError, match="shares must be 3 numbers that add up to 1"):
        Supports(POINTS, np.array([0.5, 0.5, 0.5]))
    with pytest.raises(InputError, match=r"points must be \(n, 2\) finite numbers"):
        Supports(np.zeros((0, 2)))
