"""Relative pose while the hand rests, before and after the motion; and whether the object is still there."""

from dataclasses import dataclass

import numpy as np

from slidepipe.estimation.poses import Tracks
from slidepipe.estimation.track import Track
from slidepipe.series import BoolArray, FloatArray

FEWEST_FRAMES = 10
LOST_DISTANCE_M = 0.15
MOVING_SPEED_M_S = 0.005
MOVING_SPEED_RAD_S = 0.1
TRACKED_SHARE = 0.2
OUTLIER = 5.0


@dataclass(frozen=True, slots=True)
class RestPose:
    """r_f_b over a rest segment.

    Attributes
    ----------
    pose : (3,)
        Mean of ``[x, y, theta]`` of {f} in {b}, m and rad, without outliers.
    sd : (3,)
        Standard deviation of that mean.
    scatter : (3,)
        Standard deviation of one frame.
    velocity : (3,)
        Slope over the segment, per s.
    frames_used, outliers : int
        Frames that went into the mean, and frames that were left out of it.
    """

    pose: FloatArray
    sd: FloatArray
    scatter: FloatArray
    velocity: FloatArray
    frames_used: int
    outliers: int


@dataclass(frozen=True, slots=True)
class RestFinding:
    """A rest pose, or the reason why there is none."""

    rest: RestPose | None
    reason: str | None


def find_rest(tracks: Tracks, segment: BoolArray, when: str) -> RestFinding:
    """Mean relative pose over a segment in which the hand rests, or why the object has none there.

    Parameters
    ----------
    segment : (T,) bool
        Frames of the segment.
    when : str
        Words for the segment, for the reason.
    """
    frames = int(np.count_nonzero(segment))
    seen = int(np.count_nonzero(tracks.object.valid & segment))
    if frames == 0 or seen < TRACKED_SHARE * frames:
        return RestFinding(None, f"the object is lost: it was tracked in {seen} of {frames} frames {when}")
    usable = tracks.relative.valid & segment
    if np.count_nonzero(usable) < FEWEST_FRAMES:
        return RestFinding(
            None,
            f"hand and object were tracked together in {np.count_nonzero(usable)} frames {when}, "
            f"at least {FEWEST_FRAMES} are needed",
        )
    rest = rest_pose(tracks.time_s, tracks.relative, usable)
    reason = _gone(rest, when)
    return RestFinding(None if reason else rest, reason)


def rest_pose(time_s: FloatArray, relative: Track, segment: BoolArray) -> RestPose:
    """Mean of the relative pose over the valid frames of a segment, gross outliers (5 sigma of the median) left out.

    Examples
    --------
    >>> poses = np.tile([0.01, 0.02, 3.0], (20, 1))
    >>> poses[7] = [5.0, 5.0, 5.0]
    >>> rest = rest_pose(np.arange(20) / 360, Track(poses, np.ones(20, bool)), np.ones(20, bool))
    >>> rest.pose.round(6), rest.outliers
    (array([0.01, 0.02, 3.  ]), 1)
    """
    rows = np.flatnonzero(relative.valid & segment)
    away = np.abs(relative.pose[rows] - np.median(relative.pose[rows], axis=0))
    spread = np.maximum(np.median(away, axis=0) / 0.6745, 1e-9)
    kept = rows[np.all(away <= OUTLIER * spread, axis=1)]
    values, since = relative.pose[kept], time_s[kept] - time_s[kept].mean()
    scatter = values.std(axis=0, ddof=1)
    return RestPose(
        pose=values.mean(axis=0),
        sd=scatter / np.sqrt(len(kept)),
        scatter=scatter,
        velocity=since @ values / (since @ since),
        frames_used=len(kept),
        outliers=len(rows) - len(kept),
    )


def _gone(rest: RestPose, when: str) -> str | None:
    distance = float(np.hypot(rest.pose[0], rest.pose[1]))
    if distance > LOST_DISTANCE_M:
        return f"the object is lost: {distance:.3f} m from the hand {when}, more than {LOST_DISTANCE_M} m"
    speed, spin = float(np.hypot(rest.velocity[0], rest.velocity[1])), float(abs(rest.velocity[2]))
    if speed > MOVING_SPEED_M_S or spin > MOVING_SPEED_RAD_S:
        return f"the object still moves in the hand {when}: {speed:.4f} m/s and {spin:.3f} rad/s"
    return None
