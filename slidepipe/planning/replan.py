"""The next plan from what the last trial left, in the manner of Theorem 1.

The remaining error becomes the new goal. Equation (4) keeps the accelerations and shortens every phase with the square
root of the distance, and so does this: a smaller correction is then as strong against wrong friction as the first
motion was. The two sticking phases are made equally long, which halves the speed that the slide asks of them, and are
lengthened until the grip holds with a margin; where the arm cannot follow so short a slide, the slide is lengthened.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from slidepipe.errors import InfeasibleError
from slidepipe.mechanics.planar import object_pose
from slidepipe.planning.course import Motion
from slidepipe.planning.planner import Plan, Setup, grasp_motion, plan, sticking_share
from slidepipe.planning.predict import SampledHand, predict
from slidepipe.planning.three_phase import Regrasp
from slidepipe.series import FloatArray
from slidepipe.tick import TICK_S

SHORTEST_SLIDE_S = 0.03
"""Fifteen ticks: the arm does not follow a shorter slide well."""
SLIDE_STRETCHES = (1.0, 1.25, 1.6, 2.0)
STICK_TO_SLIDE = (1.0, 1.5, 2.0, 3.0, 4.0, 6.0)
SAFE_LOAD = 0.85
"""Share of the friction that a correction may use while it sticks; if all need more, the one that needs least."""


TRIED = 9
"""Frictions of an interval under which a candidate is simulated."""


@dataclass(frozen=True, slots=True)
class FrictionInterval:
    """Where the next trial's coefficient of friction lies."""

    low: float
    high: float


def slide_distance(r_from: FloatArray, r_to: FloatArray, rho: float) -> float:
    """Length of a slide in m, where turning by one radian counts as ``rho = c a``: the limit surface's own measure.

    Examples
    --------
    >>> slide_distance(np.zeros(3), np.array([0.003, 0.004, 0.0]), 0.01)
    0.005
    """
    step = (np.asarray(r_to) - np.asarray(r_from)) * np.array([1.0, 1.0, rho])
    return float(np.linalg.norm(step))


def replan(first: Regrasp, r_now: FloatArray, setup: Setup, friction: FrictionInterval | None = None) -> Plan:
    """Plan from where the last trial ended to the goal of the first.

    Parameters
    ----------
    first : Regrasp
        The experiment's own motion, whose accelerations, goal and resting places are kept.
    r_now : (3,)
        Relative pose of the finger in {b} after the last trial.
    setup : Setup
        With the friction that is now believed.
    friction : FrictionInterval, optional
        Where the next trial's friction lies. The motion is then the one that ends nearest to the goal in the worst of
        it, by simulation; else the first that sticks with a margin.

    Raises
    ------
    InfeasibleError
        If no choice of the phases' lengths keeps every limit: the limits that the gentlest one breaks.
    """
    refusals = []
    for task in _ranked(first, r_now, setup, friction):
        try:
            return plan(task, setup)
        except InfeasibleError as refusal:
            refusals.append(refusal)
    raise min(refusals, key=lambda refusal: len(refusal.lines))


def _ranked(first: Regrasp, r_now: FloatArray, setup: Setup, friction: FrictionInterval | None) -> Iterator[Regrasp]:
    """Candidates, the best first; those that begin where the hand rests after a trial are the last resort."""
    for q_o_start in (first.q_o_start, object_pose(first.q_f_end, np.asarray(r_now, dtype=float))):
        tasks = list(_candidates(replace(first, q_o_start=q_o_start), r_now, setup))
        motions = [grasp_motion(task, setup) for task in tasks]
        costs = [
            (
                0.0 if friction is None else _worst_miss(task, motion, setup, friction),
                max(SAFE_LOAD, sticking_share(task, motion)),
            )
            for task, motion in zip(tasks, motions, strict=True)
        ]
        for index in sorted(range(len(tasks)), key=lambda one: costs[one]):
            yield tasks[index]


def _worst_miss(task: Regrasp, motion: Motion, setup: Setup, friction: FrictionInterval) -> float:
    """Largest distance from the goal, m, over the interval; what is lost counts as a length of the block."""
    frictions = np.linspace(friction.low, friction.high, TRIED)
    finger, block = setup.finger, setup.block
    rho = finger.a * finger.c
    starts = np.tile(task.r_start, (TRIED, 1))
    kappa = frictions * finger.f_N / block.m
    hand = SampledHand(motion.time_s, motion.q_f, task.boundaries)
    told = predict(hand, block, rho, kappa=kappa, r_start=starts)
    miss = (told.r_f_b - task.r_goal) * np.array([1.0, 1.0, rho])
    return float(np.max(np.where(told.lost, block.length + block.width, np.linalg.norm(miss, axis=1))))


def _candidates(first: Regrasp, r_now: FloatArray, setup: Setup) -> Iterator[Regrasp]:
    rho = setup.finger.a * setup.finger.c
    share = slide_distance(r_now, first.r_goal, rho) / slide_distance(first.r_start, first.r_goal, rho)
    for stretch in SLIDE_STRETCHES:
        slide_s = max(SHORTEST_SLIDE_S, first.T23 * np.sqrt(share)) * stretch
        for ratio in STICK_TO_SLIDE:
            yield Regrasp(
                q_o_start=first.q_o_start,
                r_start=np.asarray(r_now, dtype=float),
                r_goal=first.r_goal,
                q_f_end=first.q_f_end,
                T1=_on_ticks(ratio * slide_s, 1),
                T23=_on_ticks(slide_s, 2),
                T4=_on_ticks(ratio * slide_s, 1),
            )


def _on_ticks(duration_s: float, multiple: int) -> float:
    step = multiple * TICK_S
    return max(1, round(duration_s / step)) * step
