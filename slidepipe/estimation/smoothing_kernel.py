"""The constant-acceleration Kalman filter and its smoother for one axis, written out in scalars.

The backward pass is the modified Bryson-Frazier form of the Rauch-Tung-Striebel smoother: the same answer, without the
inverse of a covariance. Rows without a measurement are predicted through. White jerk of density q drives the axis
(Van Loan's integral in closed form); ``period`` wraps an innovation, zero leaves it.
"""

from math import log, pi

import numpy as np
from numba import njit

FIRST_ROWS = 15
"""That a gate's first lock is on."""


@njit(cache=True, error_model="numpy")
def predict(x, P, h, q):
    """Carry state x (3,) and covariance P (6,: 00 01 02 11 12 22) over a step, in place."""
    g = 0.5 * h * h
    p00, p01, p02, p11, p12, p22 = P[0], P[1], P[2], P[3], P[4], P[5]
    x[0] += h * x[1] + g * x[2]
    x[1] += h * x[2]
    a, b = p01 + h * p11 + g * p12, p02 + h * p12 + g * p22
    c = p12 + h * p22
    P[0] = p00 + h * p01 + g * p02 + h * a + g * b + q * h**5 / 20.0
    P[1] = a + h * b + q * h**4 / 8.0
    P[2] = b + q * h**3 / 6.0
    P[3] = p11 + h * p12 + h * c + q * h**3 / 3.0
    P[4] = c + q * g
    P[5] = p22 + q * h


@njit(cache=True, error_model="numpy")
def correct(x, P, y, R):
    """Take in an innovation y of a measurement of variance R, in place."""
    S = P[0] + R
    k0, k1, k2 = P[0] / S, P[1] / S, P[2] / S
    x[0] += k0 * y
    x[1] += k1 * y
    x[2] += k2 * y
    P[3] -= k1 * P[1]
    P[4] -= k1 * P[2]
    P[5] -= k2 * P[2]
    # Not P - k0 P: after a long gap that would be a difference of giants.
    left = R / S
    P[0] *= left
    P[1] *= left
    P[2] *= left


@njit(cache=True, error_model="numpy")
def wrapped(y, period):
    """Innovation to the nearest turn."""
    if period > 0.0:
        return y - period * np.round(y / period)
    return y


@njit(cache=True, error_model="numpy")
def smooth_kernel(step, value, valid, x0, P0, R, q, period):
    """Filter and smooth one axis.

    ``step`` (T,) is the time since the row before, ``x0`` (3,) and ``P0`` (3,) the first state and its variances before
    the first step, ``R`` the variance of a measurement. Returns states (T, 3), variances (T, 3), and the normalised
    innovations squared (T,), NaN where nothing was measured.
    """
    count = len(step)
    xs, Ps = np.empty((count, 3)), np.empty((count, 6))
    gains, nis = np.zeros((count, 3)), np.full(count, np.nan)
    scores, sizes = np.zeros(count), np.zeros(count)
    x, P = x0.copy(), np.array([P0[0], 0.0, 0.0, P0[1], 0.0, P0[2]])
    for t in range(count):
        predict(x, P, step[t], q)
        if valid[t]:
            y, S = wrapped(value[t] - x[0], period), P[0] + R
            gains[t, 0], gains[t, 1], gains[t, 2] = P[0] / S, P[1] / S, P[2] / S
            scores[t], sizes[t], nis[t] = y / S, 1.0 / S, y * y / S
            correct(x, P, y, R)
        xs[t], Ps[t] = x, P
    states, variances = np.empty((count, 3)), np.empty((count, 3))
    l0, l1, l2 = 0.0, 0.0, 0.0
    a00, a01, a02, a11, a12, a22 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for t in range(count - 1, -1, -1):
        p00, p01, p02, p11, p12, p22 = Ps[t, 0], Ps[t, 1], Ps[t, 2], Ps[t, 3], Ps[t, 4], Ps[t, 5]
        states[t, 0] = xs[t, 0] - (p00 * l0 + p01 * l1 + p02 * l2)
        states[t, 1] = xs[t, 1] - (p01 * l0 + p11 * l1 + p12 * l2)
        states[t, 2] = xs[t, 2] - (p02 * l0 + p12 * l1 + p22 * l2)
        variances[t, 0] = p00 - _square(a00, a01, a02, a11, a12, a22, p00, p01, p02)
        variances[t, 1] = p11 - _square(a00, a01, a02, a11, a12, a22, p01, p11, p12)
        variances[t, 2] = p22 - _square(a00, a01, a02, a11, a12, a22, p02, p12, p22)
        if valid[t]:
            k0, k1, k2 = gains[t, 0], gains[t, 1], gains[t, 2]
            b0 = a00 * k0 + a01 * k1 + a02 * k2
            b1 = a01 * k0 + a11 * k1 + a12 * k2
            b2 = a02 * k0 + a12 * k1 + a22 * k2
            a00 += k0 * b0 + k1 * b1 + k2 * b2 - 2.0 * b0 + sizes[t]
            a01, a02 = a01 - b1, a02 - b2
            l0 -= k0 * l0 + k1 * l1 + k2 * l2 + scores[t]
        h = step[t]
        g = 0.5 * h * h
        l2 += g * l0 + h * l1
        l1 += h * l0
        m01, m02 = h * a00 + a01, g * a00 + h * a01 + a02
        m11, m12 = h * a01 + a11, g * a01 + h * a11 + a12
        m22 = g * a02 + h * a12 + a22
        a22 = g * m02 + h * m12 + m22
        a12, a11 = h * m02 + m12, h * m01 + m11
        a02, a01 = m02, m01
    return states, variances, nis


@njit(cache=True, error_model="numpy")
def _square(a00, a01, a02, a11, a12, a22, u, v, w):
    return u * (a00 * u + 2.0 * (a01 * v + a02 * w)) + v * (a11 * v + 2.0 * a12 * w) + w * w * a22


@njit(cache=True, error_model="numpy")
def likelihood_kernel(step, value, x0, P0, R, q):
    """Logarithm of the probability density of measurements (T,) that all were made."""
    x, P, total = x0.copy(), np.array([P0[0], 0.0, 0.0, P0[1], 0.0, P0[2]]), 0.0
    for t in range(len(step)):
        predict(x, P, step[t], q)
        y, S = value[t] - x[0], P[0] + R
        total -= 0.5 * (y * y / S + log(2.0 * pi * S))
        correct(x, P, y, R)
    return total


@njit(cache=True, error_model="numpy")
def gate_kernel(step, value, seen, P0, noise, q, widest, limit, patience):
    """Accepted rows (T,) of a planar track, in the order of the rows: three filters, one gate.

    A row is accepted where the squared innovations of its three axes, over their variances, add up to at most
    ``limit``; the filters coast over the others, for the gate no wider than ``widest`` (3,). After ``patience`` rows
    in a row were refused they lock on anew. The first lock is on the medians of position and speed of the first rows;
    the third axis is an angle and wraps. ``value`` (T, 3), ``P0`` (3, 3) variances at a lock, ``noise`` and ``q`` (3,).
    """
    count = len(step)
    accepted = np.zeros(count, np.bool_)
    x, P = np.zeros((3, 3)), np.zeros((3, 6))
    time, rows = np.cumsum(step), np.flatnonzero(seen)
    first = rows[: min(len(rows), FIRST_ROWS)]
    centre, speed = np.empty(3), np.zeros(3)
    for axis in range(3):
        period = 2.0 * pi if axis == 2 else 0.0
        rates, since = np.empty(len(first) - 1), np.empty(len(first))
        for i in range(len(first) - 1):
            rise = wrapped(value[first[i + 1], axis] - value[first[i], axis], period)
            rates[i] = rise / (time[first[i + 1]] - time[first[i]])
        speed[axis] = np.median(rates)
        for i in range(len(first)):
            lead = speed[axis] * (time[first[i]] - time[0])
            since[i] = wrapped(value[first[i], axis] - lead - value[first[0], axis], period)
        centre[axis] = value[first[0], axis] + np.median(since)
    _lock(x, P, centre, speed, P0)
    refused = 0
    for t in range(count):
        total = 0.0
        for axis in range(3):
            predict(x[axis], P[axis], step[t], q[axis])
        if not seen[t]:
            continue
        for axis in range(3):
            y = wrapped(value[t, axis] - x[axis, 0], 2.0 * pi if axis == 2 else 0.0)
            total += y * y / (min(P[axis, 0], widest[axis] ** 2) + noise[axis] ** 2)
        if total <= limit:
            refused = 0
        else:
            refused += 1
            if refused <= patience:
                continue
            _lock(x, P, value[t], np.zeros(3), P0)
            refused = 0
        accepted[t] = True
        for axis in range(3):
            y = wrapped(value[t, axis] - x[axis, 0], 2.0 * pi if axis == 2 else 0.0)
            correct(x[axis], P[axis], y, noise[axis] ** 2)
    return accepted


@njit(cache=True, error_model="numpy")
def _lock(x, P, centre, speed, P0):
    for axis in range(3):
        x[axis, 0], x[axis, 1], x[axis, 2] = centre[axis], speed[axis], 0.0
        P[axis, :] = 0.0
        P[axis, 0], P[axis, 3], P[axis, 5] = P0[axis, 0], P0[axis, 1], P0[axis, 2]
