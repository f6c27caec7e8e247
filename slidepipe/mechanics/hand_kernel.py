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
def hand_at(breaks, coefficients, scale, t, piece):
    """Angle, velocity and acceleration of the hand at a time in a piece: (theta, v_x, v_y, omega, a_x, a_y, alpha)."""
    last = len(breaks) - 1
    if t < breaks[0] or t >= breaks[last]:
        return angle_at(breaks, coefficients, scale, t), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    s, d = t - breaks[piece], coefficients.shape[1] - 1
    q0, q1, q2 = coefficients[piece, d, 0], coefficients[piece, d, 1], coefficients[piece, d, 2]
    v0, v1, v2, a0, a1, a2 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for d in range(coefficients.shape[1] - 2, -1, -1):
        a0, a1, a2 = a0 * s + v0, a1 * s + v1, a2 * s + v2
        v0, v1, v2 = v0 * s + q0, v1 * s + q1, v2 * s + q2
        q0, q1, q2 = (
            q0 * s + coefficients[piece, d, 0],
            q1 * s + coefficients[piece, d, 1],
            q2 * s + coefficients[piece, d, 2],
        )
    start, twice = coefficients[0, 0, 2], 2.0 * scale
    return start + scale * (q2 - start), scale * v0, scale * v1, scale * v2, twice * a0, twice * a1, twice * a2


@njit(**FAST)
def hand_velocity(breaks, coefficients, scale, t, near):
    """Velocity of the hand alone, at a time in or after piece ``near``: what each stage of a slide needs."""
    last = len(breaks) - 1
    if t >= breaks[last]:
        return 0.0, 0.0, 0.0
    low = near
    while breaks[low + 1] <= t:
        low += 1
    s, d = t - breaks[low], coefficients.shape[1] - 1
    q0, q1, q2 = coefficients[low, d, 0], coefficients[low, d, 1], coefficients[low, d, 2]
    v0, v1, v2 = 0.0, 0.0, 0.0
    for d in range(coefficients.shape[1] - 2, 0, -1):
        v0, v1, v2 = v0 * s + q0, v1 * s + q1, v2 * s + q2
        q0, q1, q2 = (
            q0 * s + coefficients[low, d, 0],
            q1 * s + coefficients[low, d, 1],
            q2 * s + coefficients[low, d, 2],
        )
    return scale * (v0 * s + q0), scale * (v1 * s + q1), scale * (v2 * s + q2)


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
