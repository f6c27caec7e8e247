"""What is wished of a motion that the planner finds by itself."""

from dataclasses import dataclass
from enum import Enum

import numpy as np

from slidepipe.errors import InputError
from slidepipe.series import FloatArray


class Objective(Enum):
    """What a motion is to be best at."""

    FAST = "fast"
    """The shortest time."""
    GENTLE = "gentle"
    """The least acceleration of the hand."""
    ROBUST = "robust"
    """The most friction error survived."""


@dataclass(frozen=True, slots=True)
class Weights:
    """What counts how much: a second of time, the share of the hand's acceleration limit, a friction error of one."""

    time: float = 0.0
    hand_acceleration: float = 0.0
    friction_error: float = 0.0

    def __post_init__(self) -> None:
        values = np.array([self.time, self.hand_acceleration, self.friction_error])
        if not (np.all(np.isfinite(values)) and np.all(values >= 0.0) and np.any(values > 0.0)):
            raise InputError(f"wish: weights must be numbers from zero on, one of them positive, got {values.tolist()}")


WEIGHTS = {
    Objective.FAST: Weights(time=1.0),
    Objective.GENTLE: Weights(hand_acceleration=1.0),
    Objective.ROBUST: Weights(friction_error=1.0),
}
"""A single objective as weights."""


@dataclass(frozen=True, slots=True)
class Wish:
    """What is wished, and what is left free.

    Attributes
    ----------
    weights : Weights
    friction_error : float
        Share by which the friction may be wrong either way: the object must stick with that much less wherever it is to
        stick, and the trial must survive it.
    turn_rad : float
        How far from the start's angle the object may be turned, in the hand, before it slides.
    angle_free : bool
        Whether the object's angle at the start is free too, by as much.
    force_range : (2,)
        Least and largest normal force of all fingers beside the believed one.
    """

    weights: Weights
    friction_error: float = 0.1
    turn_rad: float = np.pi
    angle_free: bool = False
    force_range: FloatArray | tuple[float, float] = (1.0, 1.0)

    def __post_init__(self) -> None:
        if not 0.0 <= self.friction_error < 1.0:
            raise InputError(f"wish: friction_error must be from 0 to below 1, got {self.friction_error!r}")
        if not 0.0 <= self.turn_rad <= np.pi:
            raise InputError(f"wish: turn_rad must be from 0 to pi, got {self.turn_rad!r}")
        low, high = self.force_range
        if not 0.0 < low <= high:
            raise InputError(f"wish: force_range must be two positive shares that grow, got {self.force_range!r}")
