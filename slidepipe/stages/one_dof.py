"""One degree of freedom: the plan of Section III, and Theorem 1 as an experiment."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from slidepipe.artifacts.draft import Draft
from slidepipe.artifacts.one_dof import (
    ConditionCheck,
    OneDofExperiment,
    OneDofOutcome,
    OneDofPlan,
    OneDofSeries,
    OneDofTrial,
    OneDofTrials,
    load_one_dof,
)
from slidepipe.artifacts.run import Run, outside_input
from slidepipe.artifacts.schema import dump_model, parse, schema_name
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.strict_yaml import load
from slidepipe.errors import InputError, NotFoundError
from slidepipe.mechanics.one_dof import Accelerations, Profile
from slidepipe.mechanics.one_dof_in_plane import simulated_slide
from slidepipe.mechanics.theorem_1 import contraction_bound, eps_limits, friction_acceleration, theorem_1

STAGE_VERSION = 1
PLAN, TRIALS, EXPERIMENT = "one_dof_plan", "one_dof_trials", "experiment"
"""Roles of the files."""
ROUNDING = 1e-9
"""By how much a measured factor may pass its bound: the simulation's error beside the tolerance of a trial."""
SIMULATION = "planar, event-driven: an object pinched by a hand in free fall (slidepipe.mechanics.simulate)"


@dataclass(frozen=True, slots=True)
class OneDofRequest:
    """Which experiment; ``report`` is told of every series of trials."""

    experiment: Path
    store: Store
    overrides: tuple[str, ...] = ()
    force: bool = False
    command: tuple[str, ...] = ()
    report: Callable[[str], None] = lambda _: None


@dataclass(frozen=True, slots=True)
class OneDofPlanResult:
    """The plan's run and document; ``reused`` where an equal plan was there already."""

    run: Run
    document: OneDofPlan
    reused: bool


@dataclass(frozen=True, slots=True)
class OneDofTrialsResult:
    """The trials' run and document, and the plan that they began with."""

    run: Run
    document: OneDofTrials
    plan: OneDofPlan


def is_one_dof(path: Path) -> bool:
    """Whether a file says that it is a one-DOF experiment; one that cannot be read is not."""
    try:
        return schema_name(load(path)) == OneDofExperiment.SCHEMA
    except (InputError, NotFoundError):
        return False


def plan(request: OneDofRequest) -> OneDofPlanResult:
    """Plan the profile of Section III-C and check Theorem 1's conditions.

    Raises
    ------
    InputError
        The experiment file is wrong: one line for each fault.
    """
    experiment = load_one_dof(request.experiment, request.overrides)
    draft = _draft("plan", request, experiment)
    known = None if request.force else request.store.find_recipe(draft.recipe)
    if known is not None:
        return OneDofPlanResult(known, parse(OneDofPlan, load(known.file(PLAN))), reused=True)
    with draft:
        document = plan_document(experiment)
        draft.add(PLAN, "one_dof_plan.yaml").write_text(dump_model(document), encoding="utf-8")
        draft.add(EXPERIMENT, "experiment.yaml").write_text(dump_model(experiment), encoding="utf-8")
        draft.report("eps_star", document.eps_star, unit="1")
    return OneDofPlanResult(draft.run, document, reused=False)


def run(request: OneDofRequest) -> OneDofTrialsResult:
    """Repeat the slide under each true friction and measure how much every trial leaves.

    Raises
    ------
    InputError
        The experiment file is wrong: one line for each fault.
    """
    experiment = load_one_dof(request.experiment, request.overrides)
    planned = plan_document(experiment)
    draft = _draft("run", request, experiment)
    with draft:
        document = _trials(experiment, planned, request.report)
        draft.add(TRIALS, "one_dof_trials.yaml").write_text(dump_model(document), encoding="utf-8")
        draft.add(PLAN, "one_dof_plan.yaml").write_text(dump_model(planned), encoding="utf-8")
        draft.add(EXPERIMENT, "experiment.yaml").write_text(dump_model(experiment), encoding="utf-8")
        inside = [series.largest_factor for series in document.series if series.inside]
        if inside:
            draft.report("largest_factor_inside", max(inside), unit="1")
        if document.contraction_bound is not None:
            draft.report("contraction_bound", document.contraction_bound, unit="1")
    return OneDofTrialsResult(draft.run, document, planned)


def plan_document(experiment: OneDofExperiment) -> OneDofPlan:
    """Plan's document: eq. (4), the finger's motion, and Theorem 1's conditions with the unsaid fourth."""
    accelerations = _accelerations(experiment)
    profile = Profile(accelerations, experiment.slide_m)
    finger, limits = profile.finger, eps_limits(accelerations)
    theorem = theorem_1(accelerations, experiment.friction_error)
    below = (limits.sticks, limits.slides, limits.stops, limits.can_stop)
    phases = zip(finger.breaks[:-1], finger.breaks[1:], 2.0 * finger.coefficients[:, 2], strict=True)
    times_s = np.linspace(0.0, profile.T, 2001)
    return OneDofPlan(
        experiment=experiment.name,
        friction=experiment.friction,
        friction_acceleration_m_s2=accelerations.a_o,
        slide_m=experiment.slide_m,
        T1_s=profile.T1,
        T2_s=profile.T2,
        T3_s=profile.T3,
        T4_s=profile.T4,
        profile=tuple((float(start), float(stop), float(ddq)) for start, stop, ddq in phases),
        peak_speed_m_s=accelerations.a * profile.T1,
        peak_travel_m=float(np.max(np.abs(finger.at(times_s)))),
        friction_error=experiment.friction_error,
        conditions=tuple(
            ConditionCheck(
                name=one.name,
                left_m_s2=one.left,
                relation=one.relation,
                right_m_s2=float(one.right),
                satisfied=one.holds,
                holds_below=limit,
            )
            for one, limit in zip(theorem.conditions, below, strict=True)
        ),
        eps_star=limits.eps_star,
        eps_star_bound_by=limits.binding,
        contraction_bound=contraction_bound(accelerations, experiment.friction_error) if theorem.holds else None,
    )


def _draft(stage: str, request: OneDofRequest, experiment: OneDofExperiment) -> Draft:
    return request.store.draft(
        stage=stage,
        stage_version=STAGE_VERSION,
        experiment=experiment.name,
        parameters=experiment.model_dump(mode="json"),
        inputs=(outside_input(EXPERIMENT, request.experiment),),
        command=request.command,
    )


def _accelerations(experiment: OneDofExperiment) -> Accelerations:
    a_o = friction_acceleration(experiment.friction, experiment.normal_force_n, experiment.mass_kg)
    return Accelerations(a_f=experiment.tearing_acceleration_m_s2, a_o=a_o, a=experiment.acceleration_m_s2)


def _trials(experiment: OneDofExperiment, planned: OneDofPlan, report: Callable[[str], None]) -> OneDofTrials:
    series = []
    for friction in experiment.true_frictions:
        series.append(_series(experiment, planned, friction))
        count = len(series[-1].trials)
        report(f"friction {friction:g}: {series[-1].outcome} after {count} {'trial' if count == 1 else 'trials'}")
    inside = [one for one in series if one.inside]
    confirmed = planned.converges and bool(inside) and all(one.within_bound for one in inside)
    return OneDofTrials(
        experiment=experiment.name,
        simulation=SIMULATION,
        friction_error=experiment.friction_error,
        eps_star=planned.eps_star,
        contraction_bound=planned.contraction_bound,
        tolerance_m=experiment.tolerance_m,
        series=tuple(series),
        confirmed=confirmed,
        verdict=_verdict(planned, inside),
    )


def _series(experiment: OneDofExperiment, planned: OneDofPlan, friction: float) -> OneDofSeries:
    """Theorem 1's iteration: what is left becomes the new goal, with the accelerations as they were."""
    accelerations, left_m = _accelerations(experiment), experiment.slide_m
    trials: list[OneDofTrial] = []
    while len(trials) < experiment.trials and abs(left_m) > experiment.tolerance_m:
        profile = Profile(accelerations, left_m)
        slid_m = simulated_slide(profile, mu=friction, f_N=experiment.normal_force_n, m=experiment.mass_kg)
        factor = abs(left_m - slid_m) / abs(left_m)
        trials.append(OneDofTrial(left_before_m=left_m, slid_m=slid_m, left_after_m=left_m - slid_m, factor=factor))
        left_m -= slid_m
        if slid_m == 0.0 or abs(left_m) > 10.0 * abs(experiment.slide_m):
            break
    error = friction / experiment.friction - 1.0
    largest, bound = max(one.factor for one in trials), planned.contraction_bound
    outcome = _outcome(trials, experiment)
    inside = abs(error) <= experiment.friction_error + ROUNDING
    return OneDofSeries(
        friction=friction,
        error=error,
        inside=inside,
        trials=tuple(trials),
        largest_factor=largest,
        within_bound=None if bound is None else largest <= bound + ROUNDING,
        outcome=outcome,
        said=_said(error, largest, outcome, planned, inside=inside),
    )


def _outcome(trials: list[OneDofTrial], experiment: OneDofExperiment) -> OneDofOutcome:
    last = trials[-1]
    if abs(last.left_after_m) <= experiment.tolerance_m:
        return "converged"
    if last.slid_m == 0.0:
        return "nothing slides"
    return "grows" if last.factor > 1.0 else "out of trials"


def _said(error: float, largest: float, outcome: str, planned: OneDofPlan, *, inside: bool) -> str:
    if inside and planned.contraction_bound is not None:
        kept = "at or under" if largest <= planned.contraction_bound + ROUNDING else "ABOVE"
        return f"inside: {outcome}, every trial {kept} the bound"
    if inside:
        return f"inside, but Theorem 1's conditions do not hold: nothing is promised; {outcome}"
    if abs(error) < planned.eps_star:
        return f"outside the allowed interval, within eps*: a wider friction_error would be promised too; {outcome}"
    return f"outside the allowed interval, beyond eps*: nothing is promised; {outcome}"


def _verdict(planned: OneDofPlan, inside: list[OneDofSeries]) -> str:
    if not planned.converges:
        broken = ", ".join(one.name for one in planned.conditions if not one.satisfied)
        return (
            f"Theorem 1 promises nothing for a friction error of {planned.friction_error:g}: its condition "
            f"'{broken}' does not hold; it would below eps* = {planned.eps_star:.4g}"
        )
    if not inside:
        return "no true friction is inside the allowed interval: nothing was put to the test"
    trials = sum(len(one.trials) for one in inside)
    above = sum(not each.within_bound for each in inside)
    if above:
        return f"NOT confirmed: under {above} of {len(inside)} frictions inside, a trial left more than the bound"
    return f"confirmed: all {trials} trials inside the interval left at most the bound's share of the distance"
