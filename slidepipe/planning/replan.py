"""The next regrasp from what the last one left, in the manner of Theorem 1.

The remaining error becomes the new goal. Equation (4) keeps the accelerations and shortens every phase with the square
root of the distance, and so does this: a smaller correction is as strong against wrong friction as the first motion.
Where the shortened sticking phases would ask for more friction than there is, they are lengthened.
"""

import numpy as np

from slidepipe.errors import InfeasibleError
from slidepipe.planning.planner import TICK_S, Setup, grasp_is_feasible
from slidepipe.planning.three_phase import Regrasp
from slidepipe.series import FloatArray

SHORTEST_SLIDE_S = 0.02
"""Ten ticks: the arm does not follow a shorter slide."""
STRETCHES = tuple(1.25**power for power in range(13))


def slide_distance(r_from: FloatArray, r_to: FloatArray, rho: float) -> float:
    """Length of a slide in m, where turning by one radian counts as ``rho = c a``: the limit surface's own measure.

    Examples
    --------
    >>> slide_distance(np.zeros(3), np.array([0.003, 0.004, 0.0]), 0.01)
    0.005
    """
    step = (np.asarray(r_to) - np.asarray(r_from)) * np.array([1.0, 1.0, rho])
    return float(np.linalg.norm(step))


def next_regrasp(first: Regrasp, r_now: FloatArray, setup: Setup) -> Regrasp:
    """Regrasp from where the last trial ended to the goal of the first.

    Parameters
    ----------
    first : Regrasp
        The experiment's own motion, whose accelerations and goal are kept.
    r_now : (3,)
        Relative pose of the finger in {b} after the last trial.
    setup : Setup
        With the friction now believed.

    Raises
    ------
    InfeasibleError
        If no lengthening of the sticking phases keeps the grip.
    """
    rho = setup.finger.a * setup.finger.c
    share = slide_distance(r_now, first.r_goal, rho) / slide_distance(first.r_start, first.r_goal, rho)
    slide_s = max(SHORTEST_SLIDE_S, first.T23 * np.sqrt(share))
    scale = slide_s / first.T23
    for stretch in STRETCHES:
        task = Regrasp(
            q_o_start=first.q_o_start,
            r_start=np.asarray(r_now, dtype=float),
            r_goal=first.r_goal,
            q_f_end=first.q_f_end,
            T1=_on_ticks(first.T1 * scale * stretch, 1),
            T23=_on_ticks(slide_s, 2),
            T4=_on_ticks(first.T4 * scale * stretch, 1),
        )
        if grasp_is_feasible(task, setup):
            return task
    step = np.array2string(np.asarray(first.r_goal - r_now), precision=4)
    raise InfeasibleError(
        f"replan: no correction by {step} (m, m, rad) keeps the grip while it sticks, with phases of up to "
        f"{task.T1:.2f} s and {task.T4:.2f} s"
    )


def _on_ticks(duration_s: float, multiple: int) -> float:
    step = multiple * TICK_S
    return max(1, round(duration_s / step)) * step
