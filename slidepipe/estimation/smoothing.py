"""Smoothed poses, velocities and accelerations with their variances: a Kalman filter and RTS smoother, compiled.

The same answer as filterpy's, which :mod:`slidepipe.estimation.reference` keeps, several hundred times as fast.
"""

from dataclasses import dataclass

import numpy as np

from slidepipe.estimation.likelihood import AxisModel, best_process_noise
from slidepipe.estimation.smoothing_kernel import smooth_kernel
from slidepipe.estimation.track import Track
from slidepipe.series import BoolArray, FloatArray

LINEAR_NOISE_FLOOR_M = 2e-5
ANGULAR_NOISE_FLOOR_RAD = 2e-4


@dataclass(frozen=True, slots=True)
class SmoothedSeries:
    """Planar motion of one thing at every camera frame, gaps bridged; ``(T, 3)`` each, ``[x, y, theta]``.

    Attributes
    ----------
    pose, velocity, acceleration : (T, 3)
        m and rad, per s, per s^2.
    pose_sd, velocity_sd, acceleration_sd : (T, 3)
        Their standard deviations.
    noise : (3,)
        Standard deviation of one measurement, m and rad, from the rest segments.
    process_noise : (3,)
        Spectral density of the jerk by maximum likelihood, m^2/s^5 and rad^2/s^5.
    consistency : (3,)
        Mean of the lively frames' innovations squared over their variances (NIS); one where the model holds.
    """

    pose: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    pose_sd: FloatArray
    velocity_sd: FloatArray
    acceleration_sd: FloatArray
    noise: FloatArray
    process_noise: FloatArray
    consistency: FloatArray


def rest_noise(track: Track, at_rest: BoolArray) -> FloatArray:
    """(3,) noise of one pose from the differences of neighbours at rest, m and rad.

    Differences do not see a slow creep; those beyond four of their robust sigmas are outliers and stay out. Not below
    0.02 mm and 0.2 mrad: no model of a real contact is better than that, however quiet the cameras are.
    """
    rows = np.flatnonzero(track.valid & at_rest)
    steps = np.diff(track.pose[rows], axis=0)[np.diff(rows) == 1]
    floor = np.array([LINEAR_NOISE_FLOOR_M, LINEAR_NOISE_FLOOR_M, ANGULAR_NOISE_FLOOR_RAD])
    if not len(steps):
        return floor
    sigma = np.median(np.abs(steps), axis=0) / 0.6745
    clean = np.all(np.abs(steps) <= 4.0 * np.maximum(sigma, 1e-12), axis=1)
    return np.asarray(np.maximum(np.sqrt(np.mean(steps[clean] ** 2, axis=0) / 2.0), floor))


def smooth(time_s: FloatArray, track: Track, noise: FloatArray, lively: BoolArray) -> SmoothedSeries:
    """Smooth the three axes of a track, each with its own process noise.

    The process noise is the most likely one of the lively frames alone: a long rest would make it too small for them.

    Parameters
    ----------
    time_s : (T,)
        Stamps of all frames, also of those without a measurement.
    track : Track
        What was measured; the thing starts at rest.
    noise : (3,)
        Standard deviation of a measurement.
    lively : (T,) bool
        Frames in which the thing moves.
    """
    axes, densities = [], []
    for axis in range(3):
        value, model = track.pose[:, axis], axis_model(axis, float(noise[axis]))
        density = best_process_noise(time_s, value, track.valid & lively, model)
        axes.append(smooth_axis(time_s, value, track.valid, model, density))
        densities.append(density)
    state = np.stack([axis.state for axis in axes], axis=1)
    sd = np.stack([axis.sd for axis in axes], axis=1)
    return SmoothedSeries(
        pose=state[..., 0],
        velocity=state[..., 1],
        acceleration=state[..., 2],
        pose_sd=sd[..., 0],
        velocity_sd=sd[..., 1],
        acceleration_sd=sd[..., 2],
        noise=np.asarray(noise),
        process_noise=np.array(densities),
        consistency=np.array([_mean(axis.nis[lively]) for axis in axes]),
    )


def _mean(values: FloatArray) -> float:
    known = values[np.isfinite(values)]
    return float(np.mean(known)) if len(known) else 0.0


@dataclass(frozen=True, slots=True)
class SmoothedAxis:
    """One axis.

    Attributes
    ----------
    state, sd : (T, 3)
        Position, velocity and acceleration, and their standard deviations.
    nis : (T,)
        Innovations squared over their variances; NaN in a gap.
    """

    state: FloatArray
    sd: FloatArray
    nis: FloatArray


def smooth_axis(
    time_s: FloatArray, value: FloatArray, valid: BoolArray, model: AxisModel, density: float, *, period: float = 0.0
) -> SmoothedAxis:
    """Filter and smooth one axis over uneven stamps and gaps.

    Parameters
    ----------
    time_s, value, valid : (T,)
        Stamps of all rows, measurements, and where there is one.
    density : float
        Spectral density of the jerk.
    period : float
        2 pi for an angle that wraps: a measurement is taken by the turn that is nearest to its prediction.
    """
    first = value[valid][0]
    start = np.array([model.noise**2, model.speed**2, model.acceleration**2])
    steps = np.diff(time_s, prepend=time_s[:1])
    state, variance, nis = smooth_kernel(
        steps, value - first, valid, np.zeros(3), start, model.noise**2, density, period
    )
    state[:, 0] += first
    return SmoothedAxis(state, np.sqrt(np.maximum(variance, 0.0)), nis)


def axis_model(axis: int, noise: float) -> AxisModel:
    """Model of one axis of a planar pose, the third an angle."""
    if axis < 2:
        return AxisModel(noise, speed=0.1, acceleration=1.0, lowest=-3.0, highest=6.0)
    return AxisModel(noise, speed=1.0, acceleration=10.0, lowest=-1.0, highest=8.0)
