"""Where an object ends under a planned hand, for many frictions and starts at once."""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from slidepipe.mechanics.dynamics import Block
from slidepipe.mechanics.limit_surface import SoftFinger
from slidepipe.mechanics.parameters import ParameterSets
from slidepipe.mechanics.stepping import step_many
from slidepipe.series import BoolArray, FloatArray
from slidepipe.tick import TICK_S

STEPS_PER_TICK = 8
"""Of the implicit stepping: fine enough to be right to some 0.05 mm, which is below what the cameras see."""
REST_S = 0.2
"""How long the hand rests after its motion: a slide that has not stopped by then is lost."""


@dataclass(frozen=True, slots=True)
class Prediction:
    """Final relative poses (N, 3) in {b}, and whether the object is lost: the contact is beyond its face, (N,)."""

    r_f_b: FloatArray
    lost: BoolArray


def predict(
    time_s: FloatArray, q_f: FloatArray, block: Block, rho: float, *, kappa: FloatArray, r_start: FloatArray
) -> Prediction:
    """Simulate a trial for each row of ``kappa`` and ``r_start``, with the hand exactly where it was planned.

    Parameters
    ----------
    time_s, q_f : (T,), (T, 3)
        Poses of the hand in {w}, one a tick.
    block : Block
    rho : float
        c a, m.
    kappa : (N,)
        mu f_N / m of each world, m/s^2.
    r_start : (N, 3)
        Relative pose of the finger in {b} at the start.
    """
    rest = np.arange(1, round(REST_S / TICK_S) + 1) * TICK_S
    times = np.concatenate([time_s, time_s[-1] + rest])
    poses = np.concatenate([q_f, np.repeat(q_f[-1:], len(rest), axis=0)])
    fine = np.linspace(times[0], times[-1], STEPS_PER_TICK * (len(times) - 1) + 1)
    half = 0.5 * np.array([block.length, block.width])
    start = np.array(r_start, dtype=float)
    start[:, :2] = np.clip(start[:, :2], -half, half)
    # One newton and as much friction as kappa asks for.
    finger = SoftFinger(1.0, block.m, rho, 1.0)
    sets = ParameterSets.of(block, finger, start, mu=np.asarray(kappa, dtype=float))
    r = step_many(fine, np.ascontiguousarray(CubicSpline(times, poses)(fine)), sets)
    return Prediction(r, np.any(np.abs(r[:, :2]) > half, axis=1))
