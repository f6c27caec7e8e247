"""Gross outliers and swapped markers out of a track: a gate that runs forward and backward, and a second look.

A filter that only runs forward is caught by a swap that lasts: it locks on to the wrong place and then refuses the
right one. A pose is therefore kept where both directions accept it. The smoother over what was kept then decides each
pose once more, from both sides: what a caught filter refused comes back, and what slipped through goes.

The process noise is that of the whole track, most of which is rest. A short and violent motion is more than it allows
for; such a motion is told from a swap by a filter with much more noise, which follows the one and starts at the other.
"""

import numpy as np
from scipy.ndimage import minimum_filter1d, uniform_filter1d

from slidepipe.estimation.likelihood import best_process_noise
from slidepipe.estimation.smoothing import axis_model, smooth_axis
from slidepipe.estimation.smoothing_kernel import gate_kernel
from slidepipe.estimation.track import Track
from slidepipe.series import BoolArray, FloatArray

LIMIT = 27.0
"""Squared distance over variance, three degrees of freedom: one clean pose in 170,000 lies beyond."""
PATIENCE = 30
"""Frames that a filter coasts over before it locks on anew."""
WIDEST = np.array([0.005, 0.005, 0.08])
"""Standard deviation of a prediction that the gate allows for, however long a filter has coasted."""
FLOOR = np.array([2e-5, 2e-5, 2e-4])
LOCK_POSE, LOCK_SPEED, LOCK_ACCELERATION = (
    np.array([0.002, 0.002, 0.02]),
    np.array([1.0, 1.0, 10.0]),
    np.array([20.0, 20.0, 200.0]),
)
SECOND_LOOKS = 3
FIRST_DENSITY = np.array([3e4, 3e4, 3e7])
"""Process noise of the first pass, that of a hand whose acceleration jumps; the second takes the most likely one of
what was kept."""
FEWEST = 30
AROUND, MANY = 11, 0.5
"""Frames about one, and the share of them that is refused together where it is for a motion and not for being wrong."""


def without_outliers(time_s: FloatArray, track: Track) -> Track:
    """The track without the poses that do not belong to its motion; angles run on past pi.

    Parameters
    ----------
    time_s : (T,)
        Stamps of all frames.
    """
    if np.count_nonzero(track.valid) < FEWEST:
        return track
    noise = rough_noise(track)
    loosely = kept = _both_ways(time_s, track, noise, FIRST_DENSITY)
    if np.count_nonzero(kept) >= FEWEST:
        density = _likely_density(time_s, Track(track.pose, kept), noise)
        kept = _with_motion(_both_ways(time_s, track, noise, density), loosely, track.valid)
    if np.count_nonzero(kept) < FEWEST:
        return Track(np.where(kept[:, None], track.pose, 0.0), kept)
    density = _likely_density(time_s, Track(track.pose, kept), noise)
    for _ in range(SECOND_LOOKS):
        if np.count_nonzero(kept) < FEWEST:
            break
        within = track.valid & (_distance(time_s, Track(track.pose, kept), noise, density) <= LIMIT)
        again = _with_motion(within, loosely, track.valid)
        if np.array_equal(again, kept):
            break
        kept = again
    return _unwrapped(Track(track.pose, kept))


def rough_noise(track: Track) -> FloatArray:
    """(3,) noise of one pose from the third differences of neighbours: motion hardly shows in these.

    Examples
    --------
    >>> noise = np.random.default_rng(1).normal(size=(900, 3)) * [3e-4, 3e-4, 3e-3]
    >>> rough_noise(Track(noise + np.linspace(0, 1, 900)[:, None] ** 2, np.ones(900, bool))).round(4)
    array([0.0003, 0.0003, 0.003 ])
    """
    rows = np.flatnonzero(track.valid)
    third = np.diff(track.pose[rows], n=3, axis=0)[rows[3:] - rows[:-3] == 3]
    if not len(third):
        return FLOOR
    return np.asarray(np.maximum(np.median(np.abs(third), axis=0) / (0.6745 * np.sqrt(20.0)), FLOOR))


def _likely_density(time_s: FloatArray, track: Track, noise: FloatArray) -> FloatArray:
    """Process noise (3,) that makes a track's poses most likely."""
    pose, valid = _unwrapped(track).pose, track.valid
    models = [axis_model(axis, float(noise[axis])) for axis in range(3)]
    return np.array([best_process_noise(time_s, pose[:, i], valid, model) for i, model in enumerate(models)])


def _both_ways(time_s: FloatArray, track: Track, noise: FloatArray, density: FloatArray) -> BoolArray:
    lock = np.stack([LOCK_POSE**2, LOCK_SPEED**2, LOCK_ACCELERATION**2], axis=1)
    steps = np.diff(time_s, prepend=time_s[:1])
    back = np.diff(time_s[::-1], prepend=time_s[-1:])
    settings = (lock, noise, density, WIDEST, LIMIT, PATIENCE)
    forward = gate_kernel(steps, track.pose, track.valid, *settings)
    backward = gate_kernel(-back, track.pose[::-1].copy(), track.valid[::-1].copy(), *settings)
    return np.asarray(forward & backward[::-1])


def _with_motion(kept: BoolArray, loosely: BoolArray, valid: BoolArray) -> BoolArray:
    """Kept poses (T,), with those back that were refused with most about them and that a loose gate follows."""
    rows = np.flatnonzero(valid)
    together = uniform_filter1d((~kept[rows]).astype(float), AROUND, mode="nearest") >= MANY
    followed = minimum_filter1d(loosely[rows], AROUND, mode="nearest")
    result = kept.copy()
    result[rows] |= together & followed
    return result


def _distance(time_s: FloatArray, track: Track, noise: FloatArray, density: FloatArray) -> FloatArray:
    """(T,) squared distance over variance of each pose from what the *other* kept poses say of it."""
    total = np.zeros(len(time_s))
    for axis in range(3):
        period = 2.0 * np.pi if axis == 2 else 0.0
        value = track.pose[:, axis]
        smoothed = smooth_axis(
            time_s, value, track.valid, axis_model(axis, float(noise[axis])), float(density[axis]), period=period
        )
        away = value - smoothed.state[:, 0]
        if period:
            away -= period * np.round(away / period)
        own = np.where(track.valid, -1.0, 1.0) * smoothed.sd[:, 0] ** 2
        total += away**2 / np.maximum(noise[axis] ** 2 + own, 1e-3 * noise[axis] ** 2)
    return total


def _unwrapped(track: Track) -> Track:
    pose = np.where(track.valid[:, None], track.pose, 0.0)
    pose[track.valid, 2] = np.unwrap(pose[track.valid, 2])
    return Track(pose, track.valid)
