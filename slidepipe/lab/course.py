"""What the arm is to do, tick by tick and made beforehand, and how it slows down on the way."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import Enum

import numpy as np

from slidepipe.errors import InputError
from slidepipe.lab.protocols import JointCommand
from slidepipe.series import FloatArray, JointSeries
from slidepipe.tick import TICK_S

REST_S = 0.5
"""How long the arm holds before and after the motion, so that the cameras see both grips at rest."""


class Phase(Enum):
    """Parts of an execution."""

    LINK = "link"
    APPROACH = "approach"
    REST = "rest"
    MOTION = "motion"
    SETTLED = "settled"
    RETURN = "return"
    HOLD = "hold"
    STOP = "stop"


@dataclass(frozen=True, slots=True)
class Leg:
    """One part of a course: (T, 7) angles, speeds, and torques beyond gravity, one row a tick."""

    phase: Phase
    position_rad: FloatArray
    velocity_rad_s: FloatArray
    effort_n_m: FloatArray

    @classmethod
    def of(cls, reference: JointSeries) -> "Leg":
        """Make the motion of a plan's reference."""
        return cls(Phase.MOTION, reference.position_rad, reference.velocity_rad_s, reference.effort_n_m)

    @classmethod
    def hold(cls, phase: Phase, position_rad: FloatArray, duration_s: float) -> "Leg":
        """Stay at (7,) for a while."""
        ticks = round(duration_s / TICK_S)
        still = np.zeros((ticks, len(position_rad)))
        return cls(phase, np.tile(position_rad, (ticks, 1)), still, still)


@dataclass(frozen=True, slots=True)
class Course:
    """Legs one after the other.

    Attributes
    ----------
    commands : tuple of JointCommand
        One for each tick.
    phases : tuple of Phase
        Of each tick.
    """

    position_rad: FloatArray
    velocity_rad_s: FloatArray
    effort_n_m: FloatArray
    phases: tuple[Phase, ...]
    commands: tuple[JointCommand, ...] = field(init=False)

    def __post_init__(self) -> None:
        columns = (self.position_rad, self.velocity_rad_s, self.effort_n_m)
        if any(len(column) != len(self.phases) for column in columns) or not self.phases:
            raise InputError(f"course: needs one row a tick, got {[len(c) for c in columns]} for {len(self.phases)}")
        if not all(np.isfinite(column).all() for column in columns):
            raise InputError("course: every angle, speed and torque must be finite")
        object.__setattr__(self, "commands", tuple(JointCommand(*row) for row in zip(*columns, strict=True)))

    def __len__(self) -> int:
        return len(self.phases)

    @classmethod
    def of(cls, legs: Sequence[Leg]) -> "Course":
        """Put legs together."""
        return cls(
            np.vstack([leg.position_rad for leg in legs]),
            np.vstack([leg.velocity_rad_s for leg in legs]),
            np.vstack([leg.effort_n_m for leg in legs]),
            tuple(leg.phase for leg in legs for _ in leg.position_rad),
        )

    def at(self, place: float, rate: float) -> JointCommand:
        """Command on the way between two ticks, passed at ``rate`` times the planned speed.

        The angles are on the cubic through both ticks' angles and speeds; torques beyond gravity shrink with the square
        of the rate, as accelerations along the path do.
        """
        index = min(int(place), len(self) - 2)
        share = place - index
        q0, q1 = self.position_rad[index], self.position_rad[index + 1]
        v0, v1 = TICK_S * self.velocity_rad_s[index], TICK_S * self.velocity_rad_s[index + 1]
        slope, bend = q1 - q0, v0 + v1 - 2.0 * (q1 - q0)
        position = q0 + share * (v0 + share * (slope - v0 + (share - 1.0) * bend))
        speed = v0 + share * (2.0 * (slope - v0) + (3.0 * share - 2.0) * bend)
        effort = (1.0 - share) * self.effort_n_m[index] + share * self.effort_n_m[index + 1]
        return JointCommand(position, rate * speed / TICK_S, rate**2 * effort)


def rest_move_rest(reference: JointSeries) -> Course:
    """The motion of a plan, with a rest before and after it."""
    return Course.of(
        [
            Leg.hold(Phase.REST, reference.position_rad[0], REST_S),
            Leg.of(reference),
            Leg.hold(Phase.SETTLED, reference.position_rad[-1], REST_S),
        ]
    )


def stopping_rates(duration_s: float) -> FloatArray:
    """Shares (N,) of the planned speed, tick by tick, from nearly one to zero: half a cosine, without a jolt.

    Examples
    --------
    >>> [round(float(rate), 3) + 0.0 for rate in stopping_rates(4 * TICK_S)]
    [0.854, 0.5, 0.146, 0.0]
    """
    ticks = max(1, round(duration_s / TICK_S))
    return np.asarray(0.5 * (1.0 + np.cos(np.pi * np.arange(1, ticks + 1) / ticks)))
