"""A campaign goes on where it ended or was killed, and no trial is done twice."""

import os
import signal
import subprocess
import sys
from functools import partial
from pathlib import Path

import pytest

from slidepipe.artifacts.campaign import CampaignDocument
from slidepipe.artifacts.manifest import RunState
from slidepipe.artifacts.schema import parse
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.strict_yaml import load
from slidepipe.artifacts.why import WhyDocument
from slidepipe.stages import campaign
from slidepipe.stages.resume import KEPT


def killed_at(line: str, experiment: Path, data: Path) -> None:
    """Run with ``--resume`` until a line of progress begins as told, and then without a moment more."""
    command = [sys.executable, "-m", "slidepipe", "--data", str(data), "run", str(experiment), "--resume"]
    with subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True) as process:  # noqa: S603
        for told in process.stderr:
            if told.startswith(line):
                os.kill(process.pid, signal.SIGKILL)
                break
    assert process.returncode == -signal.SIGKILL


def test_killed_again_and_again_it_ends_as_if_it_had_not_been(experiments: Path, store: Store, regrasp) -> None:
    experiment, undisturbed = experiments / "regrasp.yaml", regrasp[0].document
    for line in (
        "trial 1: planned",
        "trial 1: executed",
        "trial 1: estimated",
        "trial 2: planned",
        "trial 2: executed",
    ):
        killed_at(line, experiment, store.root)
    request = campaign.CampaignRequest(experiment, store, lambda _: None, resume=True)
    document = campaign.run(request).document
    assert document.converged
    executed = [run for run in store.runs(stage="execute") if run.manifest.state is RunState.COMPLETE]
    assert len(executed) == len(document.rows) == len(undisturbed.rows)
    assert [row.true_relative_pose for row in document.rows] == [row.true_relative_pose for row in undisturbed.rows]
    assert [row.error_m for row in document.rows] == [row.error_m for row in undisturbed.rows]


def test_converged_campaign_is_shown_again_and_nothing_is_done(experiments: Path, regrasp) -> None:
    result, store, _ = regrasp
    before, lines = len(store.runs()), []
    request = campaign.CampaignRequest(experiments / "regrasp.yaml", store, lines.append, resume=True)
    assert campaign.run(request) == result
    assert len(store.runs()) == before
    assert lines[-1] == f"nothing to resume: campaign {result.run.id} has converged"


def test_more_trials_may_be_granted(experiments: Path, store: Store) -> None:
    request = campaign.CampaignRequest(experiments / "regrasp.yaml", store, lambda _: None, trials=1, resume=True)
    first = campaign.run(request).document
    assert (first.outcome, first.what_to_do) == ("out of trials", "go on with --resume --trials 4")
    again = campaign.run(request).document
    assert (again.outcome, len(again.rows)) == ("out of trials", 1)
    assert len(store.runs(stage="execute")) == 1


def test_lost_object_is_put_back_and_the_campaign_goes_on(experiments: Path, store: Store) -> None:
    def go(*, resume: bool) -> CampaignDocument:
        overrides = ("lab.friction=0.3", "iteration.max_trials=2")
        request = campaign.CampaignRequest(
            experiments / "regrasp.yaml", store, lambda _: None, overrides, resume=resume
        )
        return campaign.run(request).document

    assert go(resume=False).outcome == "lost"
    document = go(resume=True)
    first, second = document.rows
    assert (first.outcome, second.outcome) == ("lost", "held")
    assert second.believed_friction < 0.38
    assert second.true_error_m < 0.04
    why = parse(WhyDocument, load(store.get(second.runs.plan).file("why")))
    assert why.error_before is None
    assert why.friction_after.value < 0.33, "the thrown block tells how little friction there is"
    assert "put back" in why.changed[0]


def test_learned_arm_ends_nearer_than_one_that_is_not(experiments: Path, store: Store, regrasp) -> None:
    request = campaign.CampaignRequest(experiments / "regrasp.yaml", store, lambda _: None, trials=2, way="learned")
    second = campaign.run(request).document.rows[1]
    plain = regrasp[0].document.rows[1]
    assert second.true_error_m < 0.8 * plain.true_error_m
    rms = [
        load(where.get(row.runs.execute).file("trial")).data["tracking_error"]["position_rms_m"]
        for row, where in ((second, store), (plain, regrasp[1]))
    ]
    assert rms[0] < 0.9 * rms[1]
    told = load(store.get(second.runs.plan).file("arm")).data
    assert told["moving_mass"][1] == pytest.approx(0.05, abs=0.015)
    assert told["coulomb"][1] == pytest.approx(0.2, abs=0.1)


def test_ctrl_c_says_that_nothing_is_lost_where_something_is_done(experiments: Path, store: Store) -> None:
    def press(line: str, at: str) -> None:
        if line.startswith(at):
            raise KeyboardInterrupt

    for at, said in (("trial 1: planned", ""), ("trial 1: executed", KEPT)):
        request = campaign.CampaignRequest(experiments / "regrasp.yaml", store, partial(press, at=at))
        with pytest.raises(KeyboardInterrupt) as pressed:
            campaign.run(request)
        assert str(pressed.value) == said
