"""Estimators on public recordings, which lie beside the checkout or are not there."""

import numpy as np
import pytest
from support.public_data import (
    FOLDER,
    PULL_N,
    PUSH_LOGS,
    Sampling,
    push_pairs,
    push_supports,
    read_stream,
    toss_friction,
)

from slidepipe.errors import EstimationError
from slidepipe.estimation.surface_fit import Supports, fit_surface

pytestmark = pytest.mark.skipif(not FOLDER.is_dir(), reason="the public recordings are not beside the checkout")


@pytest.mark.parametrize("log", PUSH_LOGS)
@pytest.mark.parametrize("larger_only", [True, False])
def test_pushes_tell_the_force_that_pulled_the_block(log: str, larger_only: bool) -> None:
    fit = fit_surface(push_pairs(log, Sampling(larger_only)), push_supports(log))
    assert fit.friction_n == pytest.approx(PULL_N, rel=0.1)
    assert fit.friction_std_n < 0.06 * PULL_N


@pytest.mark.parametrize("log", PUSH_LOGS[:3])
def test_on_three_points_the_exact_surface_tells_the_direction_better_than_the_ellipsoid(log: str) -> None:
    fit = fit_surface(push_pairs(log), push_supports(log))
    assert fit.exact_error.median < np.radians(11.0)
    assert fit.exact_error.median < 0.7 * fit.ellipsoid_error.median
    assert fit.models_apart.median > np.radians(5.0)


@pytest.mark.parametrize("log", PUSH_LOGS[:3])
def test_the_load_of_each_point_is_found_from_the_pushes_alone(log: str) -> None:
    known = push_supports(log)
    fit = fit_surface(push_pairs(log), Supports(known.points))
    assert fit.shares == pytest.approx(known.shares, abs=0.06)
    assert np.abs(fit.shares - known.shares).max() < 2.5 * fit.shares_std.max()
    assert fit.friction_n == pytest.approx(PULL_N, rel=0.1)


def test_flat_slides_of_tossed_cubes() -> None:
    found = toss_friction()
    assert len(found.mu) > 150
    assert np.median(found.mu) == pytest.approx(0.216, abs=0.008)
    low, high = np.percentile(found.mu, [5.0, 95.0])
    assert 0.18 < low < 0.216 < high
    assert found.pooled.within_std < 0.5 * found.pooled.between_std


@pytest.mark.parametrize(("name", "step_mm", "turn_deg"), [("pos2", 0.1, 0.3), ("pos8", 2.5, 4.0), ("pos9", 1.0, 2.5)])
def test_streams_are_smoothed_through_losses_and_swapped_markers(name: str, step_mm: float, turn_deg: float) -> None:
    stream = read_stream(name)
    assert stream.lost > 50
    assert max(stream.raw_jump_m / 0.02, stream.raw_jump_rad / 2.0) > 1.0
    assert stream.smoothed_jump_m < 1e-3 * step_mm
    assert 0.0 < stream.loss_jump_m < 1.2e-3
    assert stream.smoothed_jump_rad < np.radians(turn_deg)
    seen = stream.believed.valid
    away = stream.smoothed.pose[seen] - stream.believed.pose[seen]
    assert np.median(np.hypot(away[:, 0], away[:, 1])) < 1e-4


def test_a_run_that_was_never_tracked_is_refused() -> None:
    with pytest.raises(EstimationError, match=r"pos_s: the block was tracked in 84 of 2896 frames, half are needed"):
        read_stream("pos_s")
