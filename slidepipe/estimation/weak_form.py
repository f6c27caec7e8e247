"""Friction from the sliding phase without accelerations: the equation of motion against smooth test functions.

A test function psi vanishes with its first derivative at both ends of the window, so integrating by parts twice moves
both derivatives from the noisy pose to psi::

    int psi q'' dt = int psi'' q dt = kappa int psi phi dt + int psi g dt

with phi the direction of friction per unit of kappa (eq. 14, and eq. 15 for the moment).
"""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Polynomial

from slidepipe.estimation.smoothing import SmoothedSeries
from slidepipe.estimation.track import Track
from slidepipe.mechanics.dynamics import GRAVITY, Block
from slidepipe.mechanics.planar import rotation
from slidepipe.series import BoolArray, FloatArray

BUMP_FUNCTIONS = 4
LOCAL_DEGREE = 5


@dataclass(frozen=True, slots=True)
class SlideWindow:
    """What the friction fits look at: measured and smoothed poses, and the frames of the window.

    Attributes
    ----------
    time_s : (T,)
        Stamps of all frames.
    hand, object : Track
        Measured {f} and {b} in {w}.
    hand_smooth, object_smooth, relative_smooth : SmoothedSeries
        Their smoothed series, and that of r_f_b.
    inside : (T,) bool
        Frames in which the object certainly slides; one stretch.
    usable : (T,) bool
        Frames in which the contact is on the object and the object was seen lately.
    """

    time_s: FloatArray
    hand: Track
    object: Track
    hand_smooth: SmoothedSeries
    object_smooth: SmoothedSeries
    relative_smooth: SmoothedSeries
    inside: BoolArray
    usable: BoolArray


@dataclass(frozen=True, slots=True)
class WeakFit:
    """kappa = mu f_N / m by the weak form, m/s^2, and its standard deviation from the object's pose noise alone."""

    kappa: float
    sd: float


def friction_direction(window: SlideWindow, block: Block, rho_m: float) -> FloatArray:
    """(T, 3) acceleration of the object per unit of kappa, in {w}: Gamma of eq. (14) over mu f_N, and its moment.

    It comes from the smoothed relative motion, so it is only good where the object slides.
    """
    sliding = window.relative_smooth.velocity * [1.0, 1.0, rho_m]
    size = np.maximum(np.linalg.norm(sliding, axis=1, keepdims=True), 1e-9)
    unit = np.einsum("tij,tj->ti", rotation(window.object_smooth.pose[:, 2]), sliding / size)
    offset = np.einsum("tij,tj->ti", rotation(window.object_smooth.pose[:, 2]), window.relative_smooth.pose)
    moment = rho_m * unit[:, 2] + offset[:, 0] * unit[:, 1] - offset[:, 1] * unit[:, 0]
    return np.stack([unit[:, 0], unit[:, 1], moment * block.m / block.inertia], axis=1)


def weak_fit(window: SlideWindow, block: Block, rho_m: float) -> WeakFit:
    """Generalised least squares of the three equations of motion against the test functions, for kappa alone."""
    direction = friction_direction(window, block, rho_m)
    noise = window.object_smooth.noise
    information, score = 0.0, 0.0
    for axis, gravity in enumerate((0.0, -GRAVITY, 0.0)):
        left, right, covariance = _axis_equations(window, direction[:, axis], axis, gravity)
        weight = np.linalg.inv(covariance * noise[axis] ** 2)
        information += float(right @ weight @ right)
        score += float(right @ weight @ left)
    return WeakFit(score / information, information**-0.5)


def _axis_equations(
    window: SlideWindow, direction: FloatArray, axis: int, gravity: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """``int psi q'' - int psi g``, ``int psi phi`` and the covariance of the first per unit of pose variance.

    The pose is split into a local polynomial, whose acceleration is integrated exactly, and a small rest: only the
    rest meets the quadrature on uneven stamps.
    """
    rows = np.flatnonzero(window.inside)
    seen = rows[window.object.valid[rows]]
    span = (window.time_s[rows[0]], window.time_s[rows[-1]])
    local = Polynomial.fit(window.time_s[seen], window.object.pose[seen, axis], LOCAL_DEGREE, domain=span)
    rest = window.object.pose[seen, axis] - local(window.time_s[seen])
    curved = bump_functions(window.time_s[seen], span, derivative=2) * quadrature_weights(window.time_s[seen], span)
    fine = np.linspace(*span, 400)
    tests = bump_functions(fine, span, derivative=0) * quadrature_weights(fine, span)
    left = curved @ rest + tests @ (local.deriv(2)(fine) - gravity)
    right = tests @ np.interp(fine, window.time_s, direction)
    return left, right, curved @ curved.T


def bump_functions(time_s: FloatArray, span: tuple[float, float], *, derivative: int) -> FloatArray:
    """(K, T) test functions ``(1 - s^2)^3 s^k`` on ``s`` in [-1, 1], or a derivative of them by time.

    Examples
    --------
    >>> bump_functions(np.array([0.0, 0.5, 1.0]), (0.0, 1.0), derivative=0)[0]
    array([0., 1., 0.])
    """
    half = (span[1] - span[0]) / 2.0
    s = (np.asarray(time_s) - span[0]) / half - 1.0
    bump = Polynomial([1.0, 0.0, -1.0]) ** 3
    powers = [Polynomial([0.0] * k + [1.0]) for k in range(BUMP_FUNCTIONS)]
    return np.stack([(bump * power).deriv(derivative)(s) if derivative else (bump * power)(s) for power in powers]) / (
        half**derivative
    )


def quadrature_weights(time_s: FloatArray, span: tuple[float, float]) -> FloatArray:
    """(T,) weights of the trapezoidal rule over a span, uneven stamps allowed; the ends reach to the span's.

    Examples
    --------
    >>> quadrature_weights(np.array([0.0, 1.0, 3.0]), (0.0, 3.0))
    array([0.5, 1.5, 1. ])
    """
    edges = np.concatenate([[span[0]], (time_s[1:] + time_s[:-1]) / 2.0, [span[1]]])
    return np.asarray(np.diff(edges))
