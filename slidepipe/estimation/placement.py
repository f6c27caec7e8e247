"""What friction hangs on of where the finger is on the hand: a calibration knows it to some deviation only."""

import numpy as np
from scipy.interpolate import BSpline

from slidepipe.estimation.joint_fit import TAIL, JointFit
from slidepipe.estimation.stage_kernel import PHYSICS, START
from slidepipe.estimation.weak_form import SlideWindow
from slidepipe.series import FloatArray


def placement_leverage(fit: JointFit, window: SlideWindow) -> FloatArray:
    """(P, 3) change of a fit's parameters for each m along x and y, and rad, by which {f} is elsewhere on the hand.

    To first order: the measured hand moves, and the parameters with it as far as the fit listens to each pose.
    """
    count = (len(fit.z) - START - PHYSICS) // 3
    closes = fit.first_knot_s + fit.knot_s * (count - 3)
    rows = np.flatnonzero((window.time_s >= fit.first_knot_s) & (window.time_s <= closes) & window.hand.valid)
    knots = fit.first_knot_s + fit.knot_s * (np.arange(count + 4) - 3)
    inside = np.clip(window.time_s[rows], fit.first_knot_s, np.nextafter(closes, fit.first_knot_s))
    basis = BSpline.design_matrix(inside, knots, 3).toarray()
    measured, noise = window.hand.pose[rows], window.hand_smooth.noise
    away = (basis @ fit.z[: 3 * count].reshape(3, count).T - measured) / noise
    weight = (TAIL + 3.0) / (TAIL + np.sum(away**2, axis=1))
    moved = _moved(measured[:, 2]) * weight[:, None, None]
    pull = np.zeros((len(fit.z), 3))
    for axis in range(3):
        pull[axis * count : (axis + 1) * count] = basis.T @ moved[:, axis] / noise[axis] ** 2
    return np.asarray(fit.covariance @ pull)


def _moved(theta: FloatArray) -> FloatArray:
    """(T, 3, 3) change of a measured pose for each m along x and y of {f}, and rad."""
    c, s, zero = np.cos(theta), np.sin(theta), np.zeros_like(theta)
    rows = [[c, -s, zero], [s, c, zero], [zero, zero, zero + 1.0]]
    return np.moveaxis(np.array(rows), 2, 0)
