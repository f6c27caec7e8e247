"""The one step that every simulation takes: whether a soft finger sticks, and if not, with which force it slides.

Given the contact mobility W and the relative velocity (or acceleration) b that the contact would have without
friction, find f inside the ellipsoid f^T A f <= 1 such that either the contact sticks, W f = b, or it slides along its
own friction, b - W f = k A f with k > 0 (eqs. 10, 11 and 14 together). In scaled forces g = S^-1 f, with S the
ellipsoid's semi-axes, this is (S W S + k I) g = S b with |g| = 1: monotone in k, like the step of a trust region.
"""

import numpy as np
from numba import njit

ROUNDS = 60
QUADRATIC = 1e-7
"""Below this Newton's next step is exact to the last bit."""


@njit(cache=True, error_model="numpy")
def contact_force(inverse_m, inverse_i, force, rho, r_x, r_y, b_x, b_y, b_z, k_start):
    """Friction of one contact at offset (r_x, r_y) from the CoM.

    ``inverse_m`` and ``inverse_i`` are 1/m and 1/I, times the step where b is a velocity; ``force`` is mu f_N, ``rho``
    is c a, and ``k_start`` a guess of k, zero if there is none. Returns (f_x, f_y, m_z, k): k is zero where it sticks.
    """
    # W f = b outright: what moves the object with the hand.
    f_x, f_y = (b_x + b_z * r_y) / inverse_m, (b_y - b_z * r_x) / inverse_m
    m_z = b_z / inverse_i - r_x * f_y + r_y * f_x
    if rho * rho * (f_x * f_x + f_y * f_y - force * force) + m_z * m_z <= 0.0:
        return f_x, f_y, m_z, 0.0
    # S W S and S b; S = force * diag(1, 1, rho).
    square = force * force
    a11 = square * (inverse_m + r_y * r_y * inverse_i)
    a22 = square * (inverse_m + r_x * r_x * inverse_i)
    a12 = -square * r_x * r_y * inverse_i
    a13 = -square * rho * r_y * inverse_i
    a23 = square * rho * r_x * inverse_i
    a33 = square * rho * rho * inverse_i
    c1, c2, c3 = force * b_x, force * b_y, force * rho * b_z
    k, last = k_start, False
    g1, g2, g3 = 0.0, 0.0, 0.0
    for _ in range(ROUNDS):
        # (S W S + k I) g = S b by the factors L D L^T.
        d1 = 1.0 / (a11 + k)
        l21, l31 = a12 * d1, a13 * d1
        d2 = 1.0 / (a22 + k - l21 * a12)
        rest = a23 - l31 * a12
        l32 = rest * d2
        d3 = 1.0 / (a33 + k - l31 * a13 - l32 * rest)
        y2 = c2 - l21 * c1
        g3 = (c3 - l31 * c1 - l32 * y2) * d3
        g2 = y2 * d2 - l32 * g3
        g1 = c1 * d1 - l21 * g2 - l31 * g3
        size = np.sqrt(g1 * g1 + g2 * g2 + g3 * g3)
        if last or (k == 0.0 and size <= 1.0):
            break
        # Newton on 1/|g| - 1, which is nearly straight in k.
        z2 = g2 - l21 * g1
        z3 = g3 - l31 * g1 - l32 * z2
        k += (size - 1.0) * size * size / (g1 * g1 * d1 + z2 * z2 * d2 + z3 * z3 * d3)
        last = abs(size - 1.0) < QUADRATIC and k > 0.0
        k = max(k, 0.0)
    if k > 0.0:
        size = np.sqrt(g1 * g1 + g2 * g2 + g3 * g3)
        g1, g2, g3 = g1 / size, g2 / size, g3 / size
    return force * g1, force * g2, force * rho * g3, k
