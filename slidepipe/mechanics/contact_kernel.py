"""The one step that every simulation takes: whether a soft finger sticks, and if not, with which force it slides.

Given the contact mobility W and the relative velocity (or acceleration) b that the contact would have without
friction, find f inside the ellipsoid f^T A f <= 1 such that either the contact sticks, W f = b, or it slides along its
own friction, b - W f = k A f with k > 0 (eqs. 10, 11 and 14 together). In scaled forces g = S^-1 f, with S the
ellipsoid's semi-axes, this is (S W S + k I) g = S b with |g| = 1: monotone in k, like the step of a trust region.
"""

import numpy as np
from numba import njit

from slidepipe.mechanics.curve_kernel import gauge, local_ellipsoid, outward, support
from slidepipe.mechanics.norm_kernel import smallest_sum

FAST = {"cache": True, "error_model": "numpy", "fastmath": {"contract", "arcp", "nsz"}}
ROUNDS = 60
SURFACES = 12
"""Ellipsoids that are tried on a surface told by a curve."""
SETTLED = 1e-12
"""Share of the friction by which two of them may disagree at the end."""
QUADRATIC = 1e-7
"""Below this Newton's next step is exact to the last bit."""


@njit(**FAST)
def on_the_sphere(a11, a12, a13, a22, a23, a33, c1, c2, c3, k):
    """Unit g and k >= 0 with (A + k I) g = c, from a guess of k; returns (g1, g2, g3, k), k zero if |A^-1 c| <= 1.

    By Cramer's rule g and |g|^2 are polynomials in k over those of the determinant: Newton's rounds cost a root and a
    division each. It loses little, since scaling A's rows and columns alike changes nothing in it.
    """
    m11, m12, m13 = a22 * a33 - a23 * a23, a13 * a23 - a12 * a33, a12 * a23 - a13 * a22
    m22, m23, m33 = a11 * a33 - a13 * a13, a12 * a13 - a11 * a23, a11 * a22 - a12 * a12
    # adj(A + k I) c = n + k p + k^2 c; det(A + k I) = det + k minors + k^2 trace + k^3.
    trace, minors, det = a11 + a22 + a33, m11 + m22 + m33, a11 * m11 + a12 * m12 + a13 * m13
    n1, n2, n3 = m11 * c1 + m12 * c2 + m13 * c3, m12 * c1 + m22 * c2 + m23 * c3, m13 * c1 + m23 * c2 + m33 * c3
    p1 = (trace - a11) * c1 - a12 * c2 - a13 * c3
    p2 = (trace - a22) * c2 - a12 * c1 - a23 * c3
    p3 = (trace - a33) * c3 - a13 * c1 - a23 * c2
    q0, q1 = n1 * n1 + n2 * n2 + n3 * n3, 2.0 * (n1 * p1 + n2 * p2 + n3 * p3)
    q2 = p1 * p1 + p2 * p2 + p3 * p3 + 2.0 * (n1 * c1 + n2 * c2 + n3 * c3)
    q3, q4 = 2.0 * (p1 * c1 + p2 * c2 + p3 * c3), c1 * c1 + c2 * c2 + c3 * c3
    for _ in range(ROUNDS):
        D, dD = det + k * (minors + k * (trace + k)), minors + k * (2.0 * trace + 3.0 * k)
        Q = q0 + k * (q1 + k * (q2 + k * (q3 + k * q4)))
        dQ = q1 + k * (2.0 * q2 + k * (3.0 * q3 + 4.0 * k * q4))
        over = np.sqrt(Q) - D
        if k == 0.0 and over <= 0.0:
            return 0.0, 0.0, 0.0, 0.0
        # Newton on 1/|g| - 1, which is nearly straight in k.
        k += over * Q / (dD * Q - 0.5 * D * dQ)
        if abs(over) < QUADRATIC * D and k > 0.0:
            break
        k = max(k, 0.0)
    g1, g2, g3 = n1 + k * (p1 + k * c1), n2 + k * (p2 + k * c2), n3 + k * (p3 + k * c3)
    share = 1.0 / np.sqrt(g1 * g1 + g2 * g2 + g3 * g3)
    return share * g1, share * g2, share * g3, k


@njit(**FAST)
def contact_force(curve, inverse_m, inverse_i, force, rho, r_x, r_y, b_x, b_y, b_z, k_start):
    """Friction of one contact at offset (r_x, r_y) from the CoM.

    ``curve`` tells the surface, None the ellipsoid; ``inverse_m`` and ``inverse_i`` are 1/m and 1/I, times the step
    where b is a velocity; ``force`` is mu f_N, ``rho`` is c a, and ``k_start`` a guess of k, zero if there is none.
    Returns (f_x, f_y, m_z, k): k is zero where it sticks.
    """
    # W f = b outright: what moves the object with the hand.
    f_x, f_y = (b_x + b_z * r_y) / inverse_m, (b_y - b_z * r_x) / inverse_m
    m_z = b_z / inverse_i - r_x * f_y + r_y * f_x
    square = force * force
    if curve is None:
        sticks = rho * rho * (f_x * f_x + f_y * f_y - square) + m_z * m_z <= 0.0
    else:
        sticks = gauge(curve, f_x, f_y, m_z / rho) <= force
    if sticks:
        return f_x, f_y, m_z, 0.0
    # S W S and S b; S = force * diag(1, 1, rho).
    turn, spin = square * inverse_i, rho * inverse_i * square
    a11, a22, a33 = square * inverse_m + r_y * r_y * turn, square * inverse_m + r_x * r_x * turn, rho * spin
    a12, a13, a23 = -r_x * r_y * turn, -r_y * spin, r_x * spin
    c1, c2, c3 = force * b_x, force * b_y, force * rho * b_z
    g1, g2, g3, k = on_the_sphere(a11, a12, a13, a22, a23, a33, c1, c2, c3, k_start)
    if curve is not None:
        if k > 0.0:
            n1, n2, n3 = g1, g2, g3
        else:
            n1, n2, n3 = outward(curve, f_x, f_y, m_z / rho)
        g1, g2, g3, k = on_the_curve(curve, a11, a12, a13, a22, a23, a33, c1, c2, c3, n1, n2, n3, k)
    if k == 0.0:
        return f_x, f_y, m_z, 0.0
    return force * g1, force * g2, force * rho * g3, k


@njit(**FAST)
def on_the_curve(curve, a11, a12, a13, a22, a23, a33, c1, c2, c3, n1, n2, n3, k):
    """As :func:`on_the_sphere` for a surface told by a curve: c - A g is a twist with the friction g.

    From a guess (n1, n2, n3) of the twist's direction, the ellipsoid that touches the surface there to second order
    gives a better one, and so on: Newton's method, which converges in a few rounds. Where it does not, the contact is
    solved as a grasp of one finger. Returns (g1, g2, g3, k) with k the support function at the twist.
    """
    for _ in range(SURFACES):
        _, c, s, m_ll, m_lt, m_tt, m_nn = local_ellipsoid(curve, n1, n2, n3)
        # M = L L^T, in axes along the sliding (l), across (n) and about the contact (t).
        l11, l22 = np.sqrt(m_ll), np.sqrt(m_nn)
        l31 = m_lt / l11
        l33 = np.sqrt(max(m_tt - l31 * l31, 1e-300))
        b11, b22 = c * c * a11 + 2.0 * c * s * a12 + s * s * a22, s * s * a11 - 2.0 * c * s * a12 + c * c * a22
        b12 = c * s * (a22 - a11) + (c * c - s * s) * a12
        b13, b23 = c * a13 + s * a23, c * a23 - s * a13
        e1, e2 = c * c1 + s * c2, c * c2 - s * c1
        y1, y2, y3, k = on_the_sphere(
            l11 * l11 * b11 + 2.0 * l11 * l31 * b13 + l31 * l31 * a33,
            l22 * (l11 * b12 + l31 * b23),
            l33 * (l11 * b13 + l31 * a33),
            l22 * l22 * b22,
            l22 * l33 * b23,
            l33 * l33 * a33,
            l11 * e1 + l31 * c3,
            l22 * e2,
            l33 * c3,
            k,
        )
        if k == 0.0:
            break
        # Friction g = L y and the twist, a multiple of L^-T y, turned back.
        g_l, g_n, g3 = l11 * y1, l22 * y2, l31 * y1 + l33 * y3
        g1, g2 = c * g_l - s * g_n, s * g_l + c * g_n
        n3 = y3 / l33
        n_l, n_n = (y1 - l31 * n3) / l11, y2 / l22
        n1, n2 = c * n_l - s * n_n, s * n_l + c * n_n
        _, h1, h2, h3 = support(curve, n1, n2, n3)
        if max(abs(g1 - h1), abs(g2 - h2), abs(g3 - h3)) < SETTLED:
            return g1, g2, g3, k
    return as_a_grasp(curve, a11, a12, a13, a22, a23, a33, c1, c2, c3)


@njit(**FAST)
def as_a_grasp(curve, a11, a12, a13, a22, a23, a33, c1, c2, c3):
    """The same by the convex problem of a grasp: the smallest ``|x|^2 / 2 + h(c - K x)`` with ``K K^T = A``."""
    K, e, x, g = np.zeros((1, 3, 3)), np.empty((1, 3)), np.empty(3), np.empty((1, 3))
    K[0, 0, 0] = np.sqrt(a11)
    K[0, 1, 0], K[0, 2, 0] = a12 / K[0, 0, 0], a13 / K[0, 0, 0]
    K[0, 1, 1] = np.sqrt(a22 - K[0, 1, 0] ** 2)
    K[0, 2, 1] = (a23 - K[0, 1, 0] * K[0, 2, 0]) / K[0, 1, 1]
    K[0, 2, 2] = np.sqrt(max(a33 - K[0, 2, 0] ** 2 - K[0, 2, 1] ** 2, 1e-300))
    e[0, 0], e[0, 1], e[0, 2] = c1, c2, c3
    shapes, curves = np.zeros(1, np.int64), curve.reshape(1, curve.shape[0], 3)
    smallest_sum(1.0, K, e, x, g, shapes, curves)
    z1, z2, z3 = (
        e[0, 0] + K[0, 0, 0] * x[0],
        e[0, 1] + K[0, 1, 0] * x[0] + K[0, 1, 1] * x[1],
        e[0, 2] + K[0, 2, 0] * x[0] + K[0, 2, 1] * x[1] + K[0, 2, 2] * x[2],
    )
    if z1 == 0.0 and z2 == 0.0 and z3 == 0.0:
        return 0.0, 0.0, 0.0, 0.0
    h, g1, g2, g3 = support(curve, z1, z2, z3)
    return g1, g2, g3, h
