"""What the next trial is expected to leave, by simulating it in the worlds that are still possible."""

from dataclasses import dataclass

import numpy as np

from slidepipe.artifacts.estimate import EstimateDocument
from slidepipe.artifacts.experiment import Experiment
from slidepipe.artifacts.values import Interval, UncertainPose
from slidepipe.artifacts.why import ExpectedError
from slidepipe.planning.planner import Plan
from slidepipe.planning.predict import SampledHand, predict
from slidepipe.planning.replan import slide_distance
from slidepipe.series import FloatArray
from slidepipe.stages.belief import FrictionBelief, replay
from slidepipe.stages.past import PastTrial
from slidepipe.stages.translate import block, vector

DRAWS = 400
Z95 = 1.96
UNKNOWN_SHARE = 0.1
"""Spread of a friction that nobody measured."""
FIRST_MISS = 0.02
"""By which share of the slide the model is wrong, before a trial has told."""


def expect(plan: Plan, belief: FrictionBelief, past: tuple[PastTrial, ...], experiment: Experiment) -> ExpectedError:
    """Simulate the next trial in worlds drawn from what is believed; the same draws every time."""
    random = np.random.default_rng([experiment.lab.seed, len(past) + 1])
    miss = model_miss(past, belief, experiment)
    kappa = _kappa(belief, experiment, random)
    start = plan.course.r_start + random.standard_normal((DRAWS, 3)) * _start_std(past[-1].estimate)
    hand = SampledHand(plan.motion.time_s, plan.motion.q_f, plan.course.boundaries)
    told = predict(hand, block(experiment), experiment.rho_m, kappa=kappa, r_start=start)
    reach = slide_distance(plan.course.r_start, plan.course.r_goal, experiment.rho_m)
    wrong = random.standard_normal((DRAWS, 3)) * miss * reach / np.array([1.0, 1.0, experiment.rho_m])
    error = told.r_f_b - vector(experiment.goal.relative_pose) + wrong
    position, angle = np.hypot(error[:, 0], error[:, 1]), np.abs(error[:, 2])
    tolerance = experiment.goal.tolerance
    within = (position <= tolerance.position_m) & (angle <= tolerance.angle_rad) & ~told.lost
    return ExpectedError(
        position_m=float(np.median(position)),
        position_interval_95_m=_interval(position),
        angle_rad=float(np.median(angle)),
        angle_interval_95_rad=_interval(angle),
        lost_share=float(np.mean(told.lost)),
        within_tolerance_share=float(np.mean(within)),
        model_miss_share=miss,
        draws=DRAWS,
    )


@dataclass(frozen=True, slots=True)
class _Ends:
    start: FloatArray
    stop: FloatArray


def model_miss(past: tuple[PastTrial, ...], belief: FrictionBelief, experiment: Experiment) -> float:
    """By which share of its slide the model, with what is believed now, is wrong about a usual trial of the past."""
    kappa = np.array([belief.friction * experiment.kappa_m_s2 / experiment.friction])
    shares = []
    for one in past:
        ends = _ends(one)
        if ends is None:
            continue
        end = replay(one, experiment, kappa, ends.start[None]).r_f_b[0]
        slid = slide_distance(ends.start, ends.stop, experiment.rho_m)
        reach = slide_distance(ends.start, vector(one.plan.goal_relative_pose), experiment.rho_m)
        shares.append(slide_distance(end, ends.stop, experiment.rho_m) / max(slid, reach))
    return float(np.sqrt(np.mean(np.square([*shares, FIRST_MISS])) / 2.0))


def _ends(one: PastTrial) -> _Ends | None:
    """Where the finger was seen before and after a trial, both angles in the turn of the plan's."""
    final = one.estimate.final_relative_pose
    if final is None:
        return None
    first = one.estimate.initial_relative_pose or one.plan.start_relative_pose
    planned = vector(one.plan.goal_relative_pose)
    return _Ends(_near(np.array(first.vector), planned), _near(np.array(final.vector), planned))


def _near(pose: FloatArray, reference: FloatArray) -> FloatArray:
    turns = np.round((reference[2] - pose[2]) / (2.0 * np.pi))
    return np.asarray(pose + np.array([0.0, 0.0, 2.0 * np.pi * turns]))


def _kappa(belief: FrictionBelief, experiment: Experiment, random: np.random.Generator) -> FloatArray:
    """Frictions (N,) as accelerations, log-normal about the belief."""
    if belief.interval is not None:
        spread = float(np.log(belief.interval[1] / belief.interval[0])) / (2.0 * Z95)
    else:
        spread = belief.std / belief.friction if belief.std is not None else UNKNOWN_SHARE
    centre = belief.friction * experiment.kappa_m_s2 / experiment.friction
    return np.asarray(centre * np.exp(spread * random.standard_normal(DRAWS)))


def _start_std(estimate: EstimateDocument) -> FloatArray:
    seen = estimate.final_relative_pose
    return np.array(seen.std) if isinstance(seen, UncertainPose) else np.zeros(3)


def _interval(values: FloatArray) -> Interval:
    low, high = np.quantile(values, [0.025, 0.975])
    return float(low), float(high)
