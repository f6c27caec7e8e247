"""Limit surfaces that are told by a curve, compiled: rotationally symmetric about m_z, tabulated along the meridian.

Scaled twists z = S dv and wrenches g = S^-1 f, with S the largest force and moment, have an ellipsoid's surface as the
unit ball. Another surface has a support function ``h(z) = (l + t) P(q)`` of the sliding part ``l = |z_xy|`` and the
turning part ``t = |z_3|``, with ``q = t / (l + t)``. A curve (N + 1, 3) holds P and its slope at equal steps of q,
between which it is cubic, and the q that belongs to equal steps of ``|g_3| / (|g_xy| + |g_3|)``.
"""

import numpy as np
from numba import njit

FAST = {"cache": True, "error_model": "numpy", "fastmath": {"contract", "arcp", "nsz"}}
REFINED = 3
"""Newton's rounds from the tabulated q: then it is exact."""
ON_AXIS = 1e-9
"""Share of sliding below which its direction's stiffness is that at the axis."""


@njit(**FAST)
def profile(curve, q):
    """P, its slope and its second derivative at q in [0, 1], of a curve."""
    cells = len(curve) - 1
    cell = min(int(q * cells), cells - 1)
    u, step = q * cells - cell, 1.0 / cells
    rise = (curve[cell + 1, 0] - curve[cell, 0]) * cells
    slope, bend = curve[cell, 1], 3.0 * rise - 2.0 * curve[cell, 1] - curve[cell + 1, 1]
    twist = curve[cell, 1] + curve[cell + 1, 1] - 2.0 * rise
    value = curve[cell, 0] + step * u * (slope + u * (bend + u * twist))
    return value, slope + u * (2.0 * bend + 3.0 * u * twist), (2.0 * bend + 6.0 * u * twist) * cells


@njit(**FAST)
def turning_share(curve, sliding, turning):
    """The q of the twist that is normal to the surface at a multiple of scaled friction, by Newton's method."""
    cells = len(curve) - 1
    p = turning / (sliding + turning) * cells
    cell = min(int(p), cells - 1)
    q = curve[cell, 2] + (p - cell) * (curve[cell + 1, 2] - curve[cell, 2])
    for _ in range(REFINED):
        P, slope, bend = profile(curve, q)
        off = turning * (P - q * slope) - sliding * (P + (1.0 - q) * slope)
        q = min(max(q + off / (bend * (q * turning + (1.0 - q) * sliding)), 0.0), 1.0)
    return q


@njit(**FAST)
def gauge(curve, g1, g2, g3):
    """How often scaled friction fits into the surface: the contact sticks below one."""
    sliding, turning = np.sqrt(g1 * g1 + g2 * g2), abs(g3)
    if sliding == 0.0 and turning == 0.0:
        return 0.0
    q = turning_share(curve, sliding, turning)
    return ((1.0 - q) * sliding + q * turning) / profile(curve, q)[0]


@njit(**FAST)
def outward(curve, g1, g2, g3):
    """Normal of the surface at scaled friction that is not zero, or at a multiple of it."""
    sliding, turning = np.sqrt(g1 * g1 + g2 * g2), abs(g3)
    q = turning_share(curve, sliding, turning)
    along = (1.0 - q) / sliding if sliding > 0.0 else 0.0
    return along * g1, along * g2, np.copysign(q, g3)


@njit(**FAST)
def local_ellipsoid(curve, z1, z2, z3):
    """The ellipsoid that touches the surface to second order where the scaled twist is normal to it.

    Returns (h, c, s, m_ll, m_lt, m_tt, m_nn): the support function and, in axes along (c, s), across and about the
    contact, half the second derivatives of its square, M. By homogeneity ``h^2 = z . M z`` and ``h g = M z``.
    """
    sliding, turning = np.sqrt(z1 * z1 + z2 * z2), abs(z3)
    whole = sliding + turning
    q, sign = turning / whole, np.copysign(1.0, z3)
    P, slope, bend = profile(curve, q)
    g_l, g_t, rest = P - q * slope, P + (1.0 - q) * slope, 1.0 - q
    c, s = (z1 / sliding, z2 / sliding) if sliding > 0.0 else (1.0, 0.0)
    bend *= P
    m_nn = P * g_l / rest if rest > ON_AXIS else bend
    m_lt = sign * (g_l * g_t - bend * q * rest)
    return whole * P, c, s, g_l * g_l + bend * q * q, m_lt, g_t * g_t + bend * rest * rest, m_nn


@njit(**FAST)
def support(curve, z1, z2, z3):
    """Power of scaled friction at a scaled twist that is not zero, and that friction: (h, g1, g2, g3)."""
    sliding, turning = np.sqrt(z1 * z1 + z2 * z2), abs(z3)
    whole = sliding + turning
    q = turning / whole
    P, slope, _ = profile(curve, q)
    along = (P - q * slope) / sliding if sliding > 0.0 else 0.0
    return whole * P, along * z1, along * z2, np.copysign(P + (1.0 - q) * slope, z3)
