"""What an estimate may leave open beside friction: each is told where the motion tells it, and else said to be open."""

import numpy as np
import pytest
from synthetic import CASE_A, CASE_B, Cameras, request, simulate

from slidepipe.estimation.estimate import estimate
from slidepipe.estimation.laws import Laws

GOOD = {"position_noise_m": 5e-5, "angle_noise_rad": 5e-4}
"""Cameras six times as good as the paper's: what the pressure's exponent changes is small."""


def told_of(world, laws, seed, **cameras):
    return estimate(request(world, Cameras(seed=seed, **cameras), laws=laws))


@pytest.mark.parametrize(("case", "growth", "seed"), [(CASE_A, 0.3, 17), (CASE_B, 0.3, 18), (CASE_B, 0.0, 3)])
def test_growth_of_friction_with_speed(case, growth, seed):
    world = simulate(case, 0.38, seed, growth=growth)
    found = told_of(world, Laws(growth_sd_s_m=1.0), seed)
    assert found.friction.growth.told
    assert found.friction.growth.low < growth < found.friction.growth.high
    assert found.friction.growth.sd < 0.12
    low, high = found.friction.kappa_interval_m_s2.low, found.friction.kappa_interval_m_s2.high
    assert low < world.kappa < high
    assert not any("growth" in open_ or "grows" in open_ for open_ in found.not_told)


def test_growth_that_the_motion_does_not_tell():
    world = simulate(CASE_A, 0.38, 3)
    found = told_of(world, Laws(growth_sd_s_m=0.05), 3)
    assert not found.friction.growth.told
    assert any("growth of friction with speed could not be told: " in open_ for open_ in found.not_told)
    plain = told_of(world, Laws(), 3)
    assert found.friction.kappa_relative_sd > 3 * plain.friction.kappa_relative_sd
    assert plain.friction.growth is None


@pytest.mark.parametrize("seed", [1, 2, 4])
def test_static_friction_where_the_hand_works_up_to_it_slowly(seed):
    world = simulate(CASE_A, 0.36, seed, static=1.2, blur_s=0.03)
    found = told_of(world, Laws(sticking="apart"), seed)
    share = found.friction.static_share
    assert share.told
    assert share.low < 1.2 < share.high
    assert share.low > 1.0
    assert abs(np.log(found.friction.kappa_m_s2 / world.kappa)) < 3.5 * found.friction.kappa_relative_sd


@pytest.mark.parametrize("static", [1.0, 1.1])
@pytest.mark.parametrize("case", [CASE_A, CASE_B])
def test_static_friction_that_a_jerk_runs_over_cannot_be_told(case, static):
    world = simulate(case, 0.36, 1, static=static)
    found = told_of(world, Laws(sticking="apart"), 1)
    share = found.friction.static_share
    assert not share.told
    assert share.low <= static <= share.high
    assert any("mu_s / mu_k could not be told: 1.0" in open_ for open_ in found.not_told)
    assert abs(np.log(found.friction.kappa_m_s2 / world.kappa)) < 3.5 * found.friction.kappa_relative_sd


@pytest.mark.parametrize(("exponent", "seed"), [(1.0, 1), (2.0, 2), (np.inf, 2), (2.0, 5)])
def test_the_pressure_exponent_where_the_slide_turns_now_more_and_now_less(exponent, seed):
    world = simulate(CASE_B, 0.38, seed, exponent=exponent, swing_rad=0.3)
    found = told_of(world, Laws(surface="pressure"), seed, **GOOD)
    inverse = found.friction.inverse_exponent
    assert inverse.told
    assert inverse.low - 0.02 < 1.0 / exponent < inverse.high + 0.02
    assert inverse.high - inverse.low < 0.5
    assert found.friction.kappa_m_s2 == pytest.approx(world.kappa, rel=0.006)


@pytest.mark.parametrize("exponent", [1.0, np.inf])
def test_a_slide_of_even_turning_tells_no_pressure_exponent(exponent):
    """Whatever it is, friction itself is as uncertain as that leaves it."""
    world = simulate(CASE_B, 0.38, 1, exponent=exponent)
    found = told_of(world, Laws(surface="pressure"), 1)
    assert not found.friction.inverse_exponent.told
    assert any("the pressure exponent could not be told: 1/k = 0." in open_ for open_ in found.not_told)
    error = np.log(found.friction.kappa_m_s2 / world.kappa)
    assert abs(error) < 2.5 * found.friction.kappa_relative_sd
    assert 0.003 < found.friction.kappa_relative_sd < 0.01


@pytest.mark.parametrize(
    ("laws", "message"),
    [
        ({"growth_sd_s_m": -1.0}, "laws: growth_sd_s_m must be a number that is not negative"),
        ({"sticking": "more"}, "laws: sticking must be one of as_sliding, apart, got 'more'"),
        ({"surface": "round"}, "laws: surface must be one of ellipsoid, pressure, got 'round'"),
    ],
)
def test_laws_that_cannot_be(laws, message):
    with pytest.raises(Exception, match=message):
        Laws(**laws)
