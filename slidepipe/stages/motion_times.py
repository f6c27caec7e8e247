"""When a motion began and ended, as the hand shows it."""

from dataclasses import dataclass

import numpy as np

from slidepipe.errors import InputError
from slidepipe.series import PoseSeries

REST_S = 0.2
"""The hand must rest so long before and after."""
LEAST_M = 0.001
NOISES = 6.0
"""The motion begins where the hand is further from its rest than this many standard deviations of its noise."""


@dataclass(frozen=True, slots=True)
class MotionTimes:
    """Begin and end of a motion, s from the first frame."""

    start_s: float
    stop_s: float

    def __post_init__(self) -> None:
        if not 0.0 <= self.start_s < self.stop_s:
            raise InputError(
                f"motion: must start at 0 s or later, and end after that, got {self.start_s:g} to {self.stop_s:g} s"
            )


def find_motion(hand: PoseSeries, source: str) -> MotionTimes:
    """Find when the hand left its first rest and when it came to its last.

    Raises
    ------
    InputError
        It is seen too little, does not rest at the beginning and the end, or does not move.

    Examples
    --------
    >>> stamps = np.arange(0, 3_000_000_000, 10_000_000)
    >>> x = np.clip((1e-9 * stamps - 1.0) * 0.2, 0.0, 0.2)
    >>> poses = PoseSeries(stamps, np.stack([x, 0 * x, 0 * x], axis=1), np.zeros((300, 4)), np.arange(300))
    >>> find_motion(poses, "example")
    MotionTimes(start_s=1.0, stop_s=2.0)
    """
    time_s = 1e-9 * (hand.stamp_ns - hand.stamp_ns[0]) if len(hand.stamp_ns) else np.zeros(0)
    before, after = time_s < REST_S, time_s > (time_s[-1] if len(time_s) else 0.0) - REST_S
    if min(before.sum(), after.sum()) < 5 or time_s[-1] < 3 * REST_S:
        raise InputError(f"{source}: the hand is seen too little: say when the motion starts and ends")
    away = []
    for rest in (before, after):
        centre = np.median(hand.position_m[rest], axis=0)
        distance_m = np.linalg.norm(hand.position_m - centre, axis=1)
        away.append(distance_m > max(LEAST_M, NOISES * float(np.sqrt(np.mean(distance_m[rest] ** 2)))))
    if np.any(away[0] & before) or np.any(away[1] & after) or not np.any(away[0]):
        raise InputError(f"{source}: the hand does not rest, move and rest: say when the motion starts and ends")
    start, stop = int(np.flatnonzero(away[0])[0]), int(np.flatnonzero(away[1])[-1])
    return MotionTimes(float(time_s[max(start - 1, 0)]), float(time_s[min(stop + 1, len(time_s) - 1)]))
