"""The chain of trials that an estimate stands in."""

from dataclasses import dataclass

from slidepipe.artifacts.estimate import EstimateDocument
from slidepipe.artifacts.plan import PlanDocument
from slidepipe.artifacts.run import Run
from slidepipe.artifacts.schema import parse
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.strict_yaml import load
from slidepipe.stages.estimate import ESTIMATE
from slidepipe.stages.plan_files import PLAN


@dataclass(frozen=True, slots=True)
class PastTrial:
    """One trial that was planned, executed and estimated."""

    plan: PlanDocument
    plan_run: Run
    trial_run: Run
    estimate: EstimateDocument
    estimate_run: Run


def past_trials(store: Store, estimate: str) -> tuple[PastTrial, ...]:
    """Trials of a campaign up to the one that an estimate is of, the first one first.

    Raises
    ------
    NotFoundError
        A run of the chain is not in the store.
    """
    trials: list[PastTrial] = []
    reference: str | None = estimate
    while reference is not None:
        trials.append(_trial(store, store.get(reference)))
        reference = trials[-1].plan.previous_estimate
    return tuple(reversed(trials))


def planned_by(store: Store, trial_run: Run) -> Run:
    """Run of the plan that a trial executed."""
    return store.get(next(one.run for one in trial_run.manifest.inputs if one.role == PLAN and one.run))


def _trial(store: Store, estimate_run: Run) -> PastTrial:
    document = parse(EstimateDocument, load(estimate_run.file(ESTIMATE)))
    trial_run = store.get(document.trial)
    plan_run = planned_by(store, trial_run)
    return PastTrial(
        plan=parse(PlanDocument, load(plan_run.file(PLAN))),
        plan_run=plan_run,
        trial_run=trial_run,
        estimate=document,
        estimate_run=estimate_run,
    )
