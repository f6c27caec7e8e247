"""Motions along a line with piecewise constant acceleration."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from slidepipe.errors import InputError
from slidepipe.series import FloatArray


@dataclass(frozen=True, slots=True)
class Piece:
    """Constant acceleration ``ddq`` in m/s^2 for ``duration`` in s, from the velocity ``dq`` in m/s."""

    duration: float
    dq: float
    ddq: float

    @property
    def way(self) -> float:
        """How far it leads, m."""
        return self.duration * (self.dq + 0.5 * self.ddq * self.duration)


@dataclass(frozen=True, slots=True)
class LineMotion:
    """A motion along a line with piecewise constant acceleration; it rests before the first piece and after the last.

    Attributes
    ----------
    breaks : (K + 1,)
        Times between the pieces, s.
    coefficients : (K, 3)
        ``sum_d coefficients[k, d] (t - breaks[k])**d`` in m.
    """

    breaks: FloatArray
    coefficients: FloatArray

    @classmethod
    def of(cls, pieces: Sequence[Piece]) -> "LineMotion":
        """One piece after another, from zero. Each brings its own initial velocity, so that rest is exact."""
        breaks = np.cumsum([0.0] + [piece.duration for piece in pieces])
        q = np.cumsum([0.0] + [piece.way for piece in pieces[:-1]])
        return cls(breaks, np.array([[start, p.dq, 0.5 * p.ddq] for start, p in zip(q, pieces, strict=True)]))

    def at(self, time_s: FloatArray | float, derivative: int = 0) -> FloatArray:
        """Position, velocity (``derivative=1``) or acceleration (2) at times (...); at a break that of the later piece.

        Examples
        --------
        >>> LineMotion(np.array([0.0, 2.0]), np.array([[0.0, 0.0, 1.0]])).at([-1.0, 1.0, 3.0])
        array([0., 1., 4.])
        """
        if derivative not in {0, 1, 2}:
            raise InputError(f"line motion: derivative must be 0, 1 or 2, got {derivative!r}")
        t = np.asarray(time_s, dtype=float)
        if np.any(np.isnan(t)):
            raise InputError(f"line motion: times must be numbers, got {time_s!r}")
        start, stop = self.breaks[0], self.breaks[-1]
        k = np.clip(np.searchsorted(self.breaks, t, side="right") - 1, 0, len(self.coefficients) - 1)
        q, dq, half = np.moveaxis(self.coefficients[k], -1, 0)
        tau = np.clip(t, start, stop) - self.breaks[k]
        if derivative == 0:
            return np.asarray(q + tau * (dq + tau * half))
        moving = dq + 2.0 * half * tau if derivative == 1 else 2.0 * half
        return np.where((t >= start) & (t < stop), moving, 0.0)
