"""The picture of one estimate, from what the estimator said."""

import numpy as np

from slidepipe.estimation.estimate import Estimate
from slidepipe.estimation.smoothing import SmoothedSeries
from slidepipe.figures.estimated import EstimatePicture, Posterior, Trace
from slidepipe.series import BoolArray, FloatArray

MARGIN_S = 0.15
"""How much of the rests before and after the motion is shown."""


def estimate_picture(told: Estimate, title: str, *, start_ns: int, stop_s: float, believed: float) -> EstimatePicture:
    """Make the picture of an estimate.

    Parameters
    ----------
    start_ns, stop_s : int and float
        When the motion began, on the host's clock, and how long it took.
    believed : float
        Kappa that the planner believed, m/s^2.
    """
    time_s = 1e-9 * (told.tracks.stamp_ns - start_ns).astype(float)
    shown = np.asarray((time_s > -MARGIN_S) & (time_s < stop_s + MARGIN_S))
    zero_s = 1e-9 * (told.host_ns(0.0) - start_ns)
    tracks, friction = told.tracks, told.friction
    return EstimatePicture(
        title=title,
        time_s=time_s[shown],
        traces=(
            _trace("hand in the plane {w}", _seen(tracks.hand.pose, tracks.hand.valid), told.hand, shown),
            _trace("object in the plane {w}", _seen(tracks.object.pose, tracks.object.valid), told.object, shown),
            _trace(
                "finger in the body frame, $r_f^b$",
                _seen(tracks.relative.pose, tracks.relative.valid),
                told.relative,
                shown,
            ),
        ),
        slide_s=None if told.slide is None else (zero_s + told.slide.start_s, zero_s + told.slide.stop_s),
        posterior=None
        if friction is None
        else Posterior(
            value=friction.kappa_m_s2,
            std=friction.kappa_m_s2 * friction.kappa_relative_sd,
            interval_95=(friction.kappa_interval_m_s2.low, friction.kappa_interval_m_s2.high),
            believed=believed,
        ),
        missing_because=told.friction_reason if friction is None else None,
    )


def _trace(title: str, raw: FloatArray, smoothed: SmoothedSeries, shown: BoolArray) -> Trace:
    return Trace(title, raw[shown], smoothed.pose[shown], smoothed.noise)


def _seen(pose: FloatArray, valid: BoolArray) -> FloatArray:
    return np.where(valid[:, None], pose, np.nan)
