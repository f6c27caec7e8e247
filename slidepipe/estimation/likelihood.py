"""Process noise of the constant-acceleration model by maximum likelihood, one axis at a time.

The filter here is the three-state Kalman filter written out in scalars, because the search runs it many times; a test
holds it to filterpy's likelihood.
"""

from dataclasses import dataclass
from math import log, pi

import numpy as np
from scipy.optimize import minimize_scalar

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
    step = np.diff(time_s[valid], prepend=time_s[valid][:1]).tolist()
    measured = (value[valid] - value[valid][0]).tolist()

    def cost(exponent: float) -> float:
        return -log_likelihood(step, measured, model, 10.0**exponent)

    found = minimize_scalar(cost, bounds=(model.lowest, model.highest), method="bounded", options={"xatol": 0.05})
    return float(10.0**found.x)


def log_likelihood(step_s: list[float], measured: list[float], model: AxisModel, q: float) -> float:
    """Logarithm of the probability density of the measurements; a gap is simply a longer step.

    Parameters
    ----------
    step_s : list of float
        Time since the measurement before; zero for the first.
    measured : list of float
        Measurements, the first near zero.
    q : float
        Spectral density of the jerk.
    """
    r = model.noise**2
    p, v, a = 0.0, 0.0, 0.0
    pp, pv, pa, vv, va, aa = r, 0.0, 0.0, model.speed**2, 0.0, model.acceleration**2
    total = 0.0
    for h, z in zip(step_s, measured, strict=True):
        half = 0.5 * h * h
        p, v = p + h * v + half * a, v + h * a
        pa_, va_ = pa + h * va + half * aa, va + h * aa
        pv_ = pv + h * vv + half * va + h * (pa + h * va + half * aa)
        pp += 2.0 * h * pv + 2.0 * half * pa + h * h * vv + 2.0 * h * half * va + half * half * aa + q * h**5 / 20.0
        vv += 2.0 * h * va + h * h * aa + q * h**3 / 3.0
        pv, pa, va = pv_ + q * h**4 / 8.0, pa_ + q * h**3 / 6.0, va_ + q * half
        aa += q * h
        s, y = pp + r, z - p
        total -= 0.5 * (y * y / s + log(2.0 * pi * s))
        gp, gv, ga = pp / s, pv / s, pa / s
        p, v, a = p + gp * y, v + gv * y, a + ga * y
        vv, va, aa = vv - gv * pv, va - gv * pa, aa - ga * pa
        pp, pv, pa = pp - gp * pp, pv - gp * pv, pa - gp * pa
    return total
