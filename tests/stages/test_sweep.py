"""Worlds are the same wherever they are tried out, and a worker that dies costs nothing but time."""

import logging
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from distributed import LocalCluster
from dying import always_die, square_and_die_once

from slidepipe.artifacts.schema import parse
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.strict_yaml import load
from slidepipe.artifacts.sweep import SweepTrialDocument
from slidepipe.artifacts.sweep_sets import read_sets
from slidepipe.errors import InputError, SlidepipeError
from slidepipe.stages import sweep, workers

FRICTIONS = "lab.friction=0.35..0.44"


@pytest.fixture
def ask(experiments: Path, tmp_path: Path):
    def request(name: str, *sets: str, **more: object) -> sweep.SweepRequest:
        choices = {"world": "mechanics", "trials": 60, "report": lambda _done, _all: None} | more
        return sweep.SweepRequest(experiments / "regrasp.yaml", Store(tmp_path / name), sets=sets, **choices)

    return request


@pytest.fixture
def cluster() -> Iterator[object]:
    with LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, silence_logs=logging.CRITICAL
    ) as two:
        yield two


def test_one_process_two_and_a_cluster_come_to_the_same_numbers(ask, cluster) -> None:
    alone = sweep.run(ask("one", FRICTIONS)).document
    both = sweep.run(ask("two", FRICTIONS, workers=2)).document
    dask = sweep.run(ask("dask", FRICTIONS, scheduler=cluster.scheduler_address)).document
    assert alone.numbers_sha256 == both.numbers_sha256 == dask.numbers_sha256
    assert alone.settings == both.settings == dask.settings
    marker = str(ask("dask").store.root / "died")
    done = workers.on_cluster(square_and_die_once, [(n, marker) for n in range(8)], cluster.scheduler_address)
    assert sorted(done) == [n * n for n in range(8)]
    assert Path(marker).exists()


def test_work_of_a_killed_process_is_done_again(tmp_path: Path) -> None:
    marker = tmp_path / "died"
    done = workers.on_processes(square_and_die_once, [(n, str(marker)) for n in range(6)], 2)
    assert sorted(done) == [n * n for n in range(6)]
    assert marker.exists()


def test_work_that_always_kills_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(workers, "MOST_DEATHS", 0)
    with pytest.raises(SlidepipeError, match="worker processes were ended 1 times"):
        list(workers.on_processes(always_die, [1], 1))


def test_nobody_at_the_scheduler(ask, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(workers, "CONNECT_S", 0.2)
    with pytest.raises(InputError, match=r"--scheduler tcp://127.0.0.1:9: nobody answers there"):
        sweep.run(ask("nobody", FRICTIONS, scheduler="tcp://127.0.0.1:9"))


def test_each_world_is_a_run_and_is_not_tried_again(ask) -> None:
    request = ask("again", FRICTIONS, "motion.slide_s=[0.14, 0.12]", trials=5)
    first = sweep.run(request)
    trials = request.store.runs(stage=sweep.TRIAL_STAGE)
    assert len(trials) == first.document.worlds == 10
    told = [parse(SweepTrialDocument, load(run.file(sweep.SWEEP_TRIAL))) for run in trials]
    assert [one.index for one in told] == list(range(10))
    assert [one.setting for one in told] == [0] * 5 + [1] * 5
    again = sweep.run(request).document
    assert (again.reused, again.numbers_sha256) == (10, first.document.numbers_sha256)
    more = sweep.run(ask("again", FRICTIONS, "motion.slide_s=[0.14, 0.12]", trials=6)).document
    assert (more.reused, more.worlds) == (10, 12)
    assert len(request.store.runs(stage=sweep.TRIAL_STAGE)) == 12


def test_less_friction_than_believed_slides_farther(ask) -> None:
    document = sweep.run(ask("friction", "lab.friction=[0.36, 0.38, 0.40, 0.3]", trials=1)).document
    low, right, high, lost = document.settings
    assert low.first_trial.mean[1] > 0.002
    assert abs(right.first_trial.mean[1]) < 1e-4
    assert high.first_trial.mean[1] < -0.002
    assert (lost.lost_share, lost.first_trial) == (1.0, None)


def test_a_setting_without_a_plan_says_so(ask) -> None:
    request = ask("none", "grasp.normal_force_per_finger_n=5.0", trials=1)
    assert sweep.run(request).document.settings[0].first_trial is None
    told = parse(SweepTrialDocument, load(request.store.runs(stage=sweep.TRIAL_STAGE)[0].file(sweep.SWEEP_TRIAL)))
    assert told.outcome == "no plan"
    assert "beyond" in told.why_ended


def test_whole_loop_in_the_simulated_lab(ask) -> None:
    document = sweep.run(ask("lab", "lab.friction=0.4256", "iteration.max_trials=2", world="lab", trials=1)).document
    only = document.settings[0]
    assert only.first_trial.mean[1] == pytest.approx(-0.0178, abs=1e-3)
    assert abs(only.last_trial.mean[1]) < 2e-3


def test_what_is_drawn_depends_on_seed_and_index_alone() -> None:
    sets = read_sets(["a=0..1", "b=-2..2"])
    draws = [sets.draw(7, index) for index in range(200)]
    assert draws == [sets.draw(7, index) for index in range(200)]
    assert draws != [sets.draw(8, index) for index in range(200)]
    values = np.array([[float(text.partition("=")[2]) for text in draw] for draw in draws])
    assert np.all((values >= [0.0, -2.0]) & (values <= [1.0, 2.0]))
    assert np.abs(values.mean(axis=0) - [0.5, 0.0]).max() < 0.2


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("friction", "--set friction: must read key=value"),
        ("friction=0.4..0.3", "a range must grow from low to high"),
        ("friction=a..b", "the ends of a range must be two numbers"),
        ("friction=[]", "a list must have one value or more"),
        ("friction=[0.3", "--set friction=[0.3: value:"),
    ],
)
def test_sets_that_cannot_be_read(text: str, message: str) -> None:
    with pytest.raises(InputError) as caught:
        read_sets([text])
    assert message in str(caught.value)


def test_unknown_key_is_told_before_anybody_works(ask) -> None:
    with pytest.raises(InputError, match=r"lab\.colour: unknown key"):
        sweep.run(ask("unknown", "lab.colour=0..1"))
