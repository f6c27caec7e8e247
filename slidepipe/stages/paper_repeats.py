"""Repeated trials of Section IX: how far they miss, and which friction would explain the paper's miss."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq

from slidepipe.mechanics.hand_motion import HandMotion
from slidepipe.mechanics.limit_surface import SoftFinger
from slidepipe.mechanics.simulate import simulate
from slidepipe.series import FloatArray
from slidepipe.stages.paper_runs import PaperRuns, Planned
from slidepipe.stages.translate import block, setup, vector

PAPER_ERROR, PAPER_SD = np.array([0.0103, 0.0112, -0.16]), np.array([0.0023, 0.0040, 0.27])
"""Section IX: mean and standard deviation of the error in the final relative pose, m and rad."""


@dataclass(frozen=True, slots=True)
class RepeatError:
    """Goal less final relative pose over repeated trials: mean and standard deviation (3,), m and rad."""

    mean: FloatArray
    sd: FloatArray
    lost: int


def repeat_error(runs: PaperRuns) -> RepeatError:
    """Error of the repeated trials that held the object."""
    goal = vector(runs.linear.experiment.goal.relative_pose)
    ends = [one.estimate.final_relative_pose.vector for one in runs.repeats if one.estimate.final_relative_pose]
    error = goal - np.array(ends)
    error[:, 2] = (error[:, 2] + np.pi) % (2.0 * np.pi) - np.pi
    return RepeatError(error.mean(axis=0), error.std(axis=0, ddof=1), len(runs.repeats) - len(ends))


def friction_for_miss(planned: Planned, miss_m: float) -> float:
    """True over believed friction at which a perfectly moved hand slides short of the goal by so much."""
    experiment, motion = planned.experiment, planned.motion
    edges = np.array([0.0, planned.document.slide.start_s, planned.document.slide.switch_s])
    edges = np.append(edges, [planned.document.slide.stop_s, motion.time_s[-1]])
    hand = HandMotion.from_function(_between(motion.time_s, motion.q_f, edges), edges, 1e-9)
    start, goal = vector(experiment.start.relative_pose), vector(experiment.goal.relative_pose)
    believed = setup(experiment, experiment.friction).finger

    def beyond(ratio: float) -> float:
        finger = SoftFinger(believed.mu * ratio, believed.f_N, believed.a, believed.c)
        end = simulate(hand, block(experiment), finger, start).r_f_b
        return float(np.hypot(*(goal - end)[:2])) - miss_m

    return float(brentq(beyond, 1.001, 1.2, xtol=1e-4))


def _between(time_s: FloatArray, q_f: FloatArray, edges: FloatArray) -> Callable[[FloatArray], FloatArray]:
    """Poses between samples, phase by phase, since accelerations jump at the edges."""
    splines = []
    for start, stop in pairwise(edges):
        inside = (time_s > start - 1e-9) & (time_s < stop + 1e-9)
        splines.append(CubicSpline(time_s[inside], q_f[inside]))

    def pose(times: FloatArray) -> FloatArray:
        phase = np.clip(np.searchsorted(edges, times, side="right") - 1, 0, len(splines) - 1)
        return np.array([splines[k](t) for k, t in zip(phase, times, strict=True)])

    return pose
