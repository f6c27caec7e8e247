"""The same smoothing by ours and by its peers: three axes, evenly spaced, gaps, states and standard deviations."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from slidepipe.estimation.likelihood import AxisModel
from slidepipe.estimation.reference import jerk_covariance, reference_smooth_axis, transition
from slidepipe.estimation.smoothing import smooth_axis
from slidepipe.series import BoolArray, FloatArray

RATE_HZ = 360.0
DENSITY = 1e3
GAP_SHARE = 0.05
MODEL = AxisModel(noise=3e-4, speed=0.1, acceleration=1.0, lowest=-3.0, highest=6.0)


@dataclass(frozen=True, slots=True)
class Data:
    """(T,) stamps, (T, 3) measurements with NaN in the gaps, (T,) where there is one."""

    time_s: FloatArray
    value: FloatArray
    valid: BoolArray

    @classmethod
    def of(cls, count: int) -> "Data":
        """A hand that waves, and cameras that lose it at times."""
        rng = np.random.default_rng(count)
        time_s = np.arange(count) / RATE_HZ
        path = np.stack([0.2 * np.sin(5 * time_s), 0.1 * np.cos(7 * time_s), 0.3 * np.sin(3 * time_s)], axis=1)
        value = path + rng.normal(size=path.shape) * MODEL.noise
        valid = rng.uniform(size=count) > GAP_SHARE
        valid[0] = True
        return cls(time_s, np.where(valid[:, None], value, np.nan), valid)


@dataclass(frozen=True, slots=True)
class Answer:
    """(T, 3, 3): position, velocity and acceleration of each axis, and their standard deviations."""

    state: FloatArray
    sd: FloatArray


def ours(data: Data) -> Answer:
    """Smooth by the compiled smoother of this project."""
    return _by_axis(data, smooth_axis)


def filterpy(data: Data) -> Answer:
    """Smooth by KalmanFilter and its rts_smoother."""
    return _by_axis(data, reference_smooth_axis)


def statsmodels(data: Data) -> Answer:
    """Smooth by the state space smoother."""
    from statsmodels.tsa.statespace.kalman_smoother import KalmanSmoother  # noqa: PLC0415 - may be missing

    states, variances = [], []
    for value in _from_first(data).T:
        smoother = KalmanSmoother(k_endog=1, k_states=3)
        smoother.bind(value.copy())
        smoother["design"], smoother["obs_cov"] = H, [[MODEL.noise**2]]
        smoother["transition"], smoother["selection"], smoother["state_cov"] = _F(), np.eye(3), _Q()
        smoother.initialize_known(np.zeros(3), P0)
        told = smoother.smooth()
        states.append(told.smoothed_state.T)
        variances.append(np.diagonal(told.smoothed_state_cov).copy())
    return _answer(data, states, variances)


def pykalman(data: Data) -> Answer:
    """Smooth by KalmanFilter.smooth."""
    from pykalman import KalmanFilter  # noqa: PLC0415 - may be missing

    states, variances = [], []
    for value in _from_first(data).T:
        smoother = KalmanFilter(
            _F(), H, _Q(), [[MODEL.noise**2]], initial_state_mean=np.zeros(3), initial_state_covariance=P0
        )
        state, covariance = smoother.smooth(np.ma.masked_invalid(value[:, None]))
        states.append(state)
        variances.append(np.diagonal(covariance, axis1=1, axis2=2))
    return _answer(data, states, variances)


def simdkalman(data: Data) -> Answer:
    """Smooth the three axes at once."""
    from simdkalman import KalmanFilter  # noqa: PLC0415 - may be missing

    smoother = KalmanFilter(_F(), _Q(), H, np.array([[MODEL.noise**2]]))
    told = smoother.smooth(_from_first(data).T, initial_value=np.zeros(3), initial_covariance=P0, observations=False)
    return _answer(data, list(told.states.mean), list(np.diagonal(told.states.cov, axis1=2, axis2=3)))


PEERS: dict[str, Callable[[Data], Answer]] = {
    "filterpy": filterpy,
    "statsmodels": statsmodels,
    "pykalman": pykalman,
    "simdkalman": simdkalman,
}
H = np.array([[1.0, 0.0, 0.0]])
P0 = np.diag([MODEL.noise**2, MODEL.speed**2, MODEL.acceleration**2])


def _F() -> FloatArray:
    return np.asarray(transition(np.array([1.0 / RATE_HZ]))[0])


def _Q() -> FloatArray:
    return np.asarray(DENSITY * jerk_covariance(np.array([1.0 / RATE_HZ]))[0])


def _from_first(data: Data) -> FloatArray:
    return data.value - data.value[0]


def _by_axis(data: Data, smooth: Callable[..., object]) -> Answer:
    axes = [smooth(data.time_s, value, data.valid, MODEL, DENSITY) for value in data.value.T]
    return Answer(np.stack([axis.state for axis in axes], 1), np.stack([axis.sd for axis in axes], 1))


def _answer(data: Data, states: list[FloatArray], variances: list[FloatArray]) -> Answer:
    state = np.stack(states, axis=1)
    state[..., 0] += data.value[0]
    return Answer(state, np.sqrt(np.stack(variances, axis=1)))
