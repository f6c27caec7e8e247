"""Parameter sets for batches of simulated trials."""

from dataclasses import dataclass

import numpy as np

from slidepipe.errors import InputError
from slidepipe.mechanics.dynamics import Block
from slidepipe.mechanics.limit_surface import SoftFinger
from slidepipe.mechanics.patch_curve import patch_curve
from slidepipe.mechanics.pressure_patch import PressurePatch
from slidepipe.series import FloatArray


@dataclass(frozen=True, slots=True)
class ParameterSets:
    """One row for each trial.

    Attributes
    ----------
    bodies : (N, 7)
        m, I, mu f_N, c a, scale of the hand's motion about its start, half length, half width: SI units.
    r_f_b : (N, 3)
        Relative pose of the finger in {b} at the start.
    curve : (K, 3), optional
        The surface of a pressure patch, as compiled kernels read it; None for a soft finger.
    """

    bodies: FloatArray
    r_f_b: FloatArray
    curve: FloatArray | None = None

    @classmethod
    def of(
        cls,
        block: Block,
        finger: SoftFinger | PressurePatch,
        r_f_b: FloatArray,
        *,
        mu: FloatArray | float | None = None,
        f_N: FloatArray | float | None = None,
        a: FloatArray | float | None = None,
        m: FloatArray | float | None = None,
        hand_scale: FloatArray | float = 1.0,
    ) -> "ParameterSets":
        """Build sets around a block and a finger; whatever is given replaces theirs, and (N,) arrays go together.

        The moment of inertia goes with the mass. ``hand_scale`` stretches the hand's motion about its start: an arm
        that overshoots by 2 % has 1.02.

        Raises
        ------
        InputError
            A value that is not positive or not finite, or lengths that do not agree.

        Examples
        --------
        >>> block, finger = Block(0.06, 0.1, 0.02), SoftFinger(0.4, 1.0, 0.02, 0.6)
        >>> ParameterSets.of(block, finger, np.zeros(3), mu=np.array([0.3, 0.4, 0.5])).bodies[:, 2]
        array([0.3, 0.4, 0.5])
        """
        given = {
            "mu": finger.mu if mu is None else mu,
            "f_N": finger.f_N if f_N is None else f_N,
            "a": finger.a if a is None else a,
            "m": block.m if m is None else m,
            "hand_scale": hand_scale,
        }
        columns = {name: np.asarray(values, dtype=float) for name, values in given.items()}
        for name, values in columns.items():
            if values.ndim > 1 or not np.all(np.isfinite(values) & (values > 0.0)):
                raise InputError(f"parameter sets: {name} must be positive numbers, got {values!r}")
        start = np.asarray(r_f_b, dtype=float)
        if start.shape[-1:] != (3,) or start.ndim > 2 or not np.all(np.isfinite(start)):
            raise InputError(f"parameter sets: r_f_b must be (3,) or (N, 3) finite numbers, got {start!r}")
        sizes = {values.size for values in columns.values() if values.ndim} | (
            {len(start)} if start.ndim == 2 else set()
        )
        if len(sizes) > 1:
            raise InputError(f"parameter sets: all must have the same number of trials, got {sorted(sizes)}")
        count = sizes.pop() if sizes else 1
        return cls(_bodies(block, finger, columns, count), np.broadcast_to(start, (count, 3)).copy(), curve_of(finger))

    def __post_init__(self) -> None:
        if np.any(np.abs(self.r_f_b[:, :2]) > self.bodies[:, 5:7]):
            raise InputError("parameter sets: r_f_b must begin on the object's face")


def curve_of(finger: SoftFinger | PressurePatch) -> FloatArray | None:
    """The surface that compiled kernels read for a finger; None for an ellipsoid."""
    return patch_curve(finger.k) if isinstance(finger, PressurePatch) else None


def _bodies(block: Block, finger: SoftFinger | PressurePatch, columns: dict[str, FloatArray], count: int) -> FloatArray:
    bodies = np.empty((count, 7))
    bodies[:, 0] = columns["m"]
    bodies[:, 1] = block.inertia / block.m * columns["m"]
    bodies[:, 2] = columns["mu"] * columns["f_N"]
    bodies[:, 3] = finger.c * columns["a"]
    bodies[:, 4] = columns["hand_scale"]
    bodies[:, 5], bodies[:, 6] = block.length / 2, block.width / 2
    return bodies
