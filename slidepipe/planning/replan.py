"""The next plan from what the last trial left, in the manner of Theorem 1.

The remaining error becomes the new goal. Equation (4) keeps the accelerations and shortens every phase with the square
root of the distance, and so does this: a smaller correction is then as strong against wrong friction as the first
motion was. The two sticking phases are made equally long, which halves the speed that the slide asks of them, and are
lengthened until the grip holds with a margin; where the arm cannot follow so short a slide, the slide is lengthened.
"""

from collections.abc import Iterator

import numpy as np

from slidepipe.errors import InfeasibleError
from slidepipe.planning.planner import Plan, Setup, plan, stick_load
from slidepipe.planning.three_phase import Regrasp
from slidepipe.series import FloatArray
from slidepipe.tick import TICK_S

SHORTEST_SLIDE_S = 0.03
"""Fifteen ticks: the arm does not follow a shorter slide well."""
SLIDE_STRETCHES = (1.0, 1.25, 1.6, 2.0)
STICK_TO_SLIDE = (1.0, 1.5, 2.0, 3.0, 4.0, 6.0)
SAFE_LOAD = 0.85
"""Share of the friction that a correction may use while it sticks; if all need more, the one that needs least."""


def slide_distance(r_from: FloatArray, r_to: FloatArray, rho: float) -> float:
    """Length of a slide in m, where turning by one radian counts as ``rho = c a``: the limit surface's own measure.

    Examples
    --------
    >>> slide_distance(np.zeros(3), np.array([0.003, 0.004, 0.0]), 0.01)
    0.005
    """
    step = (np.asarray(r_to) - np.asarray(r_from)) * np.array([1.0, 1.0, rho])
    return float(np.linalg.norm(step))


def replan(first: Regrasp, r_now: FloatArray, setup: Setup) -> Plan:
    """Plan from where the last trial ended to the goal of the first.

    Parameters
    ----------
    first : Regrasp
        The experiment's own motion, whose accelerations, goal and resting places are kept.
    r_now : (3,)
        Relative pose of the finger in {b} after the last trial.
    setup : Setup
        With the friction that is now believed.

    Raises
    ------
    InfeasibleError
        If no choice of the phases' lengths keeps every limit: the limits that the gentlest one breaks.
    """
    tasks = sorted(_candidates(first, r_now, setup), key=lambda task: max(SAFE_LOAD, stick_load(task, setup)))
    refusals = []
    for task in tasks:
        try:
            return plan(task, setup)
        except InfeasibleError as refusal:
            refusals.append(refusal)
    raise min(refusals, key=lambda refusal: len(refusal.lines))


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
