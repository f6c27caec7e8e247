"""The smoother by filterpy: what the compiled one is held to, in tests and in the benchmark."""

import numpy as np

from slidepipe.estimation.likelihood import AxisModel
from slidepipe.estimation.smoothing import SmoothedAxis
from slidepipe.series import BoolArray, FloatArray


def reference_smooth_axis(
    time_s: FloatArray, value: FloatArray, valid: BoolArray, model: AxisModel, density: float
) -> SmoothedAxis:
    """What :func:`slidepipe.estimation.smoothing.smooth_axis` returns, by filterpy's filter and its smoother method."""
    from filterpy.kalman import KalmanFilter  # noqa: PLC0415 - importing filterpy takes a second

    first = value[valid][0]
    kf = KalmanFilter(dim_x=3, dim_z=1)
    kf.P = np.diag([model.noise**2, model.speed**2, model.acceleration**2])
    kf.H = np.array([[1.0, 0.0, 0.0]])
    kf.R = np.array([[model.noise**2]])
    steps = np.diff(time_s, prepend=time_s[:1])
    F, Q = transition(steps), density * jerk_covariance(steps)
    nis = np.full(len(value), np.nan)
    means, covariances = np.empty((len(value), 3, 1)), np.empty((len(value), 3, 3))
    for row, seen in enumerate(valid):
        kf.predict(F=F[row], Q=Q[row])
        kf.update(np.array([[value[row] - first]]) if seen else None)
        if seen:
            nis[row] = float(kf.y[0, 0] ** 2 / kf.S[0, 0])
        means[row], covariances[row] = kf.x, kf.P
    x, P, _, _ = kf.rts_smoother(means, covariances, Fs=list(F), Qs=list(Q))
    state = x[:, :, 0]
    state[:, 0] += first
    variance = np.diagonal(P, axis1=1, axis2=2)
    return SmoothedAxis(state, np.sqrt(np.maximum(variance, 0.0)), nis)


def transition(step_s: FloatArray) -> FloatArray:
    """(T, 3, 3) transition of constant acceleration over each step.

    Examples
    --------
    >>> transition(np.array([2.0]))[0]
    array([[1., 2., 2.],
           [0., 1., 2.],
           [0., 0., 1.]])
    """
    F = np.tile(np.eye(3), (len(step_s), 1, 1))
    F[:, 0, 1] = F[:, 1, 2] = step_s
    F[:, 0, 2] = step_s**2 / 2.0
    return F


def jerk_covariance(step_s: FloatArray) -> FloatArray:
    """(T, 3, 3) covariance that white jerk of unit density adds over each step (Van Loan's integral, closed form)."""
    h = np.asarray(step_s, dtype=float)[:, None, None]
    power = np.array([[5, 4, 3], [4, 3, 2], [3, 2, 1]])
    divisor = np.array([[20.0, 8.0, 6.0], [8.0, 3.0, 2.0], [6.0, 2.0, 1.0]])
    return np.asarray(h**power / divisor)
