"""The trials that a report is about: found in the store, from a run or from an experiment's name."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from slidepipe.artifacts.estimate import EstimateDocument
from slidepipe.artifacts.experiment import Experiment
from slidepipe.artifacts.plan import PlanDocument
from slidepipe.artifacts.run import Run
from slidepipe.artifacts.schema import AnyArtifact, parse
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.strict_yaml import load
from slidepipe.artifacts.trial import TrialDocument, TruthDocument
from slidepipe.artifacts.wording import instead
from slidepipe.errors import NotFoundError
from slidepipe.stages import estimate, execute
from slidepipe.stages.plan_files import EXPERIMENT, PLAN
from slidepipe.stages.trial_facts import RECORDING, TRIAL
from slidepipe.stages.trial_files import TRUTH


@dataclass(frozen=True, slots=True)
class ReportTrial:
    """One trial: its runs and documents; no estimate where nobody made one, no truth where nobody knows it.

    Attributes
    ----------
    chain : str
        The plan that began the trials of which this is one.
    """

    plan_run: Run
    plan: PlanDocument
    trial_run: Run
    trial: TrialDocument
    estimate_run: Run | None
    estimate: EstimateDocument | None
    truth: TruthDocument | None
    experiment: Experiment
    chain: str

    @property
    def name(self) -> str:
        """Its number in its chain, and its run."""
        return f"{self.plan.trial} ({self.trial_run.id})"

    @property
    def runs(self) -> tuple[Run, ...]:
        """Its runs in the order in which they were made."""
        return tuple(run for run in (self.plan_run, self.trial_run, self.estimate_run) if run is not None)


@dataclass(frozen=True, slots=True)
class Subject:
    """What a report is about: trials, the oldest first, other runs that belong to them, and damaged ones."""

    name: str
    trials: tuple[ReportTrial, ...]
    others: tuple[Run, ...]
    faults: tuple[str, ...]


def find_subject(store: Store, reference: str) -> Subject:
    """Find the trials of an experiment, or those that a run belongs to.

    Parameters
    ----------
    store : Store
    reference : str
        Name of an experiment in the store, or a run: a campaign with all its trials, a plan with all that executed
        it, one trial or its estimate.

    Raises
    ------
    NotFoundError
        There is neither, or no trial belongs to it.
    """
    survey = store.survey()
    named = [run for run in survey.runs if run.manifest.experiment == reference]
    if named:
        wanted, others, name = named, [run for run in named if run.manifest.stage == "run"], reference
    else:
        chosen = _run(store, reference)
        wanted, others, name = _around(chosen, survey.runs), [chosen], f"{chosen.manifest.experiment} {chosen.id}"
    by_id = {run.id: run for run in survey.runs}
    trials = [run for run in wanted if run.manifest.stage == execute.STAGE and _has(run, RECORDING)]
    if not trials:
        raise NotFoundError(f"report {reference}: no trial belongs to it: execute its plan first")
    told = _estimates(survey.runs)
    known = {run.id for run in trials}
    failed = [run for run in wanted if not run.manifest.outputs and run.id not in known]
    read = tuple(_read(run, by_id, told) for run in trials)
    return Subject(name, read, _unique([*others, *failed]), survey.faults)


def _run(store: Store, reference: str) -> Run:
    try:
        return store.get(reference)
    except NotFoundError as error:
        names = sorted({run.manifest.experiment for run in store.survey().runs})
        raise NotFoundError(f"{error}; nor is it an experiment: {instead(reference, names)}") from None


def _unique(runs: Sequence[Run]) -> tuple[Run, ...]:
    return tuple({run.id: run for run in runs}.values())


def _around(chosen: Run, runs: Sequence[Run]) -> list[Run]:
    """Runs that went into one, and trials and estimates that came of it."""
    inside = {one.run for one in chosen.manifest.inputs}
    after = [run for run in runs if any(one.run == chosen.id for one in run.manifest.inputs)]
    return [run for run in runs if run.id in inside or run.id == chosen.id or run in after]


def _estimates(runs: Sequence[Run]) -> dict[str, Run]:
    """The latest estimate of each trial."""
    found = {}
    for run in runs:
        if run.manifest.stage == estimate.STAGE and _has(run, estimate.ESTIMATE):
            found.update({one.run: run for one in run.manifest.inputs if one.run is not None})
    return found


def _read(run: Run, by_id: Mapping[str, Run], told: Mapping[str, Run]) -> ReportTrial:
    trial = _document(TrialDocument, run, TRIAL)
    plan_run = _known(by_id, trial.plan, run)
    estimated = told.get(run.id)
    return ReportTrial(
        plan_run=plan_run,
        plan=_document(PlanDocument, plan_run, PLAN),
        trial_run=run,
        trial=trial,
        estimate_run=estimated,
        estimate=_document(EstimateDocument, estimated, estimate.ESTIMATE) if estimated else None,
        truth=_document(TruthDocument, run, TRUTH) if _has(run, TRUTH) else None,
        experiment=_document(Experiment, plan_run, EXPERIMENT),
        chain=_root(plan_run, by_id),
    )


def _root(plan_run: Run, by_id: Mapping[str, Run]) -> str:
    """Go back from a plan over the estimates and trials that led to it."""
    run = plan_run
    while True:
        before = [by_id[one.run] for one in run.manifest.inputs if one.run is not None and one.run in by_id]
        if not before:
            return run.id
        run = before[0]


def _known(by_id: Mapping[str, Run], run_id: str, wanted_by: Run) -> Run:
    if run_id not in by_id:
        raise NotFoundError(f"report: run {wanted_by.id} needs run {run_id}, which is not in the store")
    return by_id[run_id]


def _document(kind: type[AnyArtifact], run: Run, role: str) -> AnyArtifact:
    return parse(kind, load(run.file(role)))


def _has(run: Run, role: str) -> bool:
    return any(output.role == role for output in run.manifest.outputs)
