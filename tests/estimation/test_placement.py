"""How well it is known where the finger is on the hand, in the interval of friction."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from synthetic import CASE_A, CASE_B, Cameras, request, simulate

from slidepipe.estimation.estimate import estimate

AS_CALIBRATED = np.array([0.001, 0.001, 0.005])


def with_markers_elsewhere(asked, offset_m):
    """The same trial by someone who is wrong by ``offset_m`` (3,) about where the finger is on the hand."""
    hand = asked.mocap.hand
    away = Rotation.from_quat(hand.quaternion_xyzw).apply(offset_m)
    return replace(asked, mocap=replace(asked.mocap, hand=replace(hand, position_m=hand.position_m + away)))


@pytest.fixture(scope="module")
def turning():
    world = simulate(CASE_B, 0.38, 3)
    return world, request(world, Cameras(seed=3))


@pytest.mark.parametrize("axis", [0, 1])
def test_the_deviation_is_what_a_wrong_place_does(turning, axis):
    _, asked = turning
    off = np.eye(3)[axis] * 0.001
    plain = estimate(asked).friction
    wrong = estimate(replace(with_markers_elsewhere(asked, off), hand_place_sd=np.abs(off))).friction
    change = np.log(wrong.kappa_m_s2 / plain.kappa_m_s2)
    said = np.sqrt(wrong.kappa_relative_sd**2 - plain.kappa_relative_sd**2)
    assert said == pytest.approx(abs(change), rel=0.1)
    assert said > 0.006


def test_the_interval_of_a_calibrated_trial_holds_where_one_without_would_not(turning):
    world, asked = turning
    held, blind = 0, 0
    for seed in range(8):
        off = np.append(np.random.default_rng(seed).normal(size=2) * AS_CALIBRATED[:2], 0.0)
        wrong = with_markers_elsewhere(asked, off)
        plain = estimate(wrong).friction.kappa_interval_m_s2
        wide = estimate(replace(wrong, hand_place_sd=AS_CALIBRATED)).friction.kappa_interval_m_s2
        blind += plain.low < world.kappa < plain.high
        held += wide.low < world.kappa < wide.high
    assert held >= 7
    assert blind <= 4


def test_a_slide_that_does_not_turn_hardly_minds_where_the_finger_is():
    world = simulate(CASE_A, 0.38, 3)
    asked = request(world, Cameras(seed=3))
    plain, placed = (estimate(replace(asked, hand_place_sd=sd)).friction for sd in (None, AS_CALIBRATED))
    assert plain.kappa_relative_sd < placed.kappa_relative_sd < 1.2 * plain.kappa_relative_sd


def test_a_place_that_is_hardly_known_leaves_nothing_to_tell(turning):
    found = estimate(replace(turning[1], hand_place_sd=20 * AS_CALIBRATED))
    assert found.friction is None
    assert "the slide tells kappa to 3" in found.friction_reason
