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


@dataclass(frozen=True, slots=True)
class TickSeries:
    """Ticks of the loop: when each was due on the host's clock, and how late it began, (T,) ns."""

    stamp_ns: IntArray
    late_ns: IntArray


@dataclass(frozen=True, slots=True)
class StreamStatistics:
    """What became of everything that came over the wires, counted since the trial began, at ``stamp_ns``.

    Attributes
    ----------
    frames_taken, frames_missing : int
        Camera frames that were new, and frame numbers that never came.
    frames_repeated, frames_late, frames_frozen : int
        Camera frames that came twice, after a newer one, or with an old exposure.
    datagrams_malformed, datagrams_foreign : int
        Datagrams that are no packets, or that nobody in the lab sent.
    echoes_lost : int
        Echoes without an answer.
    records_lost : int
        What the recorder had no room for.
    states_lost, states_disordered : int
        Numbered states of the arm that never came, and those that came twice or after a newer one.
    bodies_swapped : int
        How often the hand and the object changed names from one frame to the next.
    """

    stamp_ns: int
    frames_taken: int = 0
    frames_missing: int = 0
    frames_repeated: int = 0
    frames_late: int = 0
    frames_frozen: int = 0
    datagrams_malformed: int = 0
    datagrams_foreign: int = 0
    echoes_lost: int = 0
    records_lost: int = 0
    states_lost: int = 0
    states_disordered: int = 0
    bodies_swapped: int = 0
