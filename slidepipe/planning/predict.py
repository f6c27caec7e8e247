"""Where an object ends under a planned hand, for many frictions and starts at once."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.interpolate import make_interp_spline

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


@dataclass(frozen=True, slots=True)
class SampledHand:
    """Hand of a plan as it is sampled.

    Attributes
    ----------
    time_s, q_f : (T,), (T, 3)
        Poses in {w}, one a tick, the angle without jumps.
    boundaries_s : (K,)
        Times, among the samples, at which its acceleration jumps; first and last included.
    """

    time_s: FloatArray
    q_f: FloatArray
    boundaries_s: FloatArray

    def resampled(self, parts: int) -> FloatArray:
        """Poses at ``parts`` times the samples: cubics that do not smooth over a jump of the acceleration."""
        edges = np.searchsorted(self.time_s, self.boundaries_s - 1e-9)
        pieces = [self.q_f[:1]]
        for first, last in pairwise(np.unique(edges)):  # a phase may be shorter than a tick
            piece = slice(first, last + 1)
            fine = np.linspace(self.time_s[first], self.time_s[last], parts * (last - first) + 1)[1:]
            odd = last - first - 1 + (last - first) % 2
            spline = make_interp_spline(self.time_s[piece], self.q_f[piece], k=min(5, odd))
            pieces.append(np.asarray(spline(fine)))
        return np.concatenate(pieces)


def predict(hand: SampledHand, block: Block, rho: float, *, kappa: FloatArray, r_start: FloatArray) -> Prediction:
    """Simulate a trial for each row of ``kappa`` and ``r_start``, with the hand exactly where it was planned.

    Parameters
    ----------
    hand : SampledHand
    block : Block
    rho : float
        c a, m.
    kappa : (N,)
        mu f_N / m of each world, m/s^2.
    r_start : (N, 3)
        Relative pose of the finger in {b} at the start.
    """
    poses = hand.resampled(STEPS_PER_TICK)
    rest = round(REST_S / TICK_S) * STEPS_PER_TICK
    poses = np.concatenate([poses, np.repeat(poses[-1:], rest, axis=0)])
    fine = hand.time_s[0] + TICK_S / STEPS_PER_TICK * np.arange(len(poses))
    half = 0.5 * np.array([block.length, block.width])
    start = np.array(r_start, dtype=float)
    start[:, :2] = np.clip(start[:, :2], -half, half)
    # One newton and as much friction as kappa asks for.
    finger = SoftFinger(1.0, block.m, rho, 1.0)
    sets = ParameterSets.of(block, finger, start, mu=np.asarray(kappa, dtype=float))
    r = step_many(fine, poses, sets)
    return Prediction(r, np.any(np.abs(r[:, :2]) > half, axis=1))
