from pathlib import Path

import pytest
from PIL import Image

from slidepipe.artifacts.campaign import CampaignDocument
from slidepipe.artifacts.manifest import RunState
from slidepipe.artifacts.schema import parse
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.strict_yaml import load
from slidepipe.stages import campaign


def test_demonstration_lands_in_truth_and_not_only_in_the_estimate(regrasp) -> None:
    result, _, _ = regrasp
    last = result.document.rows[-1]
    assert result.document.converged
    assert len(result.document.rows) <= 5
    assert last.true_error_m < 1e-3
    assert last.true_error_rad < 10e-3
    assert last.error_m < 1e-3
    assert last.error_rad < 10e-3


def test_first_trial_falls_short_as_too_much_friction_makes_it(regrasp) -> None:
    first = regrasp[0].document.rows[0]
    assert 0.015 < first.true_error_m < 0.025
    assert first.believed_friction == 0.38
    assert first.true_friction == 0.4256


def test_friction_is_found_in_the_first_trial_and_believed_in_the_second(regrasp) -> None:
    first, second, *_ = regrasp[0].document.rows
    low, high = first.estimated_friction_interval_95
    assert low < 0.4256 < high
    assert first.estimated_friction == pytest.approx(0.4256, rel=0.01)
    assert second.believed_friction == pytest.approx(first.estimated_friction, rel=1e-6)


def test_estimate_and_truth_agree_on_where_the_block_is(regrasp) -> None:
    for row in regrasp[0].document.rows:
        reached, true = row.reached_relative_pose, row.true_relative_pose
        assert reached.x_m == pytest.approx(true.x_m, abs=1.5e-4)
        assert reached.y_m == pytest.approx(true.y_m, abs=1.5e-4)
        assert reached.theta_rad == pytest.approx(true.theta_rad, abs=1.5e-3)


def test_every_stage_is_a_run_and_the_campaign_names_them(regrasp) -> None:
    result, store, lines = regrasp
    stages = [run.manifest.stage for run in store.runs()]
    trials = len(result.document.rows)
    assert stages == ["plan", "execute", "estimate"] + ["iterate", "execute", "estimate"] * (trials - 1) + ["run"]
    assert {one.run for one in result.run.manifest.inputs} - {None} == {
        name for row in result.document.rows for name in (row.runs.plan, row.runs.execute, row.runs.estimate)
    }
    assert len(lines) == 3 * trials


def test_campaign_is_stored_as_it_was_told(regrasp) -> None:
    result, _, _ = regrasp
    assert parse(CampaignDocument, load(result.run.file("campaign"))) == result.document


def test_pictures_are_pictures(regrasp) -> None:
    result, _, _ = regrasp
    for role in (campaign.TRACKING, campaign.SLIDING):
        with Image.open(result.run.file(role)) as picture:
            assert picture.format == "PNG"
            assert min(picture.size) > 800


def test_each_trial_begins_where_the_last_one_really_ended(regrasp) -> None:
    result, store, _ = regrasp
    for before, after in zip(result.document.rows, result.document.rows[1:], strict=False):
        truth = load(store.get(after.runs.execute).file("truth")).data
        start = truth["initial_relative_pose"]
        assert start["x_m"] == pytest.approx(before.true_relative_pose.x_m, abs=5e-5)
        assert start["y_m"] == pytest.approx(before.true_relative_pose.y_m, abs=5e-5)
        assert start["theta_rad"] == pytest.approx(before.true_relative_pose.theta_rad, abs=5e-4)


def test_lost_block_ends_the_campaign_and_says_so(experiments: Path, store: Store) -> None:
    request = campaign.CampaignRequest(
        experiments / "regrasp.yaml", store, lambda _: None, overrides=("lab.friction=0.25",)
    )
    document = campaign.run(request).document
    assert not document.converged
    assert [row.outcome for row in document.rows] == ["lost"]
    assert document.outcome == "lost"
    assert "lost" in document.stopped_because
    assert "--resume" in document.what_to_do
    assert document.rows[0].reached_relative_pose is None
    states = {run.manifest.stage: run.manifest.state for run in store.runs()}
    assert states["execute"] is RunState.LOST
    assert states["estimate"] is RunState.LOST


def test_number_of_trials_is_kept_to(experiments: Path, store: Store) -> None:
    request = campaign.CampaignRequest(experiments / "regrasp.yaml", store, lambda _: None, trials=1)
    document = campaign.run(request).document
    assert len(document.rows) == 1
    assert not document.converged
    assert document.outcome == "out of trials"
    assert document.stopped_because is None
