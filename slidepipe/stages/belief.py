"""What is believed of the friction after some trials."""

from dataclasses import dataclass

import numpy as np

from slidepipe.artifacts.experiment import Experiment
from slidepipe.artifacts.iteration_setup import Way
from slidepipe.artifacts.recording_reader import read_recording
from slidepipe.artifacts.values import Interval
from slidepipe.estimation.pooled import pool
from slidepipe.planning.predict import Prediction, SampledHand, predict
from slidepipe.series import FloatArray
from slidepipe.stages.past import PastTrial
from slidepipe.stages.plan_files import REFERENCE, REFERENCE_HAND
from slidepipe.stages.translate import block, hand_in_plane, vector

TRIED = 60
"""Frictions that are tried to find out how little an object that was lost can have had."""

SAME_GRIP_SHARE = 0.02
"""How far the friction of trials in one grip usually lies apart, before trials tell."""


@dataclass(frozen=True, slots=True)
class FrictionBelief:
    """Coefficient of friction; ``std`` of it, and the ``interval`` in which the next trial's own value lies with 95 %.

    Both are None where nobody measured it. ``source`` says in words where it is from.
    """

    friction: float
    std: float | None
    interval: Interval | None
    source: str


def believe(past: tuple[PastTrial, ...], way: Way, experiment: Experiment) -> FrictionBelief:
    """Belief for the next plan: kept, or pooled over all trials of the campaign.

    A block that did not slide tells a lower bound, and one that was thrown an upper; either stands as long as no trial
    measured the friction.
    """
    first, last = past[0].plan.believed, past[-1]
    if way == "goal":
        return FrictionBelief(first.friction, first.friction_std, None, "the first plan: the goal alone is updated")
    told = [one.estimate.friction.kappa_m_s2 for one in past if one.estimate.friction is not None]
    if told:
        share = experiment.object.mass_kg / experiment.grasp.normal_force_n
        values, stds = np.array([one.value for one in told]), np.array([one.std for one in told])
        pooled = pool(values, stds, between_scale=SAME_GRIP_SHARE)
        low, high = pooled.predictive_interval_95
        trials = "1 trial" if len(told) == 1 else f"{len(told)} trials pooled"
        return FrictionBelief(share * pooled.mean, share * pooled.std, (share * low, share * high), trials)
    before = last.plan.believed.friction
    if last.estimate.lost is not None:
        most = most_friction(last, experiment)
        return FrictionBelief(most, None, None, "the object's being lost: at most this")
    if last.estimate.slide is None:
        return FrictionBelief(_least_friction(last), None, None, "the object's not sliding: at least this")
    return FrictionBelief(before, last.plan.believed.friction_std, None, "the belief before: no trial measured it")


def replay(one: PastTrial, experiment: Experiment, kappa: FloatArray, r_start: FloatArray) -> Prediction:
    """What a trial's reference does to objects with these frictions, (N,) in m/s^2, that start at (N, 3)."""
    hand = read_recording(one.plan_run.file(REFERENCE)).poses(REFERENCE_HAND)
    time_s = 1e-9 * (hand.stamp_ns - hand.stamp_ns[0])
    poses = hand_in_plane(hand, experiment)
    slide, end = one.plan.slide, one.plan.phases[-1].stop_s
    boundaries_s = np.array([0.0, slide.start_s, slide.switch_s, slide.stop_s, end])
    sampled = SampledHand(time_s, poses, boundaries_s)
    return predict(sampled, block(experiment), experiment.rho_m, kappa=kappa, r_start=r_start)


def most_friction(one: PastTrial, experiment: Experiment) -> float:
    """Largest friction below the believed one with which the trial's plan loses the object, by simulation."""
    believed = one.plan.believed
    shares = np.linspace(1.0, 0.2, TRIED)
    start = np.tile(vector(one.plan.start_relative_pose), (TRIED, 1))
    lost = replay(one, experiment, shares * believed.kappa_m_s2, start).lost
    share = float(shares[np.argmax(lost)]) if np.any(lost) else 0.8
    return share * believed.friction


def _least_friction(one: PastTrial) -> float:
    """Friction at which the planned slide would just not have begun: the relative acceleration comes on top."""
    believed, ddr = one.plan.believed, one.plan.slide.relative_acceleration
    return believed.friction * (1.0 + float(np.hypot(ddr[0], ddr[1])) / believed.kappa_m_s2)
