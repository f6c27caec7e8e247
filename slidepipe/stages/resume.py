"""Where a campaign was left: the chain of runs in the store tells, and nothing else is kept."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from slidepipe.artifacts.campaign import CampaignDocument
from slidepipe.artifacts.manifest import RunState
from slidepipe.artifacts.plan import PlanDocument
from slidepipe.artifacts.run import Run
from slidepipe.artifacts.schema import parse
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.strict_yaml import load
from slidepipe.stages import estimate, execute
from slidepipe.stages.campaign_files import CAMPAIGN, STAGE, CampaignResult
from slidepipe.stages.past import past_trials, planned_by
from slidepipe.stages.plan_files import PLAN

ENDED = (RunState.COMPLETE, RunState.LOST)


KEPT = "what is done is kept, and the same command with --resume goes on from there"


@contextmanager
def resumable(anything_done: Callable[[], bool]) -> Iterator[None]:
    """Let Ctrl-C say, where anything is done, that it is not lost."""
    try:
        yield
    except KeyboardInterrupt:
        if anything_done():
            raise KeyboardInterrupt(KEPT) from None
        raise


@dataclass(frozen=True, slots=True)
class Tip:
    """Trial that a campaign stands at: planned, perhaps executed, perhaps estimated."""

    number: int
    plan_run: Run
    trial_run: Run | None
    estimate_run: Run | None


def find_tip(store: Store, first: Run) -> Tip | None:
    """Last executed trial of the campaigns that began with a plan; None where none was executed.

    What was planned or estimated after it is found again by its recipe.
    """
    runs = store.runs()
    for trial in reversed(runs):
        if not _counts(trial):
            continue
        plan_run = planned_by(store, trial)
        document = parse(PlanDocument, load(plan_run.file(PLAN)))
        if _root(store, plan_run, document).id == first.id:
            return Tip(document.trial, plan_run, trial, _estimate_of(runs, trial))
    return None


def finished_campaign(store: Store, estimate_run: str) -> CampaignResult | None:
    """Last campaign that was published with this estimate as its last."""
    for run in reversed(store.runs(stage=STAGE)):
        if any(one.role == CAMPAIGN for one in run.manifest.outputs):
            document = parse(CampaignDocument, load(run.file(CAMPAIGN)))
            if document.rows and document.rows[-1].runs.estimate == estimate_run:
                return CampaignResult(run, document)
    return None


def _counts(run: Run) -> bool:
    """Whether it is a trial that ran to its end, and no repetition."""
    told = run.manifest
    return told.stage == execute.STAGE and told.state in ENDED and execute.REPETITION not in told.parameters


def _root(store: Store, plan_run: Run, document: PlanDocument) -> Run:
    """First plan of the campaign that a plan belongs to."""
    if document.previous_estimate is None:
        return plan_run
    return past_trials(store, document.previous_estimate)[0].plan_run


def _estimate_of(runs: list[Run], trial: Run) -> Run | None:
    """Latest estimate of a trial that ran to its end."""
    for run in reversed(runs):
        told = run.manifest
        if told.stage == estimate.STAGE and told.state in ENDED and any(one.run == trial.id for one in told.inputs):
            return run
    return None
