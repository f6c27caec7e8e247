"""Run: plan, execute, estimate and iterate until the goal is reached."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from slidepipe.artifacts.campaign import CampaignDocument, CampaignRow, CampaignRuns
from slidepipe.artifacts.draft import Draft
from slidepipe.artifacts.experiment import Experiment, load_experiment
from slidepipe.artifacts.manifest import InputRef, RunState
from slidepipe.artifacts.run import Run, outside_input
from slidepipe.artifacts.schema import dump_model
from slidepipe.artifacts.store import Store
from slidepipe.errors import LabError, RefusedError
from slidepipe.stages import estimate, execute, iterate, plan
from slidepipe.stages.on_lab import RealLab
from slidepipe.stages.pictures import TrialRuns, draw_pictures
from slidepipe.stages.plan_files import EXPERIMENT, PLAN
from slidepipe.stages.trial_facts import TRIAL

STAGE, STAGE_VERSION = "run", 1
CAMPAIGN, TRACKING, SLIDING = "campaign", "tracking", "sliding"
"""Roles of a campaign's files."""


@dataclass(frozen=True, slots=True)
class CampaignRequest:
    """Which experiment to run; ``trials`` and ``friction`` stand over its own; ``report`` is told of every stage.

    ``lab`` is a lab over the network; the simulated one in virtual time unless given.
    """

    experiment: Path
    store: Store
    report: Callable[[str], None]
    overrides: tuple[str, ...] = ()
    trials: int | None = None
    friction: str | None = None
    command: tuple[str, ...] = ()
    lab: RealLab | None = None


@dataclass(frozen=True, slots=True)
class CampaignResult:
    """The campaign's run and document."""

    run: Run
    document: CampaignDocument


@dataclass(frozen=True, slots=True)
class _Trial:
    plan: plan.PlanResult | iterate.IterateResult
    execute: execute.ExecuteResult
    estimate: estimate.EstimateResult

    @property
    def runs(self) -> TrialRuns:
        plan_run = self.plan.run
        if plan_run is None:
            raise RefusedError("run: a trial without a plan")
        return TrialRuns(plan_run, self.execute.run, self.estimate.run)


@dataclass(frozen=True, slots=True)
class _Outcome:
    trials: tuple[_Trial, ...]
    converged: bool
    stopped_because: str | None


def run(request: CampaignRequest) -> CampaignResult:
    """Run the whole loop; every stage is a run of its own, and the table and the pictures are one more.

    Raises
    ------
    InputError
        The experiment file is wrong.
    InfeasibleError
        The first motion breaks a limit. A later one that does ends the campaign, which says so.
    """
    experiment = load_experiment(request.experiment, request.overrides)
    first = plan.run(plan.PlanRequest(request.experiment, request.store, request.overrides, command=request.command))
    request.report(f"trial 1: planned {first.run.id}")
    outcome = _loop(request, experiment, first)
    draft = request.store.draft(
        stage=STAGE,
        stage_version=STAGE_VERSION,
        experiment=experiment.name,
        parameters=experiment.model_dump(mode="json"),
        inputs=_inputs(request, outcome),
        seed=experiment.lab.seed if request.lab is None else None,
        command=request.command,
    )
    with draft:
        document = _document(experiment, outcome)
        _write(draft, document, experiment, outcome)
    return CampaignResult(draft.run, document)


def _loop(request: CampaignRequest, experiment: Experiment, first: plan.PlanResult) -> _Outcome:
    trials: list[_Trial] = []
    planned: plan.PlanResult | iterate.IterateResult = first
    limit = request.trials or experiment.iteration.max_trials
    while True:
        try:
            trials.append(_run_trial(request, planned, len(trials) + 1))
        except (RefusedError, LabError) as failure:
            if not trials:
                raise
            return _Outcome(tuple(trials), converged=False, stopped_because=str(failure).replace("\n", "; "))
        told = trials[-1].estimate
        if told.document.lost is not None:
            return _Outcome(tuple(trials), converged=False, stopped_because=told.document.lost)
        if told.document.final_relative_pose and iterate.within_tolerance(
            told.document.final_relative_pose, experiment
        ):
            return _Outcome(tuple(trials), converged=True, stopped_because=None)
        if len(trials) == limit:
            return _Outcome(tuple(trials), converged=False, stopped_because=None)
        try:
            planned = iterate.run(
                iterate.IterateRequest(told.run.id, request.store, request.friction, command=request.command)
            )
        except RefusedError as refusal:
            return _Outcome(tuple(trials), converged=False, stopped_because="; ".join(refusal.lines))
        if planned.document is not None and planned.run is not None:
            request.report(f"trial {len(trials) + 1}: planned {planned.run.id}: {planned.document.reason}")


def _run_trial(request: CampaignRequest, planned: plan.PlanResult | iterate.IterateResult, number: int) -> _Trial:
    if planned.run is None:
        raise RefusedError("run: there is nothing left to plan")
    done = execute.run(execute.ExecuteRequest(planned.run.id, request.store, command=request.command, lab=request.lab))
    request.report(f"trial {number}: executed {done.run.id}: {done.document.outcome}")
    refuse_unfinished(done)
    told = estimate.run(estimate.EstimateRequest(done.run.id, request.store, command=request.command))
    request.report(f"trial {number}: estimated {told.run.id}")
    return _Trial(planned, done, told)


def refuse_unfinished(done: execute.ExecuteResult) -> None:
    """Refuse to go on from a trial that tells nothing of the slide.

    Raises
    ------
    KeyboardInterrupt
        A person stopped the arm.
    LabError
        It was stopped for another reason, or the stream did not keep time.
    """
    trial, state = done.document, done.run.manifest.state
    if state is RunState.INTERRUPTED:
        raise KeyboardInterrupt
    if state is RunState.STOPPED:
        raise LabError(f"trial {done.run.id} was stopped: {trial.stopped}")
    if trial.invalid is not None:
        raise LabError(f"trial {done.run.id} is invalid: {trial.invalid}")


def _inputs(request: CampaignRequest, outcome: _Outcome) -> tuple[InputRef, ...]:
    inputs = [outside_input(EXPERIMENT, request.experiment)]
    for trial in outcome.trials:
        inputs += [
            trial.runs.plan.input(PLAN),
            trial.runs.execute.input(TRIAL),
            trial.runs.estimate.input(estimate.ESTIMATE),
        ]
    return tuple(inputs)


def _document(experiment: Experiment, outcome: _Outcome) -> CampaignDocument:
    return CampaignDocument(
        experiment=experiment.name,
        rows=tuple(_row(number, trial, experiment) for number, trial in enumerate(outcome.trials, start=1)),
        converged=outcome.converged,
        stopped_because=outcome.stopped_because,
        pictures=("tracking.png", "sliding.png"),
    )


def _row(number: int, trial: _Trial, experiment: Experiment) -> CampaignRow:
    told, truth, planned = trial.estimate.document, trial.execute.truth, trial.plan.document
    if planned is None:
        raise RefusedError("run: a trial without a plan")
    reached = told.final_relative_pose
    left = iterate.miss(reached, experiment) if reached else None
    really = iterate.miss(truth.final_relative_pose, experiment) if truth else None
    return CampaignRow(
        trial=number,
        runs=CampaignRuns(plan=trial.runs.plan.id, execute=trial.runs.execute.id, estimate=trial.runs.estimate.id),
        outcome="held" if told.lost is None else "lost",
        planned_relative_pose=planned.goal_relative_pose,
        reached_relative_pose=reached,
        true_relative_pose=truth.final_relative_pose if truth else None,
        error_m=left.position_m if left else None,
        error_rad=left.angle_rad if left else None,
        true_error_m=really.position_m if really else None,
        true_error_rad=really.angle_rad if really else None,
        believed_friction=planned.believed.friction,
        estimated_friction=told.friction.mu.value if told.friction else None,
        estimated_friction_interval_95=told.friction.mu.interval_95 if told.friction else None,
        true_friction=truth.friction if truth else None,
    )


def _write(draft: Draft, document: CampaignDocument, experiment: Experiment, outcome: _Outcome) -> None:
    draft.add(CAMPAIGN, "campaign.yaml").write_text(dump_model(document), encoding="utf-8")
    shown = [outcome.trials[0].runs, outcome.trials[-1].runs][: len(outcome.trials)]
    draw_pictures(shown, experiment, draft.add(TRACKING, "tracking.png"), draft.add(SLIDING, "sliding.png"))
    draft.report("trials", len(document.rows), unit="1")
    last = document.rows[-1]
    if last.error_m is not None and last.error_rad is not None:
        draft.report("error", last.error_m, unit="m")
        draft.report("turn_error", last.error_rad, unit="rad")
