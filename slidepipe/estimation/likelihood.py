"""Process noise of the constant-acceleration model by maximum likelihood, one axis at a time."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar

from slidepipe.estimation.smoothing_kernel import likelihood_kernel
from slidepipe.series import BoolArray, FloatArray


@dataclass(frozen=True, slots=True)
class AxisModel:
    """Constant acceleration driven by white jerk, seen through white noise.

    Attributes
    ----------
    noise : float
        Standard deviation of a measurement, m or rad.
    speed, acceleration : float
        Standard deviations of the unknown first velocity and acceleration, per s and per s^2.
    lowest, highest : float
        Bounds of log10 of the jerk's spectral density, (m or rad)^2/s^5.
    """

    noise: float
    speed: float
    acceleration: float
    lowest: float
    highest: float


def best_process_noise(time_s: FloatArray, value: FloatArray, valid: BoolArray, model: AxisModel) -> float:
    """Spectral density of the jerk that makes the measurements most likely, (m or rad)^2/s^5.

    Parameters
    ----------
    time_s, value, valid : (T,)
        Stamps, measurements and where there is one.
    """
    step = np.diff(time_s[valid], prepend=time_s[valid][:1])
    measured = value[valid] - value[valid][0]

    def cost(exponent: float) -> float:
        return -log_likelihood(step, measured, model, 10.0**exponent)

    found = minimize_scalar(cost, bounds=(model.lowest, model.highest), method="bounded", options={"xatol": 0.05})
    return float(10.0**found.x)


def log_likelihood(step_s: FloatArray, measured: FloatArray, model: AxisModel, q: float) -> float:
    """Logarithm of the probability density of the measurements; a gap is simply a longer step.

    Parameters
    ----------
    step_s : (T,)
        Time since the measurement before; zero for the first.
    measured : (T,)
        Measurements, the first near zero.
    q : float
        Spectral density of the jerk.
    """
    start = np.array([model.noise**2, model.speed**2, model.acceleration**2])
    return float(likelihood_kernel(step_s, measured, np.zeros(3), start, model.noise**2, q))
