"""Iterate: the next plan from the last estimate, in the manner of Theorem 1."""

from dataclasses import dataclass

import numpy as np

from slidepipe.artifacts.estimate import EstimateDocument
from slidepipe.artifacts.experiment import Experiment, load_experiment
from slidepipe.artifacts.plan import Belief, PlanDocument
from slidepipe.artifacts.run import Run
from slidepipe.artifacts.schema import parse
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.strict_yaml import load
from slidepipe.artifacts.values import Pose, UncertainPose
from slidepipe.errors import RefusedError
from slidepipe.planning.replan import replan
from slidepipe.stages.estimate import ESTIMATE
from slidepipe.stages.plan_files import EXPERIMENT, PLAN, Occasion, write_plan
from slidepipe.stages.translate import first_regrasp, setup, vector

STAGE, STAGE_VERSION = "iterate", 1
Z95 = 1.96


@dataclass(frozen=True, slots=True)
class IterateRequest:
    """Which estimate to go on from; ``friction`` (``estimate`` or ``keep``) stands over the experiment's choice."""

    estimate: str
    store: Store
    friction: str | None = None
    force: bool = False
    command: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class IterateResult:
    """The next plan's run and document; both are None where the goal is reached."""

    run: Run | None
    document: PlanDocument | None
    reused: bool


@dataclass(frozen=True, slots=True)
class Miss:
    """Distance and angle from the goal's relative pose."""

    position_m: float
    angle_rad: float


@dataclass(frozen=True, slots=True)
class _Past:
    """The chain that an estimate stands in."""

    estimate: EstimateDocument
    estimate_run: Run
    plan: PlanDocument
    plan_run: Run
    experiment: Experiment


def run(request: IterateRequest) -> IterateResult:
    """Plan the next trial, if there is anything left to do.

    Raises
    ------
    RefusedError
        The object was lost: it has to be put back by hand.
    InfeasibleError
        The remaining error cannot be corrected within the limits.
    """
    past = _past(request)
    reached = past.estimate.final_relative_pose
    if reached is None:
        raise RefusedError(
            f"iterate: the object was lost ({past.estimate.lost}): "
            "put it back into the grip and plan the experiment anew"
        )
    if within_tolerance(reached, past.experiment):
        return IterateResult(None, None, reused=False)
    belief = _believe(past, request.friction or past.experiment.iteration.friction)
    draft = request.store.draft(
        stage=STAGE,
        stage_version=STAGE_VERSION,
        experiment=past.experiment.name,
        parameters=past.experiment.model_dump(mode="json") | {"friction_from": belief.source},
        inputs=(past.estimate_run.input(ESTIMATE), past.plan_run.input(PLAN), past.plan_run.input(EXPERIMENT)),
        command=request.command,
    )
    known = None if request.force else request.store.find_recipe(draft.recipe)
    if known is not None:
        return IterateResult(known, parse(PlanDocument, load(known.file(PLAN))), reused=True)
    with draft:
        chosen = replan(
            first_regrasp(past.experiment), np.array(reached.vector), setup(past.experiment, belief.friction)
        )
        occasion = Occasion(
            trial=past.plan.trial + 1,
            reason=_reason(miss(reached, past.experiment), belief),
            previous_estimate=past.estimate_run.id,
            friction=belief.friction,
            friction_std=belief.std,
        )
        document = write_plan(draft, chosen, past.experiment, occasion)
    return IterateResult(draft.run, document, reused=False)


def miss(reached: UncertainPose | Pose, experiment: Experiment) -> Miss:
    """How far a relative pose is from the experiment's goal."""
    error = np.array(reached.vector) - vector(experiment.goal.relative_pose)
    turn = (error[2] + np.pi) % (2 * np.pi) - np.pi
    return Miss(float(np.hypot(error[0], error[1])), float(abs(turn)))


def within_tolerance(reached: UncertainPose | Pose, experiment: Experiment) -> bool:
    """Whether the goal is reached."""
    left, tolerance = miss(reached, experiment), experiment.goal.tolerance
    return left.position_m <= tolerance.position_m and left.angle_rad <= tolerance.angle_rad


@dataclass(frozen=True, slots=True)
class _Belief:
    friction: float
    std: float | None
    source: str


def _past(request: IterateRequest) -> _Past:
    store = request.store
    estimate_run = store.get(request.estimate)
    estimate = parse(EstimateDocument, load(estimate_run.file(ESTIMATE)))
    trial_run = store.get(estimate.trial)
    plan_run = store.get(next(one.run for one in trial_run.manifest.inputs if one.role == PLAN and one.run))
    return _Past(
        estimate=estimate,
        estimate_run=estimate_run,
        plan=parse(PlanDocument, load(plan_run.file(PLAN))),
        plan_run=plan_run,
        experiment=load_experiment(plan_run.file(EXPERIMENT)),
    )


def _believe(past: _Past, choice: str) -> _Belief:
    """Take the more certain of the new estimate and the old belief.

    A block that did not slide tells a lower bound, which stands over a belief that nobody has measured.
    """
    old = past.plan.believed
    kept = _Belief(old.friction, old.friction_std, "the belief before")
    if choice == "keep":
        return kept
    if past.estimate.slide is None and old.friction_std is None:
        return _Belief(_least_friction(past.plan, old), None, "the block's not sliding: at least this")
    told = past.estimate.friction
    if told is None:
        return kept
    std = (told.mu.interval_95[1] - told.mu.interval_95[0]) / (2 * Z95)
    if old.friction_std is not None and old.friction_std < std:
        return kept
    return _Belief(told.mu.value, std, "the estimate")


def _least_friction(plan: PlanDocument, old: Belief) -> float:
    """Friction at which the planned slide would just not have begun: the relative acceleration comes on top."""
    ddr = plan.slide.relative_acceleration
    return old.friction * (1.0 + float(np.hypot(ddr[0], ddr[1])) / old.kappa_m_s2)


def _reason(left: Miss, belief: _Belief) -> str:
    return (
        f"{1e3 * left.position_m:.2f} mm and {1e3 * left.angle_rad:.1f} mrad were left to slide; "
        f"friction {belief.friction:.4f} from {belief.source}"
    )
