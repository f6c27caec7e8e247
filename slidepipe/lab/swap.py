"""Whether the cameras have taken the hand's markers for the object's and the other way round."""

import numpy as np

from slidepipe.lab.protocols import BodyPose
from slidepipe.series import FloatArray

TURN_M = 0.05
"""Length that a radian counts as, beside the distances between bodies some centimetres apart."""
STEP_M = 0.02
"""A swap is believed only where keeping the names would be a longer way than this, and swapping them half of it."""
OLD_NS = 50_000_000
"""Poses older than this tell nothing of the next ones."""


class SwapWatch:
    """Follows two bodies from frame to frame, by where each was in the frame before.

    Between two frames the bodies move millimetres and turn little; where names are swapped each jumps to where the
    other was.
    """

    def __init__(self) -> None:
        self._last: tuple[FloatArray, FloatArray] | None = None
        self._last_ns = 0
        self._since_ns: int | None = None
        self.count = 0

    def see(self, hand: BodyPose, thing: BodyPose, now_ns: int) -> None:
        """Look at a frame in which both bodies were tracked."""
        now = (_features(hand), _features(thing))
        if self._last is not None and now_ns - self._last_ns < OLD_NS and _swapped(self._last, now):
            self.count += 1
            self._since_ns = now_ns if self._since_ns is None else None
        self._last, self._last_ns = now, now_ns

    def lasts_s(self, now_ns: int) -> float:
        """How long the names have been swapped by now; 0 where they are right."""
        return 0.0 if self._since_ns is None else 1e-9 * (now_ns - self._since_ns)


def _features(body: BodyPose) -> FloatArray:
    """Position, and the body's x axis as a length: (6,) m."""
    x, y, z, w = body.quaternion_xyzw
    axis = (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w))
    return np.concatenate([body.position_m, TURN_M * np.array(axis)])


def _swapped(last: tuple[FloatArray, FloatArray], now: tuple[FloatArray, FloatArray]) -> bool:
    kept = np.linalg.norm(now[0] - last[0]) + np.linalg.norm(now[1] - last[1])
    crossed = np.linalg.norm(now[0] - last[1]) + np.linalg.norm(now[1] - last[0])
    return bool(kept > STEP_M and crossed < 0.5 * kept)
