"""Repeat: one plan, executed and estimated many times from the same start."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from slidepipe.artifacts.experiment import Experiment, load_experiment
from slidepipe.artifacts.manifest import RunState
from slidepipe.artifacts.repeat import Repeatability, RepeatDocument, Repetition
from slidepipe.artifacts.run import Run, outside_input
from slidepipe.artifacts.schema import dump_model, parse
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.strict_yaml import load
from slidepipe.artifacts.trial import TruthDocument
from slidepipe.artifacts.values import Pose
from slidepipe.stages import estimate, execute, plan
from slidepipe.stages.goal import error_of
from slidepipe.stages.plan_files import EXPERIMENT, PLAN
from slidepipe.stages.resume import resumable
from slidepipe.stages.trial_files import TRUTH

STAGE, STAGE_VERSION = "repeat", 1
REPEAT = "repeat"
ENDED = (RunState.COMPLETE, RunState.LOST)


@dataclass(frozen=True, slots=True)
class RepeatRequest:
    """Which experiment and how often; ``report`` is told of every stage.

    With ``resume``, repetitions of the same plan that were executed before count.
    """

    experiment: Path
    store: Store
    report: Callable[[str], None]
    count: int
    overrides: tuple[str, ...] = ()
    resume: bool = False
    command: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class RepeatResult:
    """The repetitions' run and document."""

    run: Run
    document: RepeatDocument


def run(request: RepeatRequest) -> RepeatResult:
    """Execute the experiment's first plan again and again.

    Raises
    ------
    InputError
        The experiment file is wrong.
    InfeasibleError
        The motion breaks a limit.
    """
    experiment = load_experiment(request.experiment, request.overrides)
    planned = plan.run(plan.PlanRequest(request.experiment, request.store, request.overrides, command=request.command))
    done = _done(request.store, planned.run) if request.resume else {}
    rows: list[Repetition] = []
    with resumable(lambda: bool(_done(request.store, planned.run))):
        for number in range(1, request.count + 1):
            rows.append(_repetition(request, experiment, planned.run, number, done.get(number)))
            request.report(f"repetition {number} of {request.count}: {rows[-1].outcome}")
    draft = request.store.draft(
        stage=STAGE,
        stage_version=STAGE_VERSION,
        experiment=experiment.name,
        parameters=experiment.model_dump(mode="json") | {"count": request.count},
        inputs=(outside_input(EXPERIMENT, request.experiment), planned.run.input(PLAN)),
        seed=experiment.lab.seed,
        command=request.command,
    )
    with draft:
        document = _document(experiment, planned.run, tuple(rows))
        draft.add(REPEAT, "repeat.yaml").write_text(dump_model(document), encoding="utf-8")
        draft.report("repetitions", len(rows), unit="1")
        draft.report("lost", document.lost, unit="1")
    return RepeatResult(draft.run, document)


def _done(store: Store, plan_run: Run) -> dict[int, Run]:
    """Trials that repeated this plan before, by their number."""
    return {
        int(str(run.manifest.parameters[execute.REPETITION])): run
        for run in store.runs(stage=execute.STAGE)
        if run.manifest.state in ENDED
        and execute.REPETITION in run.manifest.parameters
        and any(one.run == plan_run.id for one in run.manifest.inputs)
    }


def _repetition(
    request: RepeatRequest, experiment: Experiment, plan_run: Run, number: int, done: Run | None
) -> Repetition:
    trial = done
    if trial is None:
        asked = execute.ExecuteRequest(plan_run.id, request.store, repetition=number, command=request.command)
        trial = execute.run(asked).run
    told = estimate.run(estimate.EstimateRequest(trial.id, request.store, command=request.command))
    final, truth = told.document.final_relative_pose, _truth(trial)
    return Repetition(
        repetition=number,
        execute=trial.id,
        estimate=told.run.id,
        outcome="lost" if final is None else "held",
        error=None if final is None else error_of(final, experiment),
        true_error=None if truth is None or final is None else error_of(truth.final_relative_pose, experiment),
    )


def _truth(trial: Run) -> TruthDocument | None:
    if all(one.role != TRUTH for one in trial.manifest.outputs):
        return None
    return parse(TruthDocument, load(trial.file(TRUTH)))


def _document(experiment: Experiment, plan_run: Run, rows: tuple[Repetition, ...]) -> RepeatDocument:
    return RepeatDocument(
        experiment=experiment.name,
        plan=plan_run.id,
        rows=rows,
        lost=sum(row.outcome == "lost" for row in rows),
        estimated=_repeatability(row.error for row in rows),
        true=_repeatability(row.true_error for row in rows),
    )


def _repeatability(errors: Iterable[Pose | None]) -> Repeatability | None:
    known = np.array([error.vector for error in errors if error is not None])
    if not len(known):
        return None
    x, y, theta = (float(value) for value in np.mean(known, axis=0))
    if len(known) == 1:
        return Repeatability(trials=1, mean=(x, y, theta), std=None)
    x_std, y_std, theta_std = (float(value) for value in np.std(known, axis=0, ddof=1))
    return Repeatability(trials=len(known), mean=(x, y, theta), std=(x_std, y_std, theta_std))
