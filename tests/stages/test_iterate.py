from collections.abc import Callable

import pytest

from slidepipe.artifacts.store import Store
from slidepipe.errors import RefusedError
from slidepipe.stages import estimate, iterate


def test_next_plan_starts_where_the_last_trial_was_seen_to_end(regrasp) -> None:
    result, store, _ = regrasp
    first = result.document.rows[0]
    again = iterate.run(iterate.IterateRequest(first.runs.estimate, store))
    assert again.reused
    assert again.document.trial == 2
    assert again.document.previous_estimate == first.runs.estimate
    assert again.document.start_relative_pose.x_m == pytest.approx(first.reached_relative_pose.x_m, abs=1e-9)
    assert again.document.goal_relative_pose.vector == (0.01, 0.02, 3.141592653589793)
    assert again.document.reason.startswith("19.1")


def test_shorter_slide_keeps_the_accelerations(regrasp) -> None:
    """Theorem 1: the accelerations stay, and the times go with the square root of the distance."""
    result, store, _ = regrasp
    document = iterate.run(iterate.IterateRequest(result.document.rows[0].runs.estimate, store)).document
    slide_s = document.slide.stop_s - document.slide.start_s
    share = result.document.rows[0].error_m / 0.0447214
    assert slide_s == pytest.approx(0.14 * share**0.5, abs=0.003)


def test_friction_may_be_kept(regrasp) -> None:
    result, store, _ = regrasp
    request = iterate.IterateRequest(result.document.rows[0].runs.estimate, store, way="goal")
    assert iterate.run(request).document.believed.friction == 0.38


def test_goal_reached_leaves_nothing_to_plan(regrasp) -> None:
    result, store, _ = regrasp
    count = len(store.runs())
    outcome = iterate.run(iterate.IterateRequest(result.document.rows[-1].runs.estimate, store))
    assert outcome.run is None
    assert outcome.document is None
    assert len(store.runs()) == count


def test_block_that_never_slid_raises_the_belief(try_out: Callable, store: Store) -> None:
    _, told = try_out("regrasp", "lab.friction=0.6")
    assert told.document.slide is None
    assert told.document.friction is None
    document = iterate.run(iterate.IterateRequest(told.run.id, store)).document
    assert document.believed.friction == pytest.approx(0.38 * (1 + 9.1268 / 20.652), rel=1e-3)
    assert "not sliding" in document.reason


def test_lost_block_has_to_be_put_back(try_out: Callable, store: Store) -> None:
    done, told = try_out("regrasp", "lab.friction=0.25")
    assert done.document.outcome == "lost"
    with pytest.raises(RefusedError, match="put it back into the grip"):
        iterate.run(iterate.IterateRequest(told.run.id, store))


def test_estimate_is_found_again(regrasp) -> None:
    result, store, _ = regrasp
    again = estimate.run(estimate.EstimateRequest(result.document.rows[0].runs.execute, store))
    assert again.reused
    assert again.run.id == result.document.rows[0].runs.estimate
