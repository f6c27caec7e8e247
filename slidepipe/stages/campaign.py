"""Run: plan, execute, estimate and iterate until the goal is reached, or until there is a reason to stop."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from slidepipe.artifacts.campaign import CampaignDocument
from slidepipe.artifacts.experiment import Experiment, load_experiment
from slidepipe.artifacts.iteration_setup import Way
from slidepipe.artifacts.manifest import RunState
from slidepipe.artifacts.run import Run
from slidepipe.artifacts.store import Store
from slidepipe.errors import LabError, RefusedError
from slidepipe.stages import campaign_files, estimate, execute, iterate, plan
from slidepipe.stages.campaign_files import CAMPAIGN, SLIDING, TRACKING, CampaignEnd, CampaignResult
from slidepipe.stages.on_lab import RealLab
from slidepipe.stages.past import past_trials
from slidepipe.stages.resume import Tip, find_tip, finished_campaign, resumable
from slidepipe.stages.stopping import Stop, no_plan, stop_after

__all__ = ["CAMPAIGN", "SLIDING", "TRACKING", "CampaignRequest", "CampaignResult", "run"]


@dataclass(frozen=True, slots=True)
class CampaignRequest:
    """Which experiment to run; ``trials`` and ``way`` stand over its own; ``report`` is told of every stage.

    With ``resume`` the experiment's last campaign goes on where it ended or was interrupted. ``lab`` is a lab over the
    network; the simulated one in virtual time unless given.
    """

    experiment: Path
    store: Store
    report: Callable[[str], None]
    overrides: tuple[str, ...] = ()
    trials: int | None = None
    way: Way | None = None
    resume: bool = False
    command: tuple[str, ...] = ()
    lab: RealLab | None = None


def run(request: CampaignRequest) -> CampaignResult:
    """Run the whole loop; every stage is a run of its own, and the table and the pictures are one more.

    Raises
    ------
    InputError
        The experiment file, or the lab's, is wrong.
    NotFoundError
        There is no such file.
    InfeasibleError
        The first motion breaks a limit. A later one that does ends the campaign, which says so.
    """
    experiment = load_experiment(request.experiment, request.overrides)
    if request.lab is not None:
        request.lab.document()  # what is wrong with it is told before anything is planned for it
    first = plan.run(plan.PlanRequest(request.experiment, request.store, request.overrides, command=request.command))
    tip = _begin(request, first.run)
    if tip.estimate_run is not None:
        done = finished_campaign(request.store, tip.estimate_run.id)
        if done is not None and done.document.converged:
            request.report(f"nothing to resume: campaign {done.run.id} has converged")
            return done
    with resumable(lambda: find_tip(request.store, first.run) is not None):
        end = _loop(request, experiment, tip)
    return campaign_files.publish(request.store, request.experiment, experiment, end, request.command)


def play(request: CampaignRequest, tip: Tip | None = None) -> CampaignDocument:
    """Run the whole loop as :func:`run` does, and publish neither the table nor the pictures.

    With ``tip`` it goes on from a trial that was executed before, of the same experiment.
    """
    experiment = load_experiment(request.experiment, request.overrides)
    if tip is None:
        asked = plan.PlanRequest(request.experiment, request.store, request.overrides, command=request.command)
        tip = _begin(request, plan.run(asked).run)
    return campaign_files.campaign_document(experiment, _loop(request, experiment, tip))


def _begin(request: CampaignRequest, first: Run) -> Tip:
    """Where to start: at the first plan, or where the last campaign of this plan was left."""
    if request.resume:
        tip = find_tip(request.store, first)
        if tip is not None:
            request.report(f"trial {tip.number}: resumed, executed {tip.trial_run.id if tip.trial_run else ''} before")
            return tip
        request.report("nothing to resume: no trial of this plan was executed yet")
    request.report(f"trial 1: planned {first.id}")
    return Tip(1, first, None, None)


def _loop(request: CampaignRequest, experiment: Experiment, tip: Tip) -> CampaignEnd:
    limit = request.trials or experiment.iteration.max_trials
    resumed = request.resume and tip.trial_run is not None
    while True:
        told = _told(request, tip)
        past = past_trials(request.store, told.id)
        stop = stop_after([one.estimate for one in past], experiment, limit)
        if stop is not None and not (resumed and _may_go_on(stop, len(past), limit)):
            return CampaignEnd(past, stop)
        resumed = False
        lost = past[-1].estimate.final_relative_pose is None
        try:
            planned = iterate.run(
                iterate.IterateRequest(told.id, request.store, request.way, put_back=lost, command=request.command)
            )
        except RefusedError as refusal:
            return CampaignEnd(past, no_plan("; ".join(refusal.lines)))
        if planned.run is None or planned.document is None:
            raise RefusedError("run: there is nothing left to plan")
        tip = Tip(len(past) + 1, planned.run, None, None)
        request.report(f"trial {tip.number}: planned {planned.run.id}: {planned.document.reason}")


def _told(request: CampaignRequest, tip: Tip) -> Run:
    """Estimate of the tip's trial: executed and estimated now, as far as that was not done before."""
    if tip.estimate_run is not None:
        return tip.estimate_run
    trial = tip.trial_run
    if trial is None:
        asked = execute.ExecuteRequest(tip.plan_run.id, request.store, command=request.command, lab=request.lab)
        done = execute.run(asked)
        request.report(f"trial {tip.number}: executed {done.run.id}: {done.document.outcome}")
        refuse_unfinished(done)
        trial = done.run
    told = estimate.run(estimate.EstimateRequest(trial.id, request.store, command=request.command))
    request.report(f"trial {tip.number}: estimated {told.run.id}")
    return told.run


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


def _may_go_on(stop: Stop, trials: int, limit: int) -> bool:
    """Whether a person who resumes has taken away the reason to stop: an object put back, or patience."""
    return stop.outcome in {"lost", "no progress"} and trials < limit
