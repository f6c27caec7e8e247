"""Hand, object and relative pose frame by frame: one row for each camera frame, gaps marked, spikes taken out."""

from dataclasses import dataclass

import numpy as np

from slidepipe.errors import EstimationError, InputError
from slidepipe.estimation.gate import without_outliers
from slidepipe.estimation.plane import PlanarBody
from slidepipe.estimation.track import Track
from slidepipe.mechanics.planar import relative_pose
from slidepipe.series import BoolArray, FloatArray, FrameSeries, IntArray

FEWEST_FRAMES = 30


@dataclass(frozen=True, slots=True)
class Tracks:
    """Everything that moves, on the stamps of the camera frames.

    Attributes
    ----------
    stamp_ns : (T,) int
        Mid-exposure on the host's clock.
    hand, object : Track
        {f} and {b} in {w}.
    relative : Track
        r_f_b: {f} in {b}, where both were seen in one frame.
    spikes : int
        Poses that were left out because they lie far from the motion of their neighbours.
    """

    stamp_ns: IntArray
    hand: Track
    object: Track
    relative: Track
    spikes: int

    @property
    def time_s(self) -> FloatArray:
        """(T,) seconds since the first frame."""
        return np.asarray((self.stamp_ns - self.stamp_ns[0]) * 1e-9)


def align(
    frames: FrameSeries, stamp_ns: IntArray, hand: PlanarBody, body: PlanarBody, relative_angle_rad: float
) -> Tracks:
    """Put both bodies on the camera frames and take their relative pose frame by frame.

    Parameters
    ----------
    stamp_ns : (T,)
        Host time of each frame.
    relative_angle_rad : float
        The first relative angle is reported within pi of this.

    Raises
    ------
    InputError
        Frames out of order, poses of unknown frames.
    EstimationError
        Too few frames with the hand or the object in them.
    """
    _check(frames)
    hand_track = _track("hand", frames.frame, frames.hand_valid, hand)
    object_track = _track("object", frames.frame, frames.object_valid, body)
    time_s = np.asarray((stamp_ns - stamp_ns[0]) * 1e-9)
    spikes = [without_outliers(time_s, track) for track in (hand_track, object_track)]
    valid = spikes[0].valid & spikes[1].valid
    relative = np.where(valid[:, None], relative_pose(spikes[1].pose, spikes[0].pose), 0.0)
    for name, seen in (("hand", spikes[0].valid), ("object", spikes[1].valid), ("hand and object together", valid)):
        if np.count_nonzero(seen) < FEWEST_FRAMES:
            raise EstimationError(
                f"poses: {name} tracked in {np.count_nonzero(seen)} of {len(seen)} frames, "
                f"at least {FEWEST_FRAMES} are needed"
            )
    first = np.median(relative[valid][:FEWEST_FRAMES, 2])
    relative[valid, 2] -= 2.0 * np.pi * np.round((first - relative_angle_rad) / (2.0 * np.pi))
    lost = sum(
        int(np.count_nonzero(a.valid) - np.count_nonzero(b.valid))
        for a, b in zip((hand_track, object_track), spikes, strict=True)
    )
    return Tracks(stamp_ns, spikes[0], spikes[1], Track(relative, valid), lost)


def _track(name: str, frame: IntArray, seen: BoolArray, body: PlanarBody) -> Track:
    row = np.searchsorted(frame, body.sequence)
    known = (row < len(frame)) & (frame[np.minimum(row, len(frame) - 1)] == body.sequence)
    if not known.all():
        raise InputError(f"{name} poses: frame {body.sequence[~known][0]} is not among the recorded frames")
    row = row[seen[row]]
    pose, valid = np.zeros((len(frame), 3)), np.zeros(len(frame), dtype=bool)
    pose[row] = body.pose[np.searchsorted(body.sequence, frame[row])]
    valid[row] = True
    return Track(pose, valid)


def _check(frames: FrameSeries) -> None:
    count = len(frames.frame)
    if count < FEWEST_FRAMES:
        raise EstimationError(f"poses: {count} camera frames were recorded, at least {FEWEST_FRAMES} are needed")
    for name in ("ticks", "received_ns", "hand_valid", "object_valid"):
        if len(getattr(frames, name)) != count:
            raise InputError(f"camera frames: {name} has {len(getattr(frames, name))} entries, must have {count}")
    for name in ("frame", "ticks"):
        back = np.flatnonzero(np.diff(getattr(frames, name)) <= 0)
        if len(back):
            raise InputError(f"camera frames: {name} goes back after frame {frames.frame[back[0]]}; it must increase")
