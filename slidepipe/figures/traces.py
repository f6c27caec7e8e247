"""Series of planar poses made ready to be drawn."""

import numpy as np

from slidepipe.errors import InputError
from slidepipe.series import FloatArray

GAP = 4.0
"""A line is broken where samples are further apart than so many of their usual intervals."""


def check_poses(name: str, time_s: FloatArray, poses: FloatArray, *, at_least: int = 0) -> None:
    """Make sure that a series is one pose for each time, and of so many at least.

    Raises
    ------
    InputError
        The shapes do not belong together, or there are too few.
    """
    if np.ndim(time_s) != 1 or np.shape(poses) != (len(time_s), 3):
        raise InputError(
            f"figure: {name} must be one pose (x, y, theta) for each time, got {np.shape(poses)} for {np.shape(time_s)}"
        )
    if len(time_s) < at_least:
        raise InputError(f"figure: {name} must have {at_least} poses at least, got {len(time_s)}")


def near(poses: FloatArray, reference: FloatArray) -> FloatArray:
    """Poses whose angle runs without jumps and begins in the same turn as the reference.

    Parameters
    ----------
    poses, reference : (T, 3), (K, 3)
        Angles in rad in the last column; NaN where there is none.

    Examples
    --------
    >>> near(np.array([[0.0, 0.0, -3.1], [0.0, 0.0, 3.1]]), np.array([[0.0, 0.0, 3.0]]))[:, 2].round(2)
    array([3.18, 3.1 ])
    """
    result = np.array(poses, dtype=float)
    known = np.isfinite(result[:, 2])
    if known.any() and len(reference):
        angle = np.unwrap(result[known, 2])
        angle += 2.0 * np.pi * np.round((reference[0, 2] - angle[0]) / (2.0 * np.pi))
        result[known, 2] = angle
    return result


def turned(poses: FloatArray, angle_rad: float) -> FloatArray:
    """Poses with the whole turns added to their angles that come nearest to an angle.

    Examples
    --------
    >>> turned(np.zeros((1, 3)), 6.0)[0, 2].round(2)
    np.float64(6.28)
    """
    whole = 2.0 * np.pi * np.round(angle_rad / (2.0 * np.pi))
    return np.asarray(poses + np.array([0.0, 0.0, whole]))


def broken(time_s: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return times and values with a NaN wherever samples are missing, so that no line is drawn across.

    Examples
    --------
    >>> broken(np.array([0.0, 1.0, 2.0, 9.0]), np.ones(4))[1]
    array([ 1.,  1.,  1., nan,  1.])
    """
    steps = np.diff(time_s)
    if not len(steps):
        return time_s, values
    gaps = np.flatnonzero(steps > GAP * np.median(steps)) + 1
    return np.insert(time_s, gaps, time_s[gaps - 1]), np.insert(values, gaps, np.nan)
