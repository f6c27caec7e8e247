"""Which recordings can be estimated, and which part of them: a trial on a real arm is more than its motion."""

import numpy as np

from slidepipe.artifacts.recording_reader import Recording
from slidepipe.errors import EstimationError
from slidepipe.lab.course import REST_S
from slidepipe.lab.loop import INVALID, MOTION_ENDS, STOPPED
from slidepipe.series import BoolArray, FrameSeries, MocapSeries, PoseSeries

LATE_S = 0.02
"""Frames arrive so much later than they were taken, at most, beyond the rests."""


def refuse_unsound(recording: Recording) -> None:
    """Refuse a trial that was stopped before its motion ended, or whose arm went without commands for too long.

    Raises
    ------
    EstimationError
        It is one of these: tells why.
    """
    said = [event.message for event in recording.events()]
    for message in said:
        if message.startswith(INVALID):
            raise EstimationError(f"{recording.path}: the trial is {message}: run it again")
        if message.startswith(STOPPED) and MOTION_ENDS not in said:
            raise EstimationError(f"{recording.path}: the trial was {message}")


def around_motion(mocap: MocapSeries, start_ns: int, stop_ns: int) -> MocapSeries:
    """Keep the frames of the motion and of the rests beside it: not those of the way to the start and home."""
    margin_ns = round(1e9 * (REST_S + LATE_S))
    at = mocap.frames.received_ns
    kept = (at >= start_ns - margin_ns) & (at <= stop_ns + margin_ns)
    numbers = mocap.frames.frame[kept]
    return MocapSeries(
        frames=_frames(mocap.frames, kept),
        hand=_poses(mocap.hand, np.isin(mocap.hand.sequence, numbers)),
        object=_poses(mocap.object, np.isin(mocap.object.sequence, numbers)),
        clock=mocap.clock,
    )


def _frames(frames: FrameSeries, kept: BoolArray) -> FrameSeries:
    return FrameSeries(
        frame=frames.frame[kept],
        ticks=frames.ticks[kept],
        received_ns=frames.received_ns[kept],
        hand_valid=frames.hand_valid[kept],
        object_valid=frames.object_valid[kept],
    )


def _poses(poses: PoseSeries, kept: BoolArray) -> PoseSeries:
    return PoseSeries(poses.stamp_ns[kept], poses.position_m[kept], poses.quaternion_xyzw[kept], poses.sequence[kept])
