"""Section VI simulated by events: against plans, an independent integration, closed forms and the laws of friction."""

from collections.abc import Callable
from dataclasses import replace

import numba
import numpy as np
import pytest
from free_fall import falling_hand
from hand_draws import CASES, HANDS, SHAKES, SPEEDS, STARTS, energy, seen_from, shaken, stopped
from hypothesis import given, settings
from hypothesis import strategies as st
from paper_cases import BLOCK
from sliding_by_scipy import Trial

from slidepipe.errors import InputError
from slidepipe.mechanics.dynamics import GRAVITY, Block
from slidepipe.mechanics.hand_motion import HandMotion
from slidepipe.mechanics.limit_surface import SoftFinger
from slidepipe.mechanics.one_dof import Accelerations, Profile
from slidepipe.mechanics.parameters import ParameterSets
from slidepipe.mechanics.simulate import Ended, relative_motion, simulate, simulate_many

ACCURATE = np.array([1e-8, 1e-8, 1e-7])
LOOSE = SoftFinger(mu=0.4, f_N=1.5, a=0.02, c=0.6)


@pytest.mark.parametrize("name", CASES)
def test_a_planned_motion_ends_at_its_goal_and_slides_when_it_should(name: str) -> None:
    regrasp, finger = CASES[name]
    outcome = simulate(HANDS[name], BLOCK, finger, regrasp.r_start)
    assert np.all(np.abs(outcome.r_f_b - regrasp.r_goal) < ACCURATE)
    assert (outcome.ended, outcome.slides) == (Ended.STUCK, 1)
    assert outcome.slide_start_s == pytest.approx(regrasp.T1, abs=1e-9)
    assert outcome.slide_stop_s == pytest.approx(regrasp.T1 + regrasp.T23, abs=1e-5)


@pytest.mark.parametrize("name", CASES)
def test_the_way_there_is_the_planned_one(name: str) -> None:
    """The bang-bang profile of Fig. 6, in closed form, also between the knots."""
    regrasp, finger = CASES[name]
    time_s = np.linspace(0.0, regrasp.boundaries[-1], 301)
    t = np.clip(time_s - regrasp.T1, 0.0, regrasp.T23)[:, None]
    back = regrasp.T23 - t
    early = regrasp.r_start + 0.5 * regrasp.ddr * t**2
    planned = np.where(t < back, early, regrasp.r_goal - 0.5 * regrasp.ddr * back**2)
    outcome = simulate(HANDS[name], BLOCK, finger, regrasp.r_start)
    found = relative_motion(outcome, regrasp.r_start, time_s)
    np.testing.assert_allclose(found, planned, atol=1e-6)


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("share", [0.94, 0.97, 1.0, 1.05, 1.15])
def test_it_agrees_with_an_independent_integration(name: str, share: float) -> None:
    regrasp, believed = CASES[name]
    finger = replace(believed, mu=believed.mu * share)
    outcome = simulate(HANDS[name], BLOCK, finger, regrasp.r_start)
    trial = Trial(HANDS[name], BLOCK, finger, regrasp.r_start)
    np.testing.assert_allclose(outcome.r_f_b[:2], trial.r[:2], atol=5e-8)
    assert outcome.r_f_b[2] == pytest.approx(trial.r[2], abs=2e-6)
    assert outcome.slide_start_s == pytest.approx(trial.slides[0][0], abs=1e-8)
    assert outcome.slide_stop_s == pytest.approx(trial.slides[-1][1], abs=1e-4)


@pytest.mark.parametrize("name", CASES)
def test_a_tighter_tolerance_comes_closer(name: str) -> None:
    regrasp, finger = CASES[name]
    finger = replace(finger, mu=0.97 * finger.mu)
    runs = [
        simulate(HANDS[name], BLOCK, finger, regrasp.r_start, tolerance=t).r_f_b for t in (1e-4, 1e-7, 1e-10, 1e-12)
    ]
    far, near, nearest = (np.max(np.abs(run - runs[-1])[:2]) for run in runs[:-1])
    assert nearest < near < far
    assert (far < 1e-4, near < 1e-6, nearest < 1e-9) == (True, True, True)


@given(SPEEDS, STARTS)
@settings(max_examples=40)
def test_an_object_that_slides_in_a_resting_hand_only_loses_energy(velocity: np.ndarray, r_f_b: np.ndarray) -> None:
    hand = stopped(velocity)
    outcome = simulate(hand, BLOCK, LOOSE, r_f_b)
    assert outcome.ended != Ended.FAILED
    knots = outcome.knots[outcome.knots[:, 0] >= hand.breaks[-1]]
    if len(knots) > 1:
        left = energy(BLOCK, hand.at(hand.breaks[-1:])[0], knots[:, 1:4], knots[:, 4:7])
        assert np.all(np.diff(left) < 1e-11)


@given(SHAKES, STARTS, st.floats(-2, 2), st.floats(-2, 2), st.sampled_from([-1.0, 1.0]))
@settings(max_examples=25)
def test_it_does_not_matter_where_it_is_seen_from(
    accelerations: list[tuple[float, float, float]], r_f_b: np.ndarray, x: float, y: float, mirror: float
) -> None:
    """Elsewhere, turned with the object in the hand, or in a mirror that leaves gravity where it is."""
    hand, flip = shaken(accelerations), np.array([mirror, 1.0, mirror])
    here = simulate(hand, BLOCK, LOOSE, r_f_b)
    there = simulate(seen_from(hand, np.array([x, y, 0.0]), mirror), BLOCK, LOOSE, flip * r_f_b)
    assert there.ended == here.ended
    if here.ended == Ended.STUCK:
        np.testing.assert_allclose(there.r_f_b, flip * here.r_f_b, atol=1e-6)


@given(st.floats(0.75, 1.4), st.floats(0.0, 6.3))
@settings(max_examples=25)
def test_one_degree_of_freedom_in_the_plane_is_section_iii(share: float, heading: float) -> None:
    """In a hand that falls freely there is no gravity: what is left is the finger's motion along one line.

    The patch is wide, for the block to stay straight while the fall is braked.
    """
    profile = Profile(Accelerations(a_f=40.0, a_o=20.0, a=14.0), d_goal=-0.02)
    slide = profile.slide(20.0 * share)
    finger = SoftFinger(mu=0.4, f_N=20.0 * share * BLOCK.m / 0.4, a=0.3, c=0.6)
    outcome = simulate(falling_hand(profile, heading), BLOCK, finger, np.zeros(3))
    along = np.array([np.cos(heading), np.sin(heading)])
    assert outcome.r_f_b[:2] == pytest.approx(slide.d * along, abs=2e-8)
    assert outcome.r_f_b[2] == pytest.approx(0.0, abs=1e-9)
    assert outcome.slide_start_s == pytest.approx(profile.T1, abs=1e-9)


def test_a_hand_that_rests_keeps_its_object_where_it_is_to_the_last_bit() -> None:
    hand = HandMotion(np.array([0.0, 3600.0]), np.zeros((1, 3, 3)), np.array([True, True]))
    r_f_b = np.array([0.01, -0.02, 0.3])
    outcome = simulate(hand, BLOCK, LOOSE, r_f_b)
    np.testing.assert_array_equal(outcome.r_f_b, r_f_b)
    assert (outcome.ended, outcome.slides) == (Ended.STUCK, 0)


def test_too_weak_a_grip_loses_the_block() -> None:
    regrasp, finger = CASES["linear"]
    weak = replace(finger, mu=0.4 * finger.mu)
    assert simulate(HANDS["linear"], BLOCK, weak, regrasp.r_start).ended == Ended.LEFT


def test_a_batch_is_its_trials_bit_for_bit_on_one_core_or_all() -> None:
    regrasp, finger = CASES["rotational"]
    frictions = finger.mu * np.linspace(0.95, 1.1, 40)
    sets = ParameterSets.of(BLOCK, finger, regrasp.r_start, mu=frictions)
    together = simulate_many(HANDS["rotational"], sets)
    single = [simulate(HANDS["rotational"], BLOCK, replace(finger, mu=mu), regrasp.r_start) for mu in frictions]
    np.testing.assert_array_equal(together.r_f_b, [one.r_f_b for one in single])
    np.testing.assert_array_equal(together.slide_stop_s, [one.slide_stop_s for one in single])
    threads = numba.get_num_threads()
    numba.set_num_threads(1)
    try:
        np.testing.assert_array_equal(simulate_many(HANDS["rotational"], sets).r_f_b, together.r_f_b)
    finally:
        numba.set_num_threads(threads)


def _still(q: float = 0.0, end_s: float = 1.0) -> HandMotion:
    return HandMotion(np.array([0.0, end_s]), np.full((1, 3, 3), q), np.array([True, True]))


def _simulated(r_f_b: list[float], **options: float) -> None:
    simulate(_still(), BLOCK, LOOSE, np.array(r_f_b), **options)


def _sets(**values: np.ndarray) -> None:
    ParameterSets.of(BLOCK, LOOSE, np.zeros(3), **values)


BAD = [
    (lambda: Block(0.06, 0.1, -0.02), "block: m must be a positive number, got -0.02"),
    (lambda: SoftFinger(0.0, 1.0, 0.02, 0.6), "soft finger: mu must be a positive number, got 0.0"),
    (lambda: _still(np.nan), "hand motion: every pose must be finite, got NaN or infinity"),
    (lambda: _still(end_s=-1.0), "hand motion: breaks must grow, got -1.0 s after 0.0 s"),
    (lambda: _simulated([0.0, np.nan, 0.0]), "r_f_b must be three finite numbers"),
    (lambda: _simulated([0.05, 0.0, 0.0]), "r_f_b must begin on the object's face"),
    (lambda: _simulated([0.0, 0.0, 0.0], tolerance=0.0), "tolerance must be from 1e-14 to 1e-3 m, got 0.0"),
    (lambda: _sets(mu=np.array([0.3, -0.1])), "mu must be positive numbers"),
    (lambda: _sets(mu=np.ones(2), m=np.ones(3)), "same number of trials"),
    (lambda: HandMotion.from_function(lambda t: np.full((len(t), 3), np.nan), np.array([0.0, 1.0])), "finite"),
    (lambda: HandMotion.from_samples(np.array([0.0, 1.0, 0.5]), *np.zeros((3, 3, 3))), "grow, got 0.5 s after 1.0 s"),
]


@pytest.mark.parametrize(("make", "message"), BAD)
def test_bad_values_are_told(make: Callable[[], object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        make()


@pytest.mark.parametrize("over", [0.0, 1e-15, 1e-13, 1e-11, 1e-9])
@pytest.mark.parametrize("rises", [True, False], ids=["to a peak", "and stays"])
def test_load_that_grazes_what_the_grip_bears_moves_nothing_and_comes_to_rest(over: float, rises: bool) -> None:
    """The needed force passes the limit by a hair, for a moment or for half of the motion."""
    block, peak, T = Block(length=0.06, width=0.1, m=0.023), 20.0, 0.4
    w = 2.0 * np.pi / T

    def poses(time_s: np.ndarray) -> np.ndarray:
        t = np.asarray(time_s)
        swung = peak / w * t - peak / w**2 * np.sin(w * t)
        pushed = np.where(t < T / 2, peak * t**2 / 2, peak * (T * t - T**2 / 4 - t**2 / 2))
        return np.stack([swung if rises else pushed, 0.0 * t, 0.0 * t], axis=-1)

    finger = SoftFinger(1.0, block.m * np.hypot(peak, GRAVITY) / (1.0 + over), a=0.0174, c=0.6)
    hand = HandMotion.from_function(poses, np.linspace(0.0, T, 9 if rises else 3))
    told = simulate(hand, block, finger, np.zeros(3))
    assert told.ended is Ended.STUCK
    assert np.max(np.abs(told.r_f_b)) < 2e-9
