"""Poses of the hand and the object that another tool recorded, before they become a trial."""

from dataclasses import dataclass

import numpy as np

from slidepipe.errors import InputError
from slidepipe.series import FloatArray, IntArray

SAME_FRAME_SHARE = 0.05
"""Stamps nearer than this share of the frames' period belong to one frame; the bodies hardly move meanwhile."""


@dataclass(frozen=True, slots=True)
class SeenBody:
    """A body where it was seen: (T,) stamps in ns and (T, 7) positions in m and quaternions x y z w."""

    name: str
    stamp_ns: IntArray
    pose: FloatArray


@dataclass(frozen=True, slots=True)
class Sighting:
    """Frames in which the hand, the object, both or none were seen; what was not seen is NaN.

    Attributes
    ----------
    source : str
        Where they come from.
    stamp_ns : (T,) int
        Time of each frame on the recorder's clock, increasing.
    frame : (T,) int
        Numbers of the frames, increasing.
    hand, object : (T, 7)
        Positions in m and quaternions x y z w in the cameras' frame.
    """

    source: str
    stamp_ns: IntArray
    frame: IntArray
    hand: FloatArray
    object: FloatArray


def in_frames(source: str, hand: SeenBody, thing: SeenBody) -> Sighting:
    """Put two bodies that were stamped apart into common frames.

    Raises
    ------
    InputError
        One was hardly seen, or the two were never stamped alike: poses of different moments make no relative pose.
    """
    for body in (hand, thing):
        if len(body.stamp_ns) < 2:
            raise InputError(f"{source}: {body.name}: {len(body.stamp_ns)} poses are too few")
    stamps = np.unique(np.concatenate([hand.stamp_ns, thing.stamp_ns]))
    period_ns = float(np.median(np.diff(np.unique(hand.stamp_ns))))
    first = np.concatenate([[True], np.diff(stamps) > SAME_FRAME_SHARE * period_ns])
    frame_of = np.cumsum(first) - 1
    count = int(frame_of[-1]) + 1
    poses = []
    for body in (hand, thing):
        filled = np.full((count, 7), np.nan)
        filled[frame_of[np.searchsorted(stamps, body.stamp_ns)]] = body.pose
        poses.append(filled)
    if not np.any(np.isfinite(poses[0][:, 0]) & np.isfinite(poses[1][:, 0])):
        raise InputError(
            f"{source}: {hand.name} and {thing.name} are never stamped alike: they must come from one camera frame"
        )
    return Sighting(source, stamps[first], np.arange(count, dtype=np.int64), poses[0], poses[1])
