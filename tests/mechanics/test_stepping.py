"""Implicit time stepping: exact stick, first order, n fingers, batches; and what it is refused."""

from collections.abc import Callable
from dataclasses import replace

import numba
import numpy as np
import pytest
from hand_draws import CASES, HANDS, SHAKES, SPEEDS, STARTS, energy, samples, shaken, stopped
from hypothesis import given, settings
from hypothesis import strategies as st
from paper_cases import BLOCK

from slidepipe.errors import InputError
from slidepipe.mechanics.limit_surface import SoftFinger
from slidepipe.mechanics.parameters import ParameterSets
from slidepipe.mechanics.simulate import simulate
from slidepipe.mechanics.stepping import PlacedFinger, step_many, step_through

LOOSE = SoftFinger(mu=0.4, f_N=1.5, a=0.02, c=0.6)
LONE = (PlacedFinger(LOOSE, np.zeros(2)),)
SPREAD = tuple(
    PlacedFinger(replace(LOOSE, f_N=0.5), np.array(place)) for place in ((0.01, 0.0), (-0.012, 0.004), (0.0, -0.015))
)


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("share", [0.97, 1.0, 1.05])
def test_half_the_step_is_half_the_error(name: str, share: float) -> None:
    regrasp, believed = CASES[name]
    finger = replace(believed, mu=believed.mu * share)
    exact = simulate(HANDS[name], BLOCK, finger, regrasp.r_start, tolerance=1e-11).r_f_b
    errors = []
    for step_s in (4e-4, 2e-4, 1e-4, 5e-5):
        time_s, q_f = samples(HANDS[name], step_s)
        stepped = step_through(time_s, q_f, BLOCK, (PlacedFinger(finger, np.zeros(2)),), regrasp.r_start)
        errors.append(np.linalg.norm((stepped.r_f_b[-1] - exact)[:2]))
    ratios = np.array(errors[:-1]) / np.array(errors[1:])
    np.testing.assert_allclose(ratios, 2.0, atol=0.1)
    assert errors[-1] < 5e-5


@pytest.mark.parametrize("fingers", [LONE, SPREAD], ids=["one", "three"])
def test_a_stuck_object_stays_to_the_last_bit_for_an_hour(fingers: tuple[PlacedFinger, ...]) -> None:
    time_s = 0.002 * np.arange(1_800_001)
    wave = 1.0 - np.cos(np.pi * time_s)
    q_f = np.stack([0.2 * wave, 0.1 * wave, 0.5 * wave], axis=1)
    r_f_b = np.array([0.004, -0.003, 0.3])
    held = step_through(time_s, q_f, BLOCK, fingers, r_f_b)
    assert np.all(held.r_f_b == r_f_b)
    assert held.sliding_steps == 0


@given(SHAKES, STARTS, st.integers(2, 4))
@settings(max_examples=15)
def test_coincident_fingers_are_one_of_their_force(
    accelerations: list[tuple[float, float, float]], r_f_b: np.ndarray, count: int
) -> None:
    time_s, q_f = samples(shaken(accelerations), 1e-3)
    share = PlacedFinger(replace(LOOSE, f_N=LOOSE.f_N / count), np.zeros(2))
    one, many = (step_through(time_s, q_f, BLOCK, fingers, r_f_b) for fingers in (LONE, (share,) * count))
    np.testing.assert_allclose(many.r_f_b, one.r_f_b, atol=1e-8)
    assert many.residual < 1e-9


def test_a_finger_beside_the_origin_is_a_hand_about_another_point() -> None:
    """The same motion of the same contact, told of another point of the hand; apart by the step's error."""
    regrasp, finger = CASES["rotational"]
    time_s, q_f = samples(HANDS["rotational"], 1e-4)
    place = np.array([0.03, -0.02])
    moved = np.array([np.append(pose[:2] - _turned(pose[2], place), pose[2]) for pose in q_f])
    start = np.append(regrasp.r_start[:2] - _turned(regrasp.r_start[2], place), regrasp.r_start[2])
    there = step_through(time_s, moved, BLOCK, (PlacedFinger(finger, place),), start).r_f_b
    here = step_through(time_s, q_f, BLOCK, (PlacedFinger(finger, np.zeros(2)),), regrasp.r_start).r_f_b
    carried = np.array([r[:2] + _turned(r[2], place) for r in there])
    np.testing.assert_allclose(carried, here[:, :2], atol=2e-5)
    np.testing.assert_allclose(there[:, 2], here[:, 2], atol=5e-4)


@given(SPEEDS, STARTS)
@settings(max_examples=25)
def test_sliding_in_a_resting_hand_only_loses_energy(velocity: np.ndarray, r_f_b: np.ndarray) -> None:
    hand = stopped(velocity)
    for fingers in (LONE, SPREAD):
        time_s, q_f = samples(hand, 1e-3)
        path = step_through(time_s, q_f, BLOCK, fingers, r_f_b).r_f_b[time_s >= hand.breaks[-1]]
        dr = np.diff(path, axis=0) / 1e-3
        left = energy(BLOCK, q_f[-1], path[1:], dr)
        lost = 0.4 * 1.5 * np.linalg.norm(dr[:, :2], axis=1) * 1e-3
        assert np.all(np.diff(left) < 1e-9 + 0.05 * lost[1:])


def test_three_fingers_apart_hold_a_turn_that_one_cannot() -> None:
    turn = shaken([(0.0, 0.0, 150.0)], spell_s=0.02)
    time_s, q_f = samples(turn, 2e-4)
    thin = [replace(placed, finger=replace(placed.finger, a=1e-3)) for placed in SPREAD]
    lone = PlacedFinger(replace(LOOSE, a=1e-3), np.zeros(2))
    assert step_through(time_s, q_f, BLOCK, (lone,), np.zeros(3)).sliding_steps > 0
    assert step_through(time_s, q_f, BLOCK, tuple(thin), np.zeros(3)).sliding_steps == 0


def test_a_batch_is_its_trials_bit_for_bit_on_one_core_or_all() -> None:
    regrasp, finger = CASES["linear"]
    frictions = finger.mu * np.linspace(0.95, 1.1, 20)
    time_s, q_f = samples(HANDS["linear"], 1e-3)
    sets = ParameterSets.of(BLOCK, finger, regrasp.r_start, mu=frictions)
    together = step_many(time_s, q_f, sets)
    for row, mu in zip(together, frictions, strict=True):
        alone = (PlacedFinger(replace(finger, mu=mu), np.zeros(2)),)
        np.testing.assert_array_equal(step_through(time_s, q_f, BLOCK, alone, regrasp.r_start).r_f_b[-1], row)
    threads = numba.get_num_threads()
    numba.set_num_threads(1)
    try:
        np.testing.assert_array_equal(step_many(time_s, q_f, sets), together)
    finally:
        numba.set_num_threads(threads)


def _turned(angle: float, place: np.ndarray) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c * place[0] - s * place[1], s * place[0] + c * place[1]])


def _step(time_s: list[float], q: float = 0.0, fingers: tuple[PlacedFinger, ...] = LONE, r: float = 0.0) -> None:
    step_through(np.array(time_s), np.full((3, 3), q), BLOCK, fingers, np.full(3, r))


BAD = [
    (lambda: _step([0.0, 1.0, 0.5]), "times must grow, got 0.5 s after 1.0 s"),
    (lambda: _step([0.0, 1.0]), "must go together"),
    (lambda: _step([0.0, 1.0, 2.0], q=np.nan), "the hand's motion must be finite"),
    (lambda: _step([0.0, 1.0, np.inf]), "the hand's motion must be finite"),
    (lambda: _step([0.0, 1.0, 2.0], r=np.nan), "r_f_b must be three finite numbers"),
    (lambda: _step([0.0, 1.0, 2.0], fingers=()), "a grasp needs at least one finger, got none"),
    (lambda: _step([0.0, 1.0, 2.0], fingers=(PlacedFinger(LOOSE, np.array([0.0, np.nan])),)), "the place of finger 1"),
]


@pytest.mark.parametrize(("make", "message"), BAD)
def test_bad_values_are_told(make: Callable[[], object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        make()
