"""An object under a given hand motion, event-driven: exact stick, slips located, high order in between (Section VI).

For reference and planning. The hand's motion is a :class:`~slidepipe.mechanics.hand_motion.HandMotion`, from a plan or
from samples. For hands that come as samples alone and for fingers apart from each other see
:mod:`slidepipe.mechanics.stepping`.
"""

from dataclasses import dataclass
from enum import IntEnum
from math import isfinite

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from slidepipe.errors import InputError
from slidepipe.mechanics import event_kernel, slide_kernel
from slidepipe.mechanics.dynamics import Block
from slidepipe.mechanics.hand_motion import HandMotion
from slidepipe.mechanics.limit_surface import SoftFinger
from slidepipe.mechanics.parameters import ParameterSets, curve_of
from slidepipe.mechanics.pressure_patch import PressurePatch
from slidepipe.series import FloatArray, IntArray

TOLERANCE = 1e-9
"""Error of a step in the place of the contact, m."""
FEW = 128
"""Knots for which there is room at first."""
REST_S = 0.5
"""How long a trial goes on after the hand has come to rest."""


class Ended(IntEnum):
    """How a trial ended."""

    STUCK = slide_kernel.STUCK
    """The object sticks to the finger."""
    SLIDING = slide_kernel.SLIDING
    """It still slides."""
    LEFT = slide_kernel.LEFT
    """The contact slid beyond the object's face: it is thrown."""
    FAILED = slide_kernel.FAILED
    """A step could not be taken; nothing is known beyond it."""


ENDS = tuple(Ended)


@dataclass(frozen=True, slots=True)
class Outcome:
    """What a trial came to.

    Attributes
    ----------
    r_f_b : (3,)
        Relative pose of the finger in {b} at the end, m and rad.
    ended : Ended
    slides : int
        How often it slid.
    slide_start_s, slide_stop_s : float
        When the first slide began and the last one stopped, NaN if there was none.
    knots : (K, 7)
        Along the slides: time, relative pose and its rate in {b}.
    """

    r_f_b: FloatArray
    ended: Ended
    slides: int
    slide_start_s: float
    slide_stop_s: float
    knots: FloatArray


@dataclass(frozen=True, slots=True)
class Outcomes:
    """What many trials came to: as :class:`Outcome`, with a row for each; ``ended`` holds values of :class:`Ended`."""

    r_f_b: FloatArray
    ended: IntArray
    slides: IntArray
    slide_start_s: FloatArray
    slide_stop_s: FloatArray


def simulate(
    hand: HandMotion,
    block: Block,
    finger: SoftFinger | PressurePatch,
    r_f_b: FloatArray,
    *,
    tolerance: float = TOLERANCE,
    until_s: float | None = None,
) -> Outcome:
    """Simulate one trial that begins at rest with the finger at ``r_f_b`` in {b}.

    Parameters
    ----------
    hand : HandMotion
    block, finger : Block, and SoftFinger or PressurePatch
    r_f_b : (3,)
        m and rad.
    tolerance : float
        Error of a step in the place of the contact, m.
    until_s : float, optional
        Time at which the trial ends, by default :data:`REST_S` after the hand has come to rest.

    Raises
    ------
    InputError
        A value that is not finite, or a contact that begins beyond the object's face.
    """
    tolerance, rest_s = _checked(tolerance), REST_S if until_s is None else until_s - float(hand.breaks[-1])
    for room in (FEW, slide_kernel.MOST_STEPS + 1):
        r, path = _start(block, r_f_b), np.empty((room, 7))
        ended, slides, start_s, stop_s, knots = event_kernel.run_trial(
            hand.breaks, hand.coefficients, hand.jumps, curve_of(finger),
            block.m, block.inertia, finger.mu * finger.f_N, finger.c * finger.a, block.length, block.width,
            tolerance, rest_s, r, path,
        )  # fmt: skip
        if knots < room:
            break
    return Outcome(r, ENDS[ended], slides, start_s, stop_s, path[:knots].copy())


def simulate_many(hand: HandMotion, sets: ParameterSets, *, tolerance: float = TOLERANCE) -> Outcomes:
    """Simulate a trial for each parameter set, on all cores."""
    r, out = sets.r_f_b.copy(), np.empty((len(sets.bodies), 5))
    event_kernel.run_batch(
        hand.breaks, hand.coefficients, hand.jumps, sets.curve, sets.bodies, _checked(tolerance), REST_S, r, out
    )
    return Outcomes(
        r_f_b=r,
        ended=out[:, 0].astype(np.int64),
        slides=out[:, 1].astype(np.int64),
        slide_start_s=out[:, 2],
        slide_stop_s=out[:, 3],
    )


def relative_motion(outcome: Outcome, r_f_b: FloatArray, time_s: FloatArray) -> FloatArray:
    """Relative pose (T, 3) at any times of a trial that began at ``r_f_b``: cubics through the knots of its slide."""
    if not len(outcome.knots):
        return np.tile(np.asarray(r_f_b, dtype=float), (len(time_s), 1))
    times = np.concatenate([[outcome.slide_start_s], outcome.knots[:, 0], [outcome.slide_stop_s]])
    poses = np.concatenate([[r_f_b], outcome.knots[:, 1:4], [outcome.r_f_b]])
    rates = np.concatenate([np.zeros((1, 3)), outcome.knots[:, 4:7], np.zeros((1, 3))])
    keep = np.concatenate([[True], np.diff(times) > 0.0])
    spline = CubicHermiteSpline(times[keep], poses[keep], rates[keep])
    return np.asarray(spline(np.clip(time_s, times[0], times[-1])))


def _start(block: Block, r_f_b: FloatArray) -> FloatArray:
    r = np.array(r_f_b, dtype=float)
    if r.shape != (3,):
        raise InputError(f"simulation: r_f_b must be three finite numbers, got {r_f_b!r}")
    x, y, theta = r.tolist()
    if not isfinite(x + y + theta):
        raise InputError(f"simulation: r_f_b must be three finite numbers, got {r_f_b!r}")
    if abs(x) > 0.5 * block.length or abs(y) > 0.5 * block.width:
        raise InputError(f"simulation: r_f_b must begin on the object's face, got {r_f_b!r}")
    return r


def _checked(tolerance: float) -> float:
    if not 1e-14 <= tolerance <= 1e-3:
        raise InputError(f"simulation: tolerance must be from 1e-14 to 1e-3 m, got {tolerance!r}")
    return tolerance
