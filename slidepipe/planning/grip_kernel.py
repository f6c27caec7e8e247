"""What a motion asks of the grip, compiled: the share of the friction while sticking, and where on the face it is."""

import numpy as np
from numba import njit

from slidepipe.mechanics.load_kernel import certified_load
from slidepipe.planning.profile_kernel import FAST, GRAVITY


@njit(**FAST)
def stick_share(body, fingers, r_x, r_y, angle, theta, a_x, a_y, alpha):
    """Share of the friction that an object needs to go with the hand, eq. (17)."""
    c, s = np.cos(theta), np.sin(theta)
    w_x, w_y = body[0] * a_x, body[0] * (a_y + GRAVITY)
    f_x, f_y, m_z = c * w_x + s * w_y, -s * w_x + c * w_y, body[1] * alpha
    if len(fingers) == 1 and fingers[0, 2] == 0.0 and fingers[0, 3] == 0.0:
        spin = (m_z - r_x * f_y + r_y * f_x) / fingers[0, 1]
        return np.sqrt(f_x * f_x + f_y * f_y + spin * spin) / fingers[0, 0]
    places, axes = np.zeros((len(fingers), 3)), np.empty((len(fingers), 3))
    c, s = np.cos(angle), np.sin(angle)
    for i in range(len(fingers)):
        places[i, 0] = r_x + c * fingers[i, 2] - s * fingers[i, 3]
        places[i, 1] = r_y + s * fingers[i, 2] + c * fingers[i, 3]
        axes[i, 0] = axes[i, 1] = fingers[i, 0]
        axes[i, 2] = fingers[i, 0] * fingers[i, 1]
    forces, direction = np.empty((len(fingers), 3)), np.empty(3)
    ellipsoids, no_curves = np.full(len(fingers), -1), np.empty((0, 2, 3))
    return certified_load(places, axes, ellipsoids, no_curves, np.array([f_x, f_y, m_z]), forces, direction)[0]


@njit(**FAST)
def phase_load(body, fingers, r, table):
    """Largest load along a phase in which the object sticks, and at rest where it ends or begins."""
    worst = 0.0
    for row in table:
        worst = max(worst, stick_share(body, fingers, r[0], r[1], r[2], row[2], row[6], row[7], row[8]))
    return worst


@njit(**FAST)
def face_share(body, fingers, r_x, r_y, angle):
    """How far out on the face the outermost finger is: one at its edge."""
    c, s = np.cos(angle), np.sin(angle)
    worst = 0.0
    for i in range(len(fingers)):
        x, y = r_x + c * fingers[i, 2] - s * fingers[i, 3], r_y + s * fingers[i, 2] + c * fingers[i, 3]
        worst = max(worst, abs(x) / body[5], abs(y) / body[6])
    return worst
