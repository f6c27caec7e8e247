"""Sweep: one experiment in many worlds and settings, each result a run of its own."""

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from slidepipe.artifacts.draft import Draft
from slidepipe.artifacts.experiment import Experiment, load_experiment
from slidepipe.artifacts.run import Run, outside_input
from slidepipe.artifacts.schema import dump_model, parse
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.strict_yaml import load
from slidepipe.artifacts.sweep import (
    Spread,
    SweepDocument,
    SweepSetting,
    SweepTrialDocument,
    SweepTry,
    WorldKind,
    numbers_of,
    sha256_of_rows,
    write_table,
)
from slidepipe.artifacts.sweep_sets import SweepSets, read_sets
from slidepipe.stages.plan_files import EXPERIMENT
from slidepipe.stages.sweep_worlds import SweepTask, World, experiment_of, work_on
from slidepipe.stages.workers import here, on_cluster, on_processes

STAGE, TRIAL_STAGE, STAGE_VERSION = "sweep", "sweep-trial", 2
SWEEP, SWEEP_TRIAL, TABLE = "sweep", "sweep_trial", "table"
"""Roles of the files."""
WORLDS_A_TASK = {"mechanics": 50, "lab": 1}
"""So that a task takes about a second: what a dead worker costs."""


@dataclass(frozen=True, slots=True)
class SweepRequest:
    """Which experiment, in which worlds, and who works on them; ``report`` is told how many of how many are done.

    ``trials`` worlds are drawn for each combination of the lists in ``sets``. ``workers`` is a number of processes, one
    for this process alone; ``scheduler`` the address of a Dask cluster, which stands over it.
    """

    experiment: Path
    store: Store
    report: Callable[[int, int], None]
    sets: tuple[str, ...] = ()
    trials: int = 1
    seed: int = 1
    world: WorldKind = "lab"
    workers: int = 1
    scheduler: str | None = None
    force: bool = False
    command: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class SweepResult:
    """The sweep's run and document."""

    run: Run
    document: SweepDocument


def run(request: SweepRequest) -> SweepResult:
    """Try out every world that was not tried out before, and tell what they come to.

    Raises
    ------
    InputError
        The experiment file or something that is set is wrong, or nobody answers at the scheduler's address.
    """
    began = time.monotonic()
    sets = read_sets(request.sets)
    experiment = load_experiment(request.experiment, sets.settings()[0])
    worlds = _worlds(request, sets, experiment)
    found = _found(request, worlds, experiment.name)
    reused = len(found)
    request.report(reused, len(worlds))
    todo = [world for world in worlds if world.index not in found]
    for told in _worked(request, todo):
        for one in told:
            _publish(request, worlds[one.index], one)
            found[one.index] = one
        request.report(len(found), len(worlds))
    ordered = [found[index] for index in range(len(worlds))]
    draft = _draft(request, STAGE, experiment.name, {"sets": list(request.sets), "trials": request.trials})
    with draft:
        document = _document(request, sets, ordered, reused, time.monotonic() - began)
        draft.add(SWEEP, "sweep.yaml").write_text(dump_model(document), encoding="utf-8")
        write_table(numbers_of(ordered), draft.add(TABLE, "worlds.csv"))
        draft.report("worlds", len(ordered), unit="1")
        draft.report("converged", float(np.mean([one.outcome == "converged" for one in ordered])), unit="1")
    return SweepResult(draft.run, document)


def _worlds(request: SweepRequest, sets: SweepSets, experiment: Experiment) -> list[World]:
    """Every world; each setting gets the same draws, so that settings are compared in the same worlds."""
    worlds: list[World] = []
    seeded = any(one.startswith("lab.seed=") for one in sets.settings()[0])
    document = load(request.experiment)
    for number, setting in enumerate(sets.settings()):
        for trial in range(request.trials):
            seed = () if seeded else (f"lab.seed={experiment.lab.seed + request.seed + trial}",)
            overrides = (*seed, *setting, *sets.draw(request.seed, trial))
            worlds.append(World(len(worlds), number, overrides))
        experiment_of(document, worlds[-1])  # what is set wrongly is told before anybody works
    return worlds


def _worked(request: SweepRequest, todo: list[World]) -> Iterator[tuple[SweepTrialDocument, ...]]:
    text = request.experiment.read_text(encoding="utf-8")
    size = WORLDS_A_TASK[request.world]
    tasks = [
        SweepTask(text, str(request.experiment), request.world, tuple(todo[first : first + size]))
        for first in range(0, len(todo), size)
    ]
    if not tasks:
        return iter(())
    if request.scheduler is not None:
        return on_cluster(work_on, tasks, request.scheduler)
    return here(work_on, tasks) if request.workers == 1 else on_processes(work_on, tasks, request.workers)


def _found(request: SweepRequest, worlds: list[World], experiment: str) -> dict[int, SweepTrialDocument]:
    """Worlds that were tried out before, by the recipe of their runs."""
    known = {} if request.force else {run.manifest.recipe: run for run in request.store.runs(stage=TRIAL_STAGE)}
    found = {}
    if known:
        for world in worlds:
            run = known.get(_trial_draft(request, world, experiment).recipe)
            if run is not None:
                told = parse(SweepTrialDocument, load(run.file(SWEEP_TRIAL)))
                found[world.index] = told.model_copy(update={"index": world.index, "setting": world.setting})
    return found


def _publish(request: SweepRequest, world: World, document: SweepTrialDocument) -> None:
    draft = _trial_draft(request, world, document.experiment)
    with draft:
        draft.add(SWEEP_TRIAL, "sweep_trial.yaml").write_text(dump_model(document), encoding="utf-8")
        last = document.trials[-1].error if document.trials else None
        if last is not None:
            draft.report("error", float(np.hypot(last.x_m, last.y_m)), unit="m")


def _trial_draft(request: SweepRequest, world: World, experiment: str) -> Draft:
    return _draft(request, TRIAL_STAGE, experiment, {"world": request.world, "overrides": list(world.overrides)})


def _draft(request: SweepRequest, stage: str, experiment: str, parameters: dict[str, object]) -> Draft:
    return request.store.draft(
        stage=stage,
        stage_version=STAGE_VERSION,
        experiment=experiment,
        parameters=parameters,
        inputs=(outside_input(EXPERIMENT, request.experiment),),
        seed=request.seed,
        command=request.command,
    )


def _document(
    request: SweepRequest, sets: SweepSets, trials: list[SweepTrialDocument], reused: int, seconds: float
) -> SweepDocument:
    settings = [
        _setting(setting, [one for one in trials if one.setting == number])
        for number, setting in enumerate(sets.settings())
    ]
    return SweepDocument(
        experiment=trials[0].experiment,
        world=request.world,
        sets=request.sets,
        seed=request.seed,
        worlds=len(trials),
        reused=reused,
        workers=request.scheduler or f"{request.workers} {'process' if request.workers == 1 else 'processes'}",
        seconds=seconds,
        settings=tuple(settings),
        numbers_sha256=sha256_of_rows(numbers_of(trials)),
        table_file="worlds.csv",
    )


def _setting(overrides: tuple[str, ...], trials: list[SweepTrialDocument]) -> SweepSetting:
    tried = [one for one in trials if one.trials]
    return SweepSetting(
        overrides=overrides,
        worlds=len(trials),
        lost_share=float(np.mean([one.outcome == "lost" for one in trials])),
        converged_share=float(np.mean([one.outcome == "converged" for one in trials])),
        first_trial=_spread([one.trials[0] for one in tried]),
        last_trial=_spread([one.trials[-1] for one in tried]),
    )


def _spread(tries: list[SweepTry]) -> Spread | None:
    errors = np.array([one.error.vector for one in tries if one.error is not None])
    if not len(errors):
        return None
    mean, std = np.mean(errors, axis=0), np.std(errors, axis=0, ddof=1 if len(errors) > 1 else 0)
    x, y, theta = (float(value) for value in mean)
    x_std, y_std, theta_std = (float(value) for value in std)
    return Spread(worlds=len(errors), mean=(x, y, theta), std=(x_std, y_std, theta_std))
