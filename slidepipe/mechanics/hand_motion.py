"""The motion of the hand as polynomials in time: what an object is simulated under."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.interpolate import BPoly, PPoly

from slidepipe.errors import InputError
from slidepipe.series import BoolArray, FloatArray

DEGREE = 7
"""Degree of the pieces that :meth:`HandMotion.from_function` fits."""
FINEST = 12
"""How often a phase is halved at most."""
AT = np.array([
    *(0.5 * (1.0 - np.cos(np.pi * np.arange(DEGREE + 1) / DEGREE))),
    0.03, 0.12, 0.31, 0.44, 0.56, 0.69, 0.88, 0.97,
])  # fmt: skip
"""Shares of a piece at which it is fitted, Chebyshev's points, and then those at which the fit is judged."""
POWERS = np.vander(AT, DEGREE + 1, increasing=True)


@dataclass(frozen=True, slots=True)
class HandMotion:
    """Pose q_f(t) of the finger in {w}, piece by piece; it rests before the first and after the last.

    Attributes
    ----------
    breaks : (K + 1,)
        Times between the pieces, s.
    coefficients : (K, D + 1, 3)
        ``q_f(t) = sum_d coefficients[k, d] (t - breaks[k])**d`` in m and rad.
    jumps : (K + 1,) bool
        Where the acceleration may jump; elsewhere pieces join smoothly.
    """

    breaks: FloatArray
    coefficients: FloatArray
    jumps: BoolArray

    def __post_init__(self) -> None:
        _check_times("hand motion: breaks", self.breaks)
        if not np.all(np.isfinite(self.coefficients)):
            raise InputError("hand motion: every pose must be finite, got NaN or infinity")
        if self.coefficients.ndim != 3 or self.coefficients.shape[::2] != (len(self.breaks) - 1, 3):
            raise InputError(
                f"hand motion: coefficients must be ({len(self.breaks) - 1}, degree + 1, 3), "
                f"got {self.coefficients.shape}"
            )

    @classmethod
    def from_samples(cls, time_s: FloatArray, q_f: FloatArray, dq_f: FloatArray, ddq_f: FloatArray) -> "HandMotion":
        """Quintics through poses, velocities and accelerations (T, 3) at times (T,); the acceleration is continuous.

        Examples
        --------
        >>> t = np.linspace(0.0, 1.0, 3)
        >>> q = np.stack([t**2, 0 * t, 0 * t], axis=1)
        >>> HandMotion.from_samples(t, q, np.gradient(q, t, axis=0), q).degree
        5
        """
        _check_times("hand motion: times", time_s)
        for name, values in (("q_f", q_f), ("dq_f", dq_f), ("ddq_f", ddq_f)):
            if np.shape(values) != (len(time_s), 3) or not np.all(np.isfinite(values)):
                raise InputError(
                    f"hand motion: {name} must be ({len(time_s)}, 3) finite numbers, got {np.shape(values)}"
                )
        quintic = PPoly.from_bernstein_basis(BPoly.from_derivatives(time_s, np.stack([q_f, dq_f, ddq_f], axis=1)))
        coefficients = np.ascontiguousarray(np.moveaxis(quintic.c[::-1], 0, 1))
        jumps = np.zeros(len(time_s), dtype=bool)
        return cls(np.asarray(time_s, dtype=float), coefficients, jumps)

    @classmethod
    def from_function(
        cls, pose: Callable[[FloatArray], FloatArray], boundaries: FloatArray, tolerance: float = 1e-13
    ) -> "HandMotion":
        """Fit a motion that is smooth between boundaries, halving each phase until the fit is good to ``tolerance``.

        Parameters
        ----------
        pose : callable
            (T,) times to (T, 3) poses; at a boundary both sides must agree.
        boundaries : (B,)
            Times at which the acceleration may jump, first and last included, s.
        tolerance : float
            Largest deviation in m and rad, checked between the nodes.
        """
        _check_times("hand motion: boundaries", boundaries)
        edges, jumps = [float(boundaries[0])], [True]
        pieces: list[FloatArray] = []
        for start, stop in pairwise(boundaries):
            ends, fitted = _phase(pose, float(start), float(stop), tolerance)
            edges.extend(ends)
            pieces.extend(fitted)
            jumps.extend(ends >= stop)
        coefficients = np.array(pieces)
        spans = np.diff(edges)[:, None] ** np.arange(DEGREE + 1)
        used = np.max(np.abs(coefficients) * spans[:, :, None], axis=(0, 2)) > 0.01 * tolerance
        degree = int(np.max(np.flatnonzero(used), initial=2))
        return cls(np.array(edges), np.ascontiguousarray(coefficients[:, : degree + 1]), np.array(jumps))

    @property
    def degree(self) -> int:
        """Degree of the pieces."""
        return int(self.coefficients.shape[1]) - 1

    def at(self, time_s: FloatArray, derivative: int = 0) -> FloatArray:
        """Pose, or a derivative of it, (T, 3) at times (T,)."""
        inside = PPoly(np.moveaxis(self.coefficients, 0, 1)[::-1], self.breaks)
        clipped = np.clip(time_s, self.breaks[0], self.breaks[-1])
        values = np.asarray(inside(clipped, derivative))
        if derivative:
            values[(np.asarray(time_s) < self.breaks[0]) | (np.asarray(time_s) >= self.breaks[-1])] = 0.0
        return values


def _phase(
    pose: Callable[[FloatArray], FloatArray], start: float, stop: float, tolerance: float
) -> tuple[FloatArray, FloatArray]:
    """Ends (K,) and coefficients (K, DEGREE + 1, 3) of a phase's pieces, all as long: twice as many until they fit."""
    for level in range(FINEST + 1):
        edges = np.linspace(start, stop, 2**level + 1)
        length = edges[1] - edges[0]
        told = pose((edges[:-1, None] + length * AT).ravel()).reshape(-1, len(AT), 3)
        # Powers of the share of the piece, then of the time.
        powers = np.linalg.solve(POWERS[: DEGREE + 1], told[:, : DEGREE + 1])
        missed = np.max(np.abs(POWERS[DEGREE + 1 :] @ powers - told[:, DEGREE + 1 :]))
        if level == FINEST or missed < tolerance:
            return edges[1:], powers / length ** np.arange(DEGREE + 1)[:, None]
    raise InputError("hand motion: a phase cannot be fitted")


def _check_times(name: str, time_s: FloatArray) -> None:
    if np.ndim(time_s) != 1 or len(time_s) < 2 or not np.all(np.isfinite(time_s)):
        raise InputError(f"{name} must be two or more finite times")
    back = np.flatnonzero(np.diff(time_s) <= 0.0)
    if len(back):
        raise InputError(f"{name} must grow, got {float(time_s[back[0] + 1])!r} s after {float(time_s[back[0]])!r} s")
