"""How wrong the friction may be, compiled: by simulated trials of a lone finger, or by a straight slide's formula."""

import numpy as np
from numba import njit

from slidepipe.mechanics.event_kernel import run_trial
from slidepipe.mechanics.slide_kernel import STUCK
from slidepipe.planning.profile_kernel import BRAKE, FAST, TEAR

MOST_TURN_RAD = 0.3
"""An object that turned further in the hand than it was to is lost."""
REST_S = 0.5
SEARCH_TOLERANCE_M = 1e-6
ERROR_STEP, CLOSE = 4e-3, 5e-4
"""Between the first friction errors that are tried, and how closely the largest is told."""
LOST = 1.5
"""Measure of a trial whose object is lost; from one on it is no better than not to have tried."""


@njit(**FAST)
def distance(a, b, rho):
    """Length of a slide, a radian counting as ``rho``."""
    x, y, angle = a[0] - b[0], a[1] - b[1], rho * (a[2] - b[2])
    return np.sqrt(x * x + y * y + angle * angle)


@njit(**FAST)
def measure(body, r, ended, r_start, r_goal, rho):
    """How a trial went: below one it came nearer, turned too little to be lost, and stayed on the face."""
    if ended != STUCK:
        return LOST
    nearer = distance(r, r_goal, rho) / distance(r_start, r_goal, rho)
    turned = abs(r[2] - r_goal[2]) / MOST_TURN_RAD
    return max(nearer, turned, abs(r[0]) / body[5] - 1e-9, abs(r[1]) / body[6] - 1e-9)


@njit(**FAST)
def tried(breaks, coefficients, jumps, body, ratio, tolerance, r_start, r):
    """How one trial of a lone finger with ``ratio`` times the friction ends; ``r`` receives where."""
    r[:] = r_start
    force, length, width = ratio * body[2], 2.0 * body[5], 2.0 * body[6]
    told = run_trial(
        breaks,
        coefficients,
        jumps,
        None,
        body[0],
        body[1],
        force,
        body[3],
        length,
        width,
        tolerance,
        REST_S,
        r,
        np.empty((0, 7)),
    )
    return told[0]


@njit(**FAST)
def worst_of_two(breaks, coefficients, jumps, body, r_start, r_goal, error, r):
    """Worse measure of a trial with that much less friction, which fails first more often, and one with more.

    The second is not run where the first fails.
    """
    worst = 0.0
    for way in (-1.0, 1.0):
        ended = tried(breaks, coefficients, jumps, body, 1.0 + way * error, SEARCH_TOLERANCE_M, r_start, r)
        worst = max(worst, measure(body, r, ended, r_start, r_goal, body[3]))
        if worst >= 1.0:
            break
    return worst


@njit(**FAST)
def error_survived(breaks, coefficients, jumps, body, r_start, r_goal, least, most):
    """Largest friction error both ways that a lone finger's trial survives, up to ``most``.

    Sought in growing steps from ``least``, then by halving; where not even that much is survived, -1 tells so.
    """
    r, step = np.empty(3), ERROR_STEP
    low, high = min(max(least, 0.0), most), np.inf
    # Half way, too: a trial may survive much where it does not survive less.
    for error in (low, 0.5 * low):
        if worst_of_two(breaks, coefficients, jumps, body, r_start, r_goal, error, r) >= 1.0:
            return -1.0
    while low < most - 1e-9 and high - low > CLOSE:
        error = min(most, low + step) if high == np.inf else 0.5 * (low + high)
        step *= 2.0
        if worst_of_two(breaks, coefficients, jumps, body, r_start, r_goal, error, r) < 1.0:
            low = error
        else:
            high = error
    return low


@njit(**FAST)
def straight_length(d, rho):
    """Length of a slide along ``d``, a radian counting as ``rho``."""
    return np.sqrt(d[0] * d[0] + d[1] * d[1] + (rho * d[2]) ** 2)


@njit(**FAST)
def straight_error(body, fingers, times, r_goal, d, held):
    """Friction error that a straight slide survives, by formula.

    With tearing and braking accelerations r_2 and r_3 and the friction's kappa, friction that is less by a share e
    slides (1 + e kappa / r_2) / (1 - e kappa / r_3) times as far; it may slide twice as far, or to the edge of the
    face. More friction by r_2 / kappa does not slide at all.
    """
    length = straight_length(d, body[3])
    whole = times[TEAR] + times[BRAKE]
    tear, brake = 2.0 * length / (times[TEAR] * whole), 2.0 * length / (times[BRAKE] * whole)
    beyond, c, s = 1.0, np.cos(r_goal[2]), np.sin(r_goal[2])
    for i in range(len(fingers)):
        x = r_goal[0] + c * fingers[i, 2] - s * fingers[i, 3]
        y = r_goal[1] + s * fingers[i, 2] + c * fingers[i, 3]
        if d[0] != 0.0:
            beyond = min(beyond, (body[5] - x * np.sign(d[0])) / abs(d[0]))
        if d[1] != 0.0:
            beyond = min(beyond, (body[6] - y * np.sign(d[1])) / abs(d[1]))
    kappa = body[2] / body[0]
    less = max(0.0, beyond) / (kappa * (1.0 / tear + (1.0 + beyond) / brake))
    return min(less, tear / kappa, 1.0 - held)
