"""Section III-D: Theorem 1's equations as printed, its proof's steps, and whether repeating does converge."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from one_dof_draws import ACCELERATIONS, EXAMPLE, PROFILES

from slidepipe.errors import InputError
from slidepipe.mechanics.one_dof import Accelerations, Profile
from slidepipe.mechanics.theorem_1 import (
    contraction_bound,
    contraction_factor,
    d_2,
    d_3,
    eps_limits,
    friction_acceleration,
    slide_ratio,
    theorem_1,
)

SHARES = st.floats(0.0, 1.0)
WEAK_GRIP_HARD_PULL = Accelerations(a_f=30.0, a_o=10.0, a=1.0)
"""``3 a < a_o``: the unsaid fourth condition fails before the first and the second do."""


def printed(s: Accelerations, eps: np.ndarray) -> np.ndarray:
    """(4, N) the three conditions in the paper's words, mu_0 f_N = a_o, and the fourth."""
    mu0, f_N, a, a_f = s.a_o / 2.5, 2.5, s.a, s.a_f
    fourth = a + (1 - 2 * eps) * f_N * mu0
    with np.errstate(divide="ignore"):
        third = a_f > f_N * mu0 * (a * (1 + eps) + (1 - eps) * f_N * mu0) / fourth
    return np.array([a < mu0 * f_N * (1 - eps), a_f > mu0 * f_N * (1 + eps), third, fourth > 0])


def remaining(s: Accelerations, b: float, *, trials: int) -> list[float]:
    """What is left after each trial, each planned for what the last one left, eq. (7)."""
    left = [-0.1]
    while len(left) <= trials and abs(left[-1]) > 1e-200:
        left.append(left[-1] - Profile(s, left[-1]).slide(b).d)
    return left


def within(s: Accelerations, eps: float, share: float) -> float:
    return s.a_o * (1.0 + eps * (2.0 * share - 1.0))


@given(PROFILES, SHARES)
def test_d2_and_d3_are_those_of_the_paper(profile: Profile, eps: float) -> None:
    assume(eps < 1.0)
    a_f, a_o, a = profile.accelerations.a_f, profile.accelerations.a_o, profile.accelerations.a
    T2, T3, a_eps = profile.T2, profile.T3, profile.accelerations.a_o * eps
    sign = -np.sign(profile.d_goal)
    five = -0.5 * a_eps * (a + a_f) * (T2**2 + T2 * T3) / (a + a_o + a_eps)
    six = -0.5 * a_eps * (a + a_f) * (T2**2 + T2 * T3) / (a + a_o - a_eps)
    assert d_2(profile, eps) == pytest.approx(sign * five, rel=1e-12)
    assert d_3(profile, eps) == pytest.approx(sign * six, rel=1e-12)


@given(PROFILES, SHARES, SHARES)
def test_d2_and_d3_are_the_extremes_of_the_exact_slide(profile: Profile, part: float, share: float) -> None:
    limits = eps_limits(profile.accelerations)
    eps = part * min(limits.sticks, limits.slides) * (1 - 1e-12)
    shortest, longest = (profile.slide(profile.accelerations.a_o * (1 + e)).d for e in (eps, -eps))
    size = abs(longest)
    assert shortest == pytest.approx(profile.d_goal - d_2(profile, eps), abs=1e-10 * size)
    assert longest == pytest.approx(profile.d_goal + d_3(profile, eps), abs=1e-10 * size)
    between = profile.slide(within(profile.accelerations, eps, share)).d
    assert abs(shortest) - 1e-10 * size <= abs(between) <= size * (1 + 1e-10)


@given(PROFILES, SHARES)
def test_the_ratio_is_that_of_the_exact_slides(profile: Profile, share: float) -> None:
    s = profile.accelerations
    b = min(s.a + share * (s.a_f - s.a), s.a_f)
    ratio = float(slide_ratio(s, b))
    assert ratio == pytest.approx(profile.slide(b).d / profile.d_goal, rel=1e-9, abs=1e-12)
    assert contraction_factor(s, b) == pytest.approx(abs(1.0 - ratio), rel=1e-9, abs=1e-11)


@given(ACCELERATIONS)
def test_more_friction_slides_less(s: Accelerations) -> None:
    ratios = slide_ratio(s, np.linspace(s.a, s.a_f, 50))
    assert np.all(np.diff(ratios) < 0.0)
    assert slide_ratio(s, s.a_o) == pytest.approx(1.0, rel=1e-12)


@given(ACCELERATIONS, SHARES)
def test_each_condition_has_the_papers_two_sides(s: Accelerations, eps: float) -> None:
    assume(eps < 1.0)
    theorem = theorem_1(s, eps)
    first, second, third, fourth = theorem.conditions
    assert (first.relation, second.relation, third.relation, fourth.relation) == ("<", ">", ">", ">")
    assert (first.left, second.left, third.left, fourth.right) == (s.a, s.a_f, s.a_f, 0.0)
    assert first.right == pytest.approx(s.a_o * (1 - eps))
    assert second.right == pytest.approx(s.a_o * (1 + eps))
    assert third.right * fourth.left == pytest.approx(s.a_o * (s.a * (1 + eps) + (1 - eps) * s.a_o), rel=1e-9)
    assert fourth.left == pytest.approx(s.a + (1 - 2 * eps) * s.a_o, abs=1e-9 * s.a_o)
    assert theorem.holds == (first.holds and second.holds and third.holds and fourth.holds)
    for one, limit in ((first, "sticks"), (second, "slides"), (fourth, "can_stop")):
        bound = getattr(eps_limits(s), limit)
        if abs(eps - bound) > 1e-9:
            assert one.holds == (eps < bound)


@given(ACCELERATIONS, SHARES)
def test_the_second_is_d2_and_the_third_with_the_fourth_d3_shorter_than_the_goal(s: Accelerations, eps: float) -> None:
    """The steps (8) and (9) of the proof, which hold both ways."""
    assume(eps < 1.0)
    profile, theorem = Profile(s, -0.1), theorem_1(s, eps)
    under, over = abs(d_2(profile, eps)) / 0.1, abs(d_3(profile, eps)) / 0.1
    if abs(under - 1.0) > 1e-9:
        assert theorem.slides.holds == (under < 1.0)
    if abs(over - 1.0) > 1e-9:
        assert (theorem.stops.holds and theorem.can_stop.holds) == (over < 1.0)


@given(ACCELERATIONS)
def test_eps_star_is_what_a_scan_of_the_printed_conditions_finds(s: Accelerations) -> None:
    limits = eps_limits(s)
    eps = np.linspace(0.0, 1.5, 3001)
    eps = eps[np.min(np.abs(eps[:, None] - [limits.sticks, limits.slides, limits.stops, limits.can_stop]), 1) > 1e-9]
    holds = printed(s, eps)
    np.testing.assert_array_equal(np.all(holds, axis=0), eps < limits.eps_star)
    np.testing.assert_array_equal(holds[0], eps < limits.sticks)
    np.testing.assert_array_equal(holds[1], eps < limits.slides)
    np.testing.assert_array_equal((holds[2] & holds[3])[eps < 1], (eps < limits.stops)[eps < 1])
    np.testing.assert_array_equal(holds[3], eps < limits.can_stop)


@given(ACCELERATIONS)
def test_just_below_eps_star_all_holds_and_just_above_what_binds_does_not(s: Accelerations) -> None:
    limits = eps_limits(s)
    assert 0.0 < limits.eps_star < 1.0
    assert theorem_1(s, limits.eps_star * (1 - 1e-9)).holds
    above = theorem_1(s, limits.eps_star + 1e-9)
    assert not above.holds
    assert not getattr(above, limits.binding).holds
    assert limits.stops < limits.slides
    assert limits.stops < limits.can_stop


@given(ACCELERATIONS, SHARES, SHARES)
def test_inside_eps_star_every_friction_shrinks_the_error_by_no_less_than_the_bound(
    s: Accelerations, part: float, share: float
) -> None:
    eps = part * eps_limits(s).eps_star * (1 - 1e-9)
    bound = contraction_bound(s, eps)
    assert bound < 1.0
    assert contraction_factor(s, within(s, eps, share)) <= bound + 1e-10
    assert contraction_factor(s, s.a_o * (1 - eps)) == pytest.approx(bound, abs=1e-9), "least friction is the worst"


@given(ACCELERATIONS, st.floats(0.0, 0.95), SHARES)
def test_inside_eps_star_repeating_ends_at_the_goal(s: Accelerations, part: float, share: float) -> None:
    eps = part * eps_limits(s).eps_star
    b, k = within(s, eps, share), contraction_bound(s, eps)
    trials = 200
    left = np.abs(remaining(s, b, trials=trials))
    assert np.all(left[1:] <= left[:-1] * (k + 1e-9))
    assert left[-1] <= 0.1 * (k + 1e-9) ** (len(left) - 1)
    if k < 0.9:
        assert left[-1] < 1e-10


@given(ACCELERATIONS)
def test_each_trial_shrinks_by_the_same_factor(s: Accelerations) -> None:
    b = s.a_o * (1 + 0.5 * eps_limits(s).eps_star)
    left = remaining(s, b, trials=5)
    k = contraction_factor(s, b)
    for before, after in pairwise(left):
        assert abs(after) == pytest.approx(k * abs(before), rel=1e-6, abs=1e-15)


@given(ACCELERATIONS, st.floats(0.01, 0.99))
def test_outside_eps_star_repeating_flies_apart_where_the_third_condition_binds(s: Accelerations, share: float) -> None:
    limits = eps_limits(s)
    assume(limits.stops < 0.999 * limits.sticks)
    eps = limits.stops + share * (limits.sticks - limits.stops)
    left = np.abs(remaining(s, s.a_o * (1 - eps), trials=20))
    assert np.all(np.diff(left) > 0.0)


def test_the_counterexample_in_numbers() -> None:
    """``a = 1, a_o = 10, a_f = 30``: eps* = 220/510; friction 45 % smaller leaves more than there was."""
    limits = eps_limits(WEAK_GRIP_HARD_PULL)
    assert limits.eps_star == pytest.approx(220 / 510, rel=1e-14)
    assert limits.binding == "stops"
    assert contraction_factor(WEAK_GRIP_HARD_PULL, 5.5) == pytest.approx((24.5 / 6.5) / (20 / 11) - 1, rel=1e-12)
    assert abs(remaining(WEAK_GRIP_HARD_PULL, 5.5, trials=50)[-1]) > 1.0
    assert abs(remaining(WEAK_GRIP_HARD_PULL, 6.0, trials=50)[-1]) < 1e-2


def test_without_the_fourth_condition_the_theorem_as_printed_is_wrong() -> None:
    """All three printed conditions hold at eps = 0.7, and what is left grows nearly threefold each time."""
    theorem = theorem_1(WEAK_GRIP_HARD_PULL, 0.7)
    assert [condition.holds for condition in theorem.conditions] == [True, True, True, False]
    assert theorem.stops.right < 0.0
    assert not theorem.holds
    assert contraction_factor(WEAK_GRIP_HARD_PULL, 3.0) == pytest.approx((27 / 4) / (20 / 11) - 1, rel=1e-12)
    assert abs(remaining(WEAK_GRIP_HARD_PULL, 3.0, trials=10)[-1]) > 1e3


def test_no_a_f_is_large_enough_where_the_fourth_condition_is_an_equality() -> None:
    s = Accelerations(a_f=1e9, a_o=8.0, a=2.0)
    condition = theorem_1(s, 0.625).stops
    assert condition.right == np.inf
    assert not condition.holds


def test_where_the_first_condition_binds_repeating_may_still_converge() -> None:
    """The conditions are enough, not needed: here the block slips back a little and comes nearer all the same."""
    assert eps_limits(EXAMPLE).binding == "sticks"
    b = EXAMPLE.a_o * (1 - eps_limits(EXAMPLE).eps_star - 0.01)
    assert Profile(EXAMPLE, -0.1).slide(b).slips_in_T1
    assert contraction_factor(EXAMPLE, b) < 1.0


@given(ACCELERATIONS, st.floats(1.0, 10.0))
def test_friction_that_holds_on_leaves_everything_as_it_was(s: Accelerations, more: float) -> None:
    assert contraction_factor(s, s.a_f * more) == 1.0


@given(ACCELERATIONS, st.floats(0.01, 100), SHARES)
def test_neither_factor_nor_limit_depends_on_units(s: Accelerations, unit: float, share: float) -> None:
    scaled = Accelerations(s.a_f * unit, s.a_o * unit, s.a * unit)
    limits, there = eps_limits(s), eps_limits(scaled)
    for name in ("sticks", "slides", "stops", "can_stop", "eps_star"):
        assert getattr(there, name) == pytest.approx(getattr(limits, name), rel=1e-9)
    b = within(s, 0.9, share)
    assert contraction_factor(scaled, b * unit) == pytest.approx(contraction_factor(s, b), rel=1e-6, abs=1e-9)


def test_friction_acceleration_is_that_of_a_mass() -> None:
    assert friction_acceleration(0.38, 1.25, 0.023) == pytest.approx(20.652, abs=1e-3)


@pytest.mark.parametrize("name", ["mu", "f_N", "m"])
@pytest.mark.parametrize("value", [0.0, -0.1, np.nan, np.inf])
def test_friction_is_made_of_positive_numbers(name: str, value: float) -> None:
    with pytest.raises(InputError, match=rf"^one DOF: {name} must be a positive number, got {value!r}$"):
        friction_acceleration(**({"mu": 0.38, "f_N": 1.25, "m": 0.023} | {name: value}))


@pytest.mark.parametrize("eps", [-0.1, 1.0, np.nan])
def test_a_friction_error_is_a_share(eps: float) -> None:
    for refused in (theorem_1, lambda s, e: d_2(Profile(s, 1.0), e), lambda s, e: d_3(Profile(s, 1.0), e)):
        with pytest.raises(InputError, match=r"^Theorem 1: eps must be at least 0 and below 1, got "):
            refused(EXAMPLE, eps)


@pytest.mark.parametrize("eps", [-0.1, 0.21, np.nan])
def test_the_bound_is_not_told_where_the_object_slips_while_it_should_stick(eps: float) -> None:
    with pytest.raises(InputError, match=r"^contraction bound: eps must be from 0 to 1 - a/a_o = 0\.2, got "):
        contraction_bound(EXAMPLE, eps)


@pytest.mark.parametrize("b", [3.9, 20.1, np.nan])
def test_the_ratio_is_not_told_outside_its_range(b: float) -> None:
    with pytest.raises(InputError, match=r"^slide ratio: a_o must be from a = 4\.0 to a_f = 20\.0 m/s\^2, got "):
        slide_ratio(EXAMPLE, [5.0, b])
