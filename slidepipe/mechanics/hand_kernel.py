"""The hand's motion, piece by piece, as the compiled simulations read it.

``scale`` stretches the motion about its start; the hand rests before the first and after the last piece.
"""

from numba import njit

FAST = {"cache": True, "error_model": "numpy", "fastmath": {"contract", "arcp", "nsz", "reassoc"}}
"""Sums may be reordered and fused; NaN and infinity keep their meaning."""


@njit(**FAST)
def piece_of(breaks, t):
    """Index of the piece that holds t."""
    low, high = 0, len(breaks) - 1
    while high - low > 1:
        middle = (low + high) // 2
        if breaks[middle] <= t:
            low = middle
        else:
            high = middle
    return low


@njit(**FAST)
def hand_at(breaks, coefficients, scale, t):
    """Velocity and acceleration of the hand at t: (v_x, v_y, omega, a_x, a_y, alpha)."""
    last = len(breaks) - 1
    if t < breaks[0] or t >= breaks[last]:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    low = piece_of(breaks, t)
    s = t - breaks[low]
    d = coefficients.shape[1] - 1
    v0, v1, v2 = d * coefficients[low, d, 0], d * coefficients[low, d, 1], d * coefficients[low, d, 2]
    a0, a1, a2 = (d - 1) * v0, (d - 1) * v1, (d - 1) * v2
    for d in range(coefficients.shape[1] - 2, 0, -1):
        w0, w1, w2 = d * coefficients[low, d, 0], d * coefficients[low, d, 1], d * coefficients[low, d, 2]
        v0, v1, v2 = v0 * s + w0, v1 * s + w1, v2 * s + w2
        if d > 1:
            a0, a1, a2 = a0 * s + (d - 1) * w0, a1 * s + (d - 1) * w1, a2 * s + (d - 1) * w2
    return scale * v0, scale * v1, scale * v2, scale * a0, scale * a1, scale * a2


@njit(**FAST)
def hand_velocity(breaks, coefficients, scale, t, near):
    """Velocity of the hand alone, at a time in or after piece ``near``: what each stage of a slide needs."""
    last = len(breaks) - 1
    if t >= breaks[last]:
        return 0.0, 0.0, 0.0
    low = near
    while breaks[low + 1] <= t:
        low += 1
    s = t - breaks[low]
    d = coefficients.shape[1] - 1
    v0, v1, v2 = d * coefficients[low, d, 0], d * coefficients[low, d, 1], d * coefficients[low, d, 2]
    for d in range(coefficients.shape[1] - 2, 0, -1):
        v0 = v0 * s + d * coefficients[low, d, 0]
        v1 = v1 * s + d * coefficients[low, d, 1]
        v2 = v2 * s + d * coefficients[low, d, 2]
    return scale * v0, scale * v1, scale * v2


@njit(**FAST)
def angle_at(breaks, coefficients, scale, t):
    """Angle of the hand at t."""
    last = len(breaks) - 1
    t = min(max(t, breaks[0]), breaks[last])
    low = piece_of(breaks, t)
    s, angle = t - breaks[low], 0.0
    for d in range(coefficients.shape[1] - 1, -1, -1):
        angle = angle * s + coefficients[low, d, 2]
    start = coefficients[0, 0, 2]
    return start + scale * (angle - start)
