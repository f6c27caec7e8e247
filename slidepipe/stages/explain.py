"""Why the next plan is as it is, in numbers and in words."""

import numpy as np

from slidepipe.arm.identify import ArmCorrection
from slidepipe.artifacts.experiment import Experiment
from slidepipe.artifacts.iteration_setup import Way
from slidepipe.artifacts.values import Pose
from slidepipe.artifacts.why import ErrorOf, FrictionView, WhyDocument
from slidepipe.planning.planner import Plan
from slidepipe.stages.belief import FrictionBelief
from slidepipe.stages.expect import expect
from slidepipe.stages.goal import Miss, error_of, miss
from slidepipe.stages.past import PastTrial

SAME = 1e-3
"""Share of the tolerance by which a plan's goal may differ from the experiment's for its rounding alone."""


def explain(
    plan: Plan,
    belief: FrictionBelief,
    past: tuple[PastTrial, ...],
    experiment: Experiment,
    *,
    way: Way,
    correction: ArmCorrection | None,
) -> WhyDocument:
    """Error before, expected after with its interval, and what was changed since the last plan."""
    last, before = past[-1], past[-1].plan.believed
    reached = last.estimate.final_relative_pose
    return WhyDocument(
        experiment=experiment.name,
        trial=last.plan.trial + 1,
        previous_estimate=last.estimate_run.id,
        way=way,
        error_before=None if reached is None else _error(last, experiment),
        friction_before=FrictionView(value=before.friction, interval_95=None, source="the last plan"),
        friction_after=FrictionView(value=belief.friction, interval_95=belief.interval, source=belief.source),
        expected_after=expect(plan, belief, past, experiment),
        changed=tuple(_changes(plan, belief, past, experiment, correction)),
    )


def reason_of(left: Miss | None, belief: FrictionBelief) -> str:
    """Plan's reason in one line."""
    what = "the object was lost and put back" if left is None else f"{_words(left)} were left to slide"
    return f"{what}; friction {belief.friction:.4f} from {belief.source}"


def _error(one: PastTrial, experiment: Experiment) -> ErrorOf:
    reached = one.estimate.final_relative_pose or one.plan.start_relative_pose
    left = miss(reached, experiment)
    return ErrorOf(pose=error_of(reached, experiment), position_m=left.position_m, angle_rad=left.angle_rad)


def _changes(
    plan: Plan,
    belief: FrictionBelief,
    past: tuple[PastTrial, ...],
    experiment: Experiment,
    correction: ArmCorrection | None,
) -> list[str]:
    last = past[-1]
    said = [_start_said(last, experiment), *_progress_said(past, experiment), *_part_said(plan, experiment)]
    before = last.plan.believed.friction
    said.append(f"friction {before:.4f} -> {belief.friction:.4f}: {belief.source}")
    if belief.interval is not None:
        low, high = belief.interval
        said.append(f"the motion is the best in the worst of the next trial's friction, [{low:.4f}, {high:.4f}]")
    slide = last.plan.slide
    said.append(f"slide of {1e3 * (slide.stop_s - slide.start_s):.0f} ms -> {1e3 * plan.course.T23:.0f} ms")
    if correction is not None:
        said.append(_arm_said(correction, len(past)))
    return said


def _start_said(last: PastTrial, experiment: Experiment) -> str:
    reached = last.estimate.final_relative_pose
    if reached is None:
        return "start: the experiment's own again, the object was put back"
    return f"start: where the last trial was seen to end, {_words(miss(reached, experiment))} from the goal"


def _progress_said(past: tuple[PastTrial, ...], experiment: Experiment) -> list[str]:
    """Say so where the last trial left more than there was before it."""
    last = past[-1].estimate.final_relative_pose
    if last is None:
        return []
    before = miss(past[-1].estimate.initial_relative_pose or past[-1].plan.start_relative_pose, experiment)
    after = miss(last, experiment)
    if after.in_tolerances(experiment) <= before.in_tolerances(experiment):
        return []
    return [f"the last trial made it worse: {_words(before)} before it, {_words(after)} after it"]


def _part_said(plan: Plan, experiment: Experiment) -> list[str]:
    """Say so where the plan does not go all the way."""
    left = miss(Pose.of(plan.course.r_goal), experiment)
    if left.in_tolerances(experiment) <= SAME:
        return []
    return [f"no motion to the goal itself was found: this one goes part of the way, {_words(left)} from the goal"]


def _arm_said(correction: ArmCorrection, trials: int) -> str:
    explained = 1.0 - float(np.sum(correction.left_rms_n_m) / np.sum(correction.torque_rms_n_m))
    heavier, drier = float(np.median(correction.moving_mass)), float(np.median(correction.coulomb))
    return (
        f"arm learned from {trials} {'trial' if trials == 1 else 'trials'}: links {100 * heavier:+.1f} % and dry "
        f"friction {100 * drier:+.0f} % in the median, which explains {100 * explained:.0f} % of the missing torque"
    )


def _words(left: Miss) -> str:
    return f"{1e3 * left.position_m:.2f} mm and {1e3 * left.angle_rad:.1f} mrad"
