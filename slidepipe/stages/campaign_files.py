"""A campaign as files: its table, and the pictures of its first and last trial."""

from dataclasses import dataclass
from pathlib import Path

from slidepipe.artifacts.campaign import CampaignDocument, CampaignRow, CampaignRuns
from slidepipe.artifacts.draft import Draft
from slidepipe.artifacts.experiment import Experiment
from slidepipe.artifacts.manifest import InputRef
from slidepipe.artifacts.run import Run, outside_input
from slidepipe.artifacts.schema import dump_model, parse
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.strict_yaml import load
from slidepipe.artifacts.trial import TruthDocument
from slidepipe.artifacts.why import WhyDocument
from slidepipe.stages.estimate import ESTIMATE
from slidepipe.stages.goal import miss
from slidepipe.stages.past import PastTrial
from slidepipe.stages.pictures import TrialRuns, draw_pictures
from slidepipe.stages.plan_files import EXPERIMENT, PLAN
from slidepipe.stages.stopping import Stop
from slidepipe.stages.trial_facts import TRIAL
from slidepipe.stages.trial_files import TRUTH

STAGE, STAGE_VERSION = "run", 2
CAMPAIGN, TRACKING, SLIDING = "campaign", "tracking", "sliding"
"""Roles of a campaign's files."""
WHY = "why"
"""Role, in a plan's run, of the file that says why it is as it is."""


@dataclass(frozen=True, slots=True)
class CampaignResult:
    """The campaign's run and document."""

    run: Run
    document: CampaignDocument


@dataclass(frozen=True, slots=True)
class CampaignEnd:
    """The trials of a campaign, the first one first, and how it ended."""

    trials: tuple[PastTrial, ...]
    stop: Stop


def publish(
    store: Store, path: Path, experiment: Experiment, end: CampaignEnd, command: tuple[str, ...]
) -> CampaignResult:
    """Write the table and the pictures as a run."""
    draft = store.draft(
        stage=STAGE,
        stage_version=STAGE_VERSION,
        experiment=experiment.name,
        parameters=experiment.model_dump(mode="json"),
        inputs=_inputs(path, end),
        seed=experiment.lab.seed,
        command=command,
    )
    with draft:
        document = campaign_document(experiment, end)
        _write(draft, document, experiment, end)
    return CampaignResult(draft.run, document)


def campaign_document(experiment: Experiment, end: CampaignEnd) -> CampaignDocument:
    """Campaign's table: what every trial planned, reached and expected, and how it ended."""
    return CampaignDocument(
        experiment=experiment.name,
        rows=tuple(_row(trial, experiment) for trial in end.trials),
        converged=end.stop.outcome == "converged",
        outcome=end.stop.outcome,
        stopped_because=end.stop.because,
        what_to_do=end.stop.what_to_do,
        pictures=("tracking.png", "sliding.png"),
    )


def _inputs(path: Path, end: CampaignEnd) -> tuple[InputRef, ...]:
    inputs = [outside_input(EXPERIMENT, path)]
    for trial in end.trials:
        inputs += [trial.plan_run.input(PLAN), trial.trial_run.input(TRIAL), trial.estimate_run.input(ESTIMATE)]
    return tuple(inputs)


def _row(trial: PastTrial, experiment: Experiment) -> CampaignRow:
    told, planned = trial.estimate, trial.plan
    truth, why = _truth(trial.trial_run), _why(trial.plan_run)
    reached = told.final_relative_pose
    before = miss(told.initial_relative_pose or planned.start_relative_pose, experiment)
    left = miss(reached, experiment) if reached else None
    really = miss(truth.final_relative_pose, experiment) if truth else None
    return CampaignRow(
        trial=planned.trial,
        runs=CampaignRuns(plan=trial.plan_run.id, execute=trial.trial_run.id, estimate=trial.estimate_run.id),
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
        expected_error_m=why.expected_after.position_m if why else None,
        expected_interval_95_m=why.expected_after.position_interval_95_m if why else None,
        worse=left is None or left.in_tolerances(experiment) > before.in_tolerances(experiment),
    )


def _truth(trial_run: Run) -> TruthDocument | None:
    """What was true, where the lab was simulated."""
    if all(one.role != TRUTH for one in trial_run.manifest.outputs):
        return None
    return parse(TruthDocument, load(trial_run.file(TRUTH)))


def _why(plan_run: Run) -> WhyDocument | None:
    """Why a plan is as it is, where it followed a trial."""
    if all(one.role != WHY for one in plan_run.manifest.outputs):
        return None
    return parse(WhyDocument, load(plan_run.file(WHY)))


def _write(draft: Draft, document: CampaignDocument, experiment: Experiment, end: CampaignEnd) -> None:
    draft.add(CAMPAIGN, "campaign.yaml").write_text(dump_model(document), encoding="utf-8")
    runs = [TrialRuns(one.plan_run, one.trial_run, one.estimate_run) for one in end.trials]
    shown = [runs[0], runs[-1]][: len(runs)]
    draw_pictures(shown, experiment, draft.add(TRACKING, "tracking.png"), draft.add(SLIDING, "sliding.png"))
    draft.report("trials", len(document.rows), unit="1")
    last = document.rows[-1]
    if last.error_m is not None and last.error_rad is not None:
        draft.report("error", last.error_m, unit="m")
        draft.report("turn_error", last.error_rad, unit="rad")
