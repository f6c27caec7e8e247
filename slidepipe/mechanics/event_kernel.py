"""Event-driven integration of a pinched object under a moving hand: exact stick, slips located, high order between.

``hand`` and ``body`` are those of :mod:`slidepipe.mechanics.slide_kernel`, which integrates the slides.
"""

import numpy as np
from numba import njit, prange

from slidepipe.mechanics.curve_kernel import gauge
from slidepipe.mechanics.explicit_kernel import GRAVITY
from slidepipe.mechanics.hand_kernel import FAST, hand_at, piece_of
from slidepipe.mechanics.slide_kernel import GRAZE_S, GRAZED, MOST_STEPS, SCRATCH, STUCK, slide

LONGEST_GRAZE_S = 1e-3
"""How long a grip that was found to graze its limit again and again is at most not looked at."""
SCANS = 6
"""Places in each piece of the hand's motion where a sticking grip is looked at."""


@njit(**FAST)
def overloaded(hand, body, r, t, piece):
    """Whether sticking needs more friction than there is at t in a piece, eq. (17); ``r`` is the pose in {b}."""
    angle, _v0, _v1, omega, a_x, a_y, alpha = hand_at(hand[0], hand[1], body[4], t, piece)
    theta = angle - r[2]
    c, s = np.cos(theta), np.sin(theta)
    r_x, r_y, spin = c * r[0] - s * r[1], s * r[0] + c * r[1], omega * omega
    m, rho = body[0], body[3]
    f_x, f_y = m * (a_x + spin * r_x + alpha * r_y), m * (a_y + GRAVITY + spin * r_y - alpha * r_x)
    m_z = body[1] * alpha - (r_x * f_y - r_y * f_x)
    return outside(body[7], body[2], rho, f_x, f_y, m_z)


@njit(**FAST)
def outside(curve, force, rho, f_x, f_y, m_z):
    """Whether a contact cannot bear a wrench."""
    if curve is None:
        return rho * rho * (f_x * f_x + f_y * f_y - force * force) + m_z * m_z > 0.0
    return gauge(curve, f_x, f_y, m_z / rho) > force


@njit(**FAST)
def find_onset(hand, body, r, start, stop):
    """First time in [start, stop] at which the grip needs more friction than there is; ``stop`` if there is none."""
    breaks, low, first = hand[0], start, piece_of(hand[0], start)
    if overloaded(hand, body, r, start, first):
        return start
    for piece in range(first, len(breaks) - 1):
        if breaks[piece + 1] <= start:
            continue
        if breaks[piece] >= stop:
            break
        for scan in range(1, SCANS + 1):
            high = breaks[piece] + (breaks[piece + 1] - breaks[piece]) * scan / SCANS
            high = min(high, stop)
            if high <= low:
                continue
            # At the end of a phase it is the side before the jump that counts.
            inside = high - 1e-12 if scan == SCANS or high == stop else high
            if overloaded(hand, body, r, inside, piece):
                return bisect(hand, body, r, low, inside, piece)
            low = high
    return stop


@njit(**FAST)
def bisect(hand, body, r, low, high, piece):
    """Time between ``low`` and ``high`` at which the load passes one."""
    while high - low > 1e-15 + 4e-16 * abs(high):
        middle = 0.5 * (low + high)
        if middle <= low or middle >= high:
            break
        if overloaded(hand, body, r, middle, piece):
            high = middle
        else:
            low = middle
    return high


@njit(**FAST)
def begin_slide(hand, body, r, t, y):
    """State of an object that still moves with the hand, at the moment when its grip gives way."""
    angle, h0, h1, h2, _a0, _a1, _a2 = hand_at(hand[0], hand[1], body[4], t, piece_of(hand[0], t))
    theta = angle - r[2]
    c, s = np.cos(theta), np.sin(theta)
    r_x, r_y = c * r[0] - s * r[1], s * r[0] + c * r[1]
    y[0], y[1], y[2] = r[0], r[1], theta
    y[3], y[4], y[5] = h0 + h2 * r_y, h1 - h2 * r_x, h2


@njit(**FAST)
def follow(hand, jumps, body, tolerance, end, r, path):
    """Run one trial; ``r`` goes from the first to the last relative pose, and ``path`` (P, 7) receives the first knots.

    Returns (ended as, slides, begun, stopped, knots).
    """
    breaks, y, scratch = hand[0], np.empty(6), np.empty((SCRATCH, 6))
    t, ended, slides, begun, stopped, count = breaks[0], STUCK, 0, np.nan, np.nan, 0
    jump, graze = 1, GRAZE_S
    while t < end and slides < MOST_STEPS:
        while jump < len(breaks) and (breaks[jump] <= t or not jumps[jump]):
            jump += 1
        limit = min(end, breaks[jump]) if jump < len(breaks) else end
        t = find_onset(hand, body, r, t, limit)
        if t >= limit:
            continue
        onset = t
        begin_slide(hand, body, r, t, y)
        t, ended, count = slide(hand, jumps, body, tolerance, end, r, t, y, scratch, path, count)
        if ended == GRAZED and t == onset:
            # It holds on, and is looked at again: ever later, for a load may stay at the limit for a whole phase.
            t, ended, graze = t + graze, STUCK, min(2.0 * graze, LONGEST_GRAZE_S)
            continue
        ended, graze = STUCK if ended == GRAZED else ended, GRAZE_S
        slides += 1
        begun = onset if slides == 1 else begun
        stopped = t
        if ended != STUCK:
            break
    return ended, slides, begun, stopped, count


@njit(**FAST)
def run_trial(breaks, coefficients, jumps, curve, m, inertia, force, rho, length, width, tolerance, rest, r, path):
    """Run one trial, and ``rest`` after the hand's motion: see :func:`follow`."""
    body, end = (m, inertia, force, rho, 1.0, 0.5 * length, 0.5 * width, curve), breaks[-1] + rest
    return follow((breaks, coefficients), jumps, body, tolerance, end, r, path)


@njit(parallel=True, **FAST)
def run_batch(breaks, coefficients, jumps, curve, bodies, tolerance, rest, r, out):
    """Run many trials on all cores; ``bodies`` (N, 7), ``r`` (N, 3) and ``out`` (N, 5) row by row."""
    end = breaks[-1] + rest
    for trial in prange(len(bodies)):
        b = bodies[trial]
        body = (b[0], b[1], b[2], b[3], b[4], b[5], b[6], curve)
        told = follow((breaks, coefficients), jumps, body, tolerance, end, r[trial], np.empty((0, 7)))
        out[trial, 0], out[trial, 1], out[trial, 2], out[trial, 3], out[trial, 4] = told
