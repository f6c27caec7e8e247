"""Slow, jerk-limited moves between two resting poses: to where a motion starts, and back."""

from dataclasses import dataclass

import numpy as np
from ruckig import InputParameter, Result, Ruckig, Trajectory

from slidepipe.errors import LabError
from slidepipe.lab.course import Course, Leg, Phase
from slidepipe.series import FloatArray, JointSeries
from slidepipe.tick import TICK_S


@dataclass(frozen=True, slots=True)
class MoveLimits:
    """How fast the arm goes where nothing asks for haste: (7,) rad/s, rad/s^2, rad/s^3."""

    speed_rad_s: FloatArray
    acceleration_rad_s2: FloatArray
    jerk_rad_s3: FloatArray


@dataclass(frozen=True, slots=True)
class Pauses:
    """How long the arm rests before and after the motion, and at the end, s."""

    rest_s: float
    hold_s: float


def move(phase: Phase, start_rad: FloatArray, end_rad: FloatArray, limits: MoveLimits) -> Leg:
    """Go from rest to rest, all joints arriving together.

    Raises
    ------
    LabError
        There is no such move.
    """
    dofs = len(start_rad)
    wanted = InputParameter(dofs)
    wanted.current_position, wanted.target_position = list(start_rad), list(end_rad)
    wanted.max_velocity, wanted.max_acceleration = list(limits.speed_rad_s), list(limits.acceleration_rad_s2)
    wanted.max_jerk = list(limits.jerk_rad_s3)
    way = Trajectory(dofs)
    result = Ruckig(dofs).calculate(wanted, way)
    if result not in (Result.Working, Result.Finished):
        raise LabError(f"arm: no way from {np.round(start_rad, 3)} to {np.round(end_rad, 3)} rad: {result.name}")
    ticks = int(np.ceil(way.duration / TICK_S)) + 1
    samples = [way.at_time(index * TICK_S) for index in range(ticks)]
    still = np.zeros((ticks, dofs))
    return Leg(phase, np.array([sample[0] for sample in samples]), np.array([sample[1] for sample in samples]), still)


def there_and_back(
    measured_rad: FloatArray, reference: JointSeries, home_rad: FloatArray, *, limits: MoveLimits, pauses: Pauses
) -> Course:
    """Course of a whole execution: link where the arm is, go to the start, rest, move, rest, go home, hold."""
    start, end = reference.position_rad[0], reference.position_rad[-1]
    return Course.of(
        [
            Leg.hold(Phase.LINK, measured_rad, TICK_S),
            move(Phase.APPROACH, measured_rad, start, limits),
            Leg.hold(Phase.REST, start, pauses.rest_s),
            Leg.of(reference),
            Leg.hold(Phase.SETTLED, end, pauses.rest_s),
            move(Phase.RETURN, end, home_rad, limits),
            Leg.hold(Phase.HOLD, home_rad, pauses.hold_s),
        ]
    )
