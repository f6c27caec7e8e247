"""Iterate: the next plan from the trials so far, in the manner of Theorem 1."""

from dataclasses import dataclass

import numpy as np

from slidepipe.arm.identify import ArmCorrection
from slidepipe.artifacts.draft import Draft
from slidepipe.artifacts.experiment import Experiment, load_experiment
from slidepipe.artifacts.iteration_setup import Way
from slidepipe.artifacts.plan import PlanDocument
from slidepipe.artifacts.run import Run
from slidepipe.artifacts.schema import dump_model, parse
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.strict_yaml import load
from slidepipe.artifacts.values import UncertainPose
from slidepipe.artifacts.why import WhyDocument
from slidepipe.errors import RefusedError
from slidepipe.planning.planner import Plan
from slidepipe.planning.replan import FrictionInterval
from slidepipe.series import FloatArray
from slidepipe.stages.belief import FrictionBelief, believe
from slidepipe.stages.estimate import ESTIMATE
from slidepipe.stages.explain import explain, reason_of
from slidepipe.stages.goal import miss, within_tolerance
from slidepipe.stages.learn import corrected_plan, correction_document, learn
from slidepipe.stages.motions import next_plan
from slidepipe.stages.past import PastTrial, past_trials
from slidepipe.stages.plan_files import EXPERIMENT, PLAN, Occasion, write_plan
from slidepipe.stages.translate import vector
from slidepipe.stages.trial_facts import RECORDING

STAGE, STAGE_VERSION = "iterate", 3
WHY, ARM = "why", "arm"
"""Roles of the files beside the plan's."""
DIGITS = 9
"""Decimals of what a plan is made from: a nanometre, and far below what is known."""


@dataclass(frozen=True, slots=True)
class IterateRequest:
    """Which estimate to go on from; ``way`` stands over the experiment's choice.

    ``put_back`` says that an object which was lost is in the grip again, where the experiment starts.
    """

    estimate: str
    store: Store
    way: Way | None = None
    put_back: bool = False
    force: bool = False
    command: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class IterateResult:
    """The next plan's run and document, and why it is as it is; all are None where the goal is reached."""

    run: Run | None
    document: PlanDocument | None
    why: WhyDocument | None
    reused: bool


def run(request: IterateRequest) -> IterateResult:
    """Plan the next trial, if there is anything left to do.

    Raises
    ------
    RefusedError
        The object was lost: it has to be put back by hand.
    InfeasibleError
        The remaining error cannot be corrected within the limits.
    """
    past = past_trials(request.store, request.estimate)
    last = past[-1]
    experiment = load_experiment(last.plan_run.file(EXPERIMENT))
    reached = last.estimate.final_relative_pose
    if reached is None and not request.put_back:
        raise RefusedError(
            f"iterate: the object was lost ({last.estimate.lost}): put it back into the grip at start.relative_pose, "
            "then go on with slidepipe run EXPERIMENT --resume, or slidepipe iterate ESTIMATE --put-back"
        )
    if reached is not None and within_tolerance(reached, experiment):
        return IterateResult(None, None, None, reused=False)
    way = request.way or experiment.iteration.way
    draft = _draft(request, past, experiment, way)
    known = None if request.force else request.store.find_recipe(draft.recipe)
    if known is not None:
        return _known(known)
    with draft:
        belief = believe(past, way, experiment)
        correction = learn(past, experiment) if way == "learned" else None
        chosen = _choose(belief, _from_where(reached, experiment), experiment, correction)
        why = explain(chosen, belief, past, experiment, way=way, correction=correction)
        occasion = Occasion(
            trial=last.plan.trial + 1,
            reason=reason_of(None if reached is None else miss(reached, experiment), belief),
            previous_estimate=last.estimate_run.id,
            friction=belief.friction,
            friction_std=belief.std,
        )
        document = write_plan(draft, chosen, experiment, occasion)
        draft.add(WHY, "why.yaml").write_text(dump_model(why), encoding="utf-8")
        if correction is not None:
            told = correction_document(correction, past, experiment)
            draft.add(ARM, "arm.yaml").write_text(dump_model(told), encoding="utf-8")
    return IterateResult(draft.run, document, why, reused=False)


def _draft(request: IterateRequest, past: tuple[PastTrial, ...], experiment: Experiment, way: Way) -> Draft:
    """Everything that the next plan depends on: the recordings too where the arm is learned from them."""
    inputs = [past[-1].estimate_run.whole_input(ESTIMATE), past[-1].plan_run.whole_input(PLAN)]
    inputs += [past[-1].plan_run.whole_input(EXPERIMENT)]
    inputs += [one.estimate_run.whole_input(ESTIMATE) for one in past[:-1]]
    if way == "learned":
        inputs += [one.trial_run.input(RECORDING) for one in past]
    return request.store.draft(
        stage=STAGE,
        stage_version=STAGE_VERSION,
        experiment=experiment.name,
        parameters=experiment.model_dump(mode="json") | {"way": way, "put_back": request.put_back},
        inputs=tuple(inputs),
        command=request.command,
    )


def _known(run: Run) -> IterateResult:
    plan, why = (load(run.file(role)) for role in (PLAN, WHY))
    return IterateResult(run, parse(PlanDocument, plan), parse(WhyDocument, why), reused=True)


def _from_where(reached: UncertainPose | None, experiment: Experiment) -> FloatArray:
    """Relative pose that the next trial starts from: where it was seen, or where it was put back."""
    return vector(experiment.start.relative_pose) if reached is None else np.array(reached.vector)


def _choose(
    belief: FrictionBelief, r_now: FloatArray, experiment: Experiment, correction: ArmCorrection | None
) -> Plan:
    """Plan for what is believed, to so many digits that a result's rounding cannot tip the search over."""
    friction, r_now = round(belief.friction, DIGITS), np.round(r_now, DIGITS)
    interval = None if belief.interval is None else FrictionInterval(*np.round(belief.interval, DIGITS))
    if correction is None:
        return next_plan(experiment, r_now, friction, interval)
    return corrected_plan(lambda easier: next_plan(easier, r_now, friction, interval), correction, experiment)
