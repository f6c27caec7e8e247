import numpy as np
import pytest

from slidepipe.estimation.poses import Track
from slidepipe.estimation.slide import Slide
from slidepipe.estimation.slide_ends import LAW_SD_S, RelativePath, refine_ends

NOISE = np.array([3e-4, 3e-4, 3e-3])
TRUE_START_S, TRUE_STOP_S, TOP_S = 0.2037, 0.3962, 0.3
ROUGH = Slide(0.211, 0.389, 0.006, 0.006, 0.3, 0.02, 1)


def path(seed=None, dropout=0.0):
    """A slide at constant acceleration, then at constant deceleration, along all three axes."""
    time_s = np.arange(0.05, 0.55, 1 / 360)
    speed_up = np.clip(time_s, TRUE_START_S, TOP_S) - TRUE_START_S
    slow_down = TRUE_STOP_S - np.clip(time_s, TOP_S, TRUE_STOP_S)
    travel = 0.5 * speed_up**2 - 0.5 * slow_down**2
    pose = np.array([0.01, -0.02, 3.0]) + travel[:, None] * [2.0, 3.0, 20.0]
    rng = np.random.default_rng(seed)
    if seed is not None:
        pose += rng.normal(size=pose.shape) * NOISE
    valid = rng.uniform(size=len(time_s)) >= dropout
    return RelativePath(time_s, Track(np.where(valid[:, None], pose, 0.0), valid), NOISE)


def test_the_ends_of_an_exact_parabola():
    found = refine_ends(ROUGH, path(), TOP_S)
    assert found.start_s == pytest.approx(TRUE_START_S, abs=5e-4)
    assert found.stop_s == pytest.approx(TRUE_STOP_S, abs=5e-4)
    assert (found.peak_speed_m_s, found.travel_m, found.pieces) == (0.3, 0.02, 1)


def test_stated_deviations_are_true_on_noisy_poses_with_dropouts():
    normalized = []
    for seed in range(150):
        found = refine_ends(ROUGH, path(seed, dropout=0.1), TOP_S)
        for end, sd, true in (
            (found.start_s, found.start_sd_s, TRUE_START_S),
            (found.stop_s, found.stop_sd_s, TRUE_STOP_S),
        ):
            normalized.append((end - true) / np.sqrt(sd**2 - LAW_SD_S**2))
    assert abs(np.mean(normalized)) < 0.3
    assert 0.8 < np.std(normalized) < 1.25


def test_an_end_with_few_frames_stays_where_it_was():
    seen = path()
    hidden = seen.relative.valid & (np.abs(seen.time_s - ROUGH.stop_s) > 0.07)
    found = refine_ends(ROUGH, RelativePath(seen.time_s, Track(seen.relative.pose, hidden), NOISE), TOP_S)
    assert (found.stop_s, found.stop_sd_s) == (ROUGH.stop_s, ROUGH.stop_sd_s)
    assert found.start_s == pytest.approx(TRUE_START_S, abs=5e-4)
