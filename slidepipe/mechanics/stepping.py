"""An object in n soft fingers of one hand whose motion comes as samples: implicit time stepping with exact stick.

First order in the step and unconditionally stable. A stuck object keeps its place in the hand to the last bit.
"""

from dataclasses import dataclass

import numpy as np

from slidepipe.errors import InputError
from slidepipe.mechanics import stepping_kernel
from slidepipe.mechanics.dynamics import Block
from slidepipe.mechanics.grasp import Shapes
from slidepipe.mechanics.limit_surface import SoftFinger
from slidepipe.mechanics.parameters import ParameterSets, curve_of
from slidepipe.mechanics.pressure_patch import PressurePatch
from slidepipe.series import FloatArray

UNSETTLED = 1e-6
"""Share of the largest force by which the contacts of a step may disagree."""


@dataclass(frozen=True, slots=True)
class PlacedFinger:
    """One finger of the hand: its contact, and its place (2,) in the hand's frame {f}, m."""

    finger: SoftFinger | PressurePatch
    place: FloatArray


@dataclass(frozen=True, slots=True)
class SteppedMotion:
    """What stepping through a hand's samples came to.

    Attributes
    ----------
    r_f_b : (T, 3)
        Relative pose of {f} in {b} at each sample, m and rad.
    sliding_steps : int
        In how many steps it slid.
    residual : float
        By what share of a force the contacts of the worst step disagreed; zero with a single finger.
    """

    r_f_b: FloatArray
    sliding_steps: int
    residual: float


def step_through(
    time_s: FloatArray, q_f: FloatArray, block: Block, fingers: tuple[PlacedFinger, ...], r_f_b: FloatArray
) -> SteppedMotion:
    """Step an object, at rest at first, through the samples of a hand.

    Parameters
    ----------
    time_s, q_f : (T,), (T, 3)
        Poses of the hand {f} in {w}.
    block : Block
    fingers : tuple of PlacedFinger
    r_f_b : (3,)
        Relative pose of {f} in {b} at the start.

    Raises
    ------
    InputError
        No finger, a number that is not finite, times that do not grow, or contacts that do not settle.

    Examples
    --------
    >>> block, finger = Block(0.06, 0.1, 0.02), SoftFinger(0.5, 2.0, 0.02, 0.6)
    >>> time_s = np.linspace(0.0, 1.0, 101)
    >>> still = step_through(time_s, np.zeros((101, 3)), block, (PlacedFinger(finger, np.zeros(2)),), np.zeros(3))
    >>> still.sliding_steps
    0
    """
    time_s, q_f = _checked(time_s, q_f)
    start = np.array(r_f_b, dtype=float)
    if start.shape != (3,) or not np.all(np.isfinite(start)):
        raise InputError(f"stepping: r_f_b must be three finite numbers, got {start!r}")
    contacts, path, v = _contacts(fingers), np.empty((len(time_s), 3)), np.zeros(3)
    if len(fingers) == 1 and not np.any(contacts[0, 2:]):
        slid, residual = stepping_kernel.run_lone(
            time_s, q_f, block.m, block.inertia, contacts[0], curve_of(fingers[0].finger), start, v, path
        )
    else:
        shapes = Shapes.among([placed.finger for placed in fingers])
        slid, residual = stepping_kernel.run_samples(
            time_s, q_f, block.m, block.inertia, contacts, shapes.of, shapes.curves, start, v, path
        )
    if residual > UNSETTLED:
        raise InputError(
            f"stepping: the contacts disagree by {residual:.1e} of a force, at most {UNSETTLED:g} is allowed: "
            "shorten the steps"
        )
    return SteppedMotion(path, int(slid), float(residual))


def step_many(time_s: FloatArray, q_f: FloatArray, sets: ParameterSets) -> FloatArray:
    """Last relative pose (N, 3) for each parameter set under one hand and one finger at its origin, on all cores."""
    time_s, q_f = _checked(time_s, q_f)
    r, v = sets.r_f_b.copy(), np.zeros_like(sets.r_f_b)
    bodies, contacts = (np.ascontiguousarray(sets.bodies[:, columns]) for columns in ([0, 1, 4], [2, 3]))
    stepping_kernel.run_lone_batch(time_s, q_f, bodies, contacts, sets.curve, r, v)
    return r


def _contacts(fingers: tuple[PlacedFinger, ...]) -> FloatArray:
    if not fingers:
        raise InputError("stepping: a grasp needs at least one finger, got none")
    rows = []
    for number, placed in enumerate(fingers, start=1):
        place = np.asarray(placed.place, dtype=float)
        if place.shape != (2,) or not np.all(np.isfinite(place)):
            raise InputError(f"stepping: the place of finger {number} must be two finite numbers, got {place!r}")
        rows.append([placed.finger.mu * placed.finger.f_N, placed.finger.a * placed.finger.c, *place])
    return np.array(rows)


def _checked(time_s: FloatArray, q_f: FloatArray) -> tuple[FloatArray, FloatArray]:
    time_s, q_f = np.ascontiguousarray(time_s, dtype=float), np.ascontiguousarray(q_f, dtype=float)
    if time_s.ndim != 1 or len(time_s) < 2 or q_f.shape != (len(time_s), 3):
        raise InputError(f"stepping: times (T,) and poses (T, 3) must go together, got {time_s.shape}, {q_f.shape}")
    if not (np.all(np.isfinite(time_s)) and np.all(np.isfinite(q_f))):
        raise InputError("stepping: the hand's motion must be finite, got NaN or infinity")
    back = np.flatnonzero(np.diff(time_s) <= 0.0)
    if len(back):
        later, sooner = float(time_s[back[0] + 1]), float(time_s[back[0]])
        raise InputError(f"stepping: times must grow, got {later!r} s after {sooner!r} s")
    return time_s, q_f
