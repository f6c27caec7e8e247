"""Plain time series that pass between the rooms: time first, SI units, nanosecond stamps.

Nothing here computes; it is the vocabulary that the lab, the recordings and the estimators share.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class PoseSeries:
    """Poses of one body in a named frame.

    Attributes
    ----------
    stamp_ns : (T,) int
        Time of each sample on the host's clock.
    position_m : (T, 3)
    quaternion_xyzw : (T, 4)
        Unit quaternions, scalar last.
    sequence : (T,) int
        Frame number of each sample.
    """

    stamp_ns: IntArray
    position_m: FloatArray
    quaternion_xyzw: FloatArray
    sequence: IntArray


@dataclass(frozen=True, slots=True)
class JointSeries:
    """Joint states of the arm, ``(T, 7)`` each, with stamps on the host's clock."""

    stamp_ns: IntArray
    position_rad: FloatArray
    velocity_rad_s: FloatArray
    effort_n_m: FloatArray


@dataclass(frozen=True, slots=True)
class FrameSeries:
    """What the cameras said of each frame, whether or not a body was seen in it.

    Attributes
    ----------
    frame : (T,) int
        Frame number.
    ticks : (T,) int
        Mid-exposure on the cameras' own clock.
    received_ns : (T,) int
        Arrival at the host, on the host's clock.
    hand_valid, object_valid : (T,) bool
        Whether the body was tracked.
    """

    frame: IntArray
    ticks: IntArray
    received_ns: IntArray
    hand_valid: BoolArray
    object_valid: BoolArray


@dataclass(frozen=True, slots=True)
class ClockSync:
    """Echo exchanges with the cameras: sent and received on the host's clock, answered at ``ticks`` on theirs."""

    sent_ns: IntArray
    ticks: IntArray
    received_ns: IntArray
    ticks_per_s: float


@dataclass(frozen=True, slots=True)
class MocapSeries:
    """Everything that the cameras recorded in one trial; poses carry the frame number as ``sequence``."""

    frames: FrameSeries
    hand: PoseSeries
    object: PoseSeries
    clock: ClockSync
