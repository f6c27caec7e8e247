import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slidepipe.mechanics.hand_motion import HandMotion
from slidepipe.mechanics.rounded_hand import GRID, rounded


def motion(seed: int) -> HandMotion:
    random = np.random.default_rng(seed)
    breaks = np.cumsum(np.concatenate([[0.0], random.uniform(0.02, 0.5, 4)]))
    coefficients = random.uniform(-1.0, 1.0, (4, 8, 3)) / np.diff(breaks)[:, None, None] ** np.arange(8)[:, None]
    return HandMotion(breaks, coefficients, np.ones(5, dtype=bool))


@given(st.integers(0, 10_000))
def test_it_is_the_same_motion(seed: int) -> None:
    hand = motion(seed)
    times = np.linspace(hand.breaks[0], hand.breaks[-1], 200)[:-1]
    assert np.abs(rounded(hand).at(times) - hand.at(times)).max() < 5.0 * GRID


@given(st.integers(0, 10_000))
def test_last_bits_do_not_matter(seed: int) -> None:
    hand = motion(seed)
    jitter = 1.0 + 4e-16 * np.random.default_rng(seed).standard_normal(hand.coefficients.shape)
    other = rounded(HandMotion(hand.breaks, hand.coefficients * jitter, hand.jumps))
    assert np.mean(other.coefficients != rounded(hand).coefficients) < 0.3


def test_breaks_and_jumps_stay() -> None:
    hand = motion(1)
    assert rounded(hand).breaks == pytest.approx(hand.breaks, abs=0.0)
    assert rounded(hand).jumps.tolist() == hand.jumps.tolist()
