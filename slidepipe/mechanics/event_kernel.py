"""Event-driven integration of a pinched object under a moving hand: exact stick, slips located, high order between.

The state of a slide is ``(r_x, r_y, theta, v_x, v_y, omega)``: the finger's place in {b} and the object's angle and
velocities in {w}. The object's position follows from the hand's: nothing small is a difference of large numbers.

A slow slide is stiff: the direction of its friction settles within a time |dv| m / (mu f_N). Its steps are made of
implicit Euler's, whose contact is solved outright (:mod:`slidepipe.mechanics.contact_kernel`), in 1, 2 ... 7 parts that
are extrapolated to order seven at most, as in Hairer and Wanner's SEULEX. They start from rest by themselves, and a
slide that comes to its end is cut into steps that each leave a share of its speed. Where the slide is fast and its
direction changes, explicit steps of order eight get further (:mod:`slidepipe.mechanics.explicit_kernel`).
"""

import numpy as np
from numba import njit, prange

from slidepipe.mechanics.contact_kernel import contact_force
from slidepipe.mechanics.explicit_kernel import GRAVITY, STAGES, explicit_step, slide_rate, stable_step
from slidepipe.mechanics.hand_kernel import FAST, angle_at, hand_at, hand_velocity, piece_of

ORDER = 7
STUCK, SLIDING, LEFT, FAILED = 0, 1, 2, 3
"""How a trial ends: held, sliding, with the contact beyond the face, or with a step that could not be taken."""
FIRST_STEP_S = 1e-3
SCALES = np.array([1.0, 1.0, 10.0, 3.0, 3.0, 30.0])
"""Tolerances beside that of the place in {b}, m: of the angle, the speeds and the spin."""
CHEAPER = 0.4
"""An explicit step may be this much shorter than an implicit one."""
IDLE = 0.01
"""Error of an explicit step, held short by stability, below which an implicit one may be longer than it was."""
MOST_GROWTH = 5.0
"""From one step to the next."""
LEAVE = 0.85
"""Share of the time until a slide stops that a step may take."""
REST = 0.1
"""Share of the tolerance that the rest of a slide may be worth, to be taken as a parabola."""
SCANS = 6
"""Places in each piece of the hand's motion where a sticking grip is looked at."""
MOST_STEPS = 4000
INSIDE = 1.0 - 1e-13


@njit(**FAST)
def free_acceleration(breaks, coefficients, body, r, theta, t):
    """Offset and relative acceleration without friction of a contact that sticks: (r_x, r_y, b_x, b_y, b_theta)."""
    _v0, _v1, omega, a_x, a_y, alpha = hand_at(breaks, coefficients, body[4], t)
    c, s = np.cos(theta), np.sin(theta)
    r_x, r_y = c * r[0] - s * r[1], s * r[0] + c * r[1]
    spin = omega * omega
    return r_x, r_y, a_x + spin * r_x, a_y + GRAVITY + spin * r_y, alpha


@njit(**FAST)
def stick_load(breaks, coefficients, body, r, t):
    """Share of the friction that sticking needs at t, eq. (17); ``r`` is the relative pose in {b}."""
    theta = angle_at(breaks, coefficients, body[4], t) - r[2]
    r_x, r_y, b_x, b_y, alpha = free_acceleration(breaks, coefficients, body, r, theta, t)
    m, inertia, force, rho = body[0], body[1], body[2], body[3]
    f_x, f_y = m * (b_x + alpha * r_y), m * (b_y - alpha * r_x)
    moment = inertia * alpha - (r_x * f_y - r_y * f_x)
    return np.sqrt(f_x * f_x + f_y * f_y + (moment / rho) ** 2) / force


@njit(**FAST)
def euler(breaks, coefficients, body, t, near, h, parts, y, k, new):
    """Implicit Euler from y at t over ``parts`` steps of h into ``new``; returns k of the contact, -1 if it stuck."""
    h_m, h_i = h / body[0], h / body[1]
    for i in range(6):
        new[i] = y[i]
    for part in range(1, parts + 1):
        h0, h1, h2 = hand_velocity(breaks, coefficients, body[4], t + part * h, near)
        c, s = np.cos(new[2]), np.sin(new[2])
        r_x, r_y = c * new[0] - s * new[1], s * new[0] + c * new[1]
        v_y = new[4] - h * GRAVITY
        b_x, b_y, b_w = h0 - new[3] + new[5] * r_y, h1 - v_y - new[5] * r_x, h2 - new[5]
        f_x, f_y, m_z, k = contact_force(h_m, h_i, body[2], body[3], r_x, r_y, b_x, b_y, b_w, k)
        if k <= 0.0:
            return -1.0
        new[3] += h_m * f_x
        new[4] = v_y + h_m * f_y
        new[5] += h_i * (m_z + r_x * f_y - r_y * f_x)
        d_x, d_y = h0 - new[3] + new[5] * r_y, h1 - new[4] - new[5] * r_x
        new[0] += h * (c * d_x + s * d_y)
        new[1] += h * (-s * d_x + c * d_y)
        new[2] += h * new[5]
    return k


@njit(**FAST)
def implicit_step(breaks, coefficients, body, tolerance, t, y, h, k, table):
    """One extrapolated step from y at t into ``table[0]``, of the lowest order that is good enough.

    Returns (error over tolerance, k, the next step's length: that which gets furthest for its work); the first two are
    -1 if it stuck on the way.
    """
    near, work, least, error, longest = piece_of(breaks, t), 0.0, np.inf, np.inf, 0.0
    for row in range(ORDER):
        parts = row + 1
        k = euler(breaks, coefficients, body, t, near, h / parts, parts, y, k, table[row])
        if k < 0.0:
            return -1.0, k, h
        for lower in range(row - 1, -1, -1):
            share = (lower + 1.0) / (parts - lower - 1.0)
            for i in range(6):
                table[lower, i] = table[lower + 1, i] + (table[lower + 1, i] - table[lower, i]) * share
        work += parts
        if row == 0:
            continue
        total = 0.0
        for i in range(6):
            total += ((table[0, i] - table[1, i]) / (tolerance * SCALES[i])) ** 2
        error = np.sqrt(total / 6.0)
        length = h * min(MOST_GROWTH, 0.9 * error ** (-1.0 / parts)) if error > 0.0 else MOST_GROWTH * h
        if work < least * length:
            least, longest = work / length, length
            # The next order up may get further yet.
            ahead = (work + parts + 1) / work if row < ORDER - 1 else 1.0
        else:
            ahead = 1.0
        if error <= 1.0 and row >= 2:
            return error, k, min(MOST_GROWTH * h, longest * ahead)
    return error, k, longest


@njit(**FAST)
def sliding(breaks, coefficients, body, t, y, d):
    """Sliding velocity in {b} into ``d``, eq. (18); returns its size, with spin counted by rho, and the size's rate."""
    h0, h1, h2, a_x, a_y, alpha = hand_at(breaks, coefficients, body[4], t)
    c, s = np.cos(y[2]), np.sin(y[2])
    r_x, r_y = c * y[0] - s * y[1], s * y[0] + c * y[1]
    d_x, d_y, d_w = h0 - y[3] + y[5] * r_y, h1 - y[4] - y[5] * r_x, h2 - y[5]
    d[0], d[1], d[2] = c * d_x + s * d_y, -s * d_x + c * d_y, d_w
    square = body[3] * body[3]
    speed = np.sqrt(d_x * d_x + d_y * d_y + square * d_w * d_w)
    if speed == 0.0:
        return 0.0, 0.0
    share = body[2] / speed
    f_x, f_y, m_z = share * d_x, share * d_y, share * square * d_w
    spin_rate = (m_z + r_x * f_y - r_y * f_x) / body[1]
    spin = y[5] * y[5]
    e_x = a_x - f_x / body[0] + spin_rate * r_y + spin * r_x + y[5] * d_y
    e_y = a_y - f_y / body[0] + GRAVITY - spin_rate * r_x + spin * r_y - y[5] * d_x
    return speed, (d_x * e_x + d_y * e_y + square * d_w * (alpha - spin_rate)) / speed


@njit(**FAST)
def find_onset(breaks, coefficients, body, r, start, stop):
    """First time in [start, stop] at which the grip needs more friction than there is; ``stop`` if there is none."""
    low = start
    if stick_load(breaks, coefficients, body, r, start) > 1.0:
        return start
    for piece in range(len(breaks) - 1):
        if breaks[piece + 1] <= start or breaks[piece] >= stop:
            continue
        for scan in range(1, SCANS + 1):
            high = breaks[piece] + (breaks[piece + 1] - breaks[piece]) * scan / SCANS
            high = min(high, stop)
            if high <= low:
                continue
            # At the end of a phase it is the side before the jump that counts.
            inside = high - 1e-12 if scan == SCANS or high == stop else high
            if stick_load(breaks, coefficients, body, r, inside) > 1.0:
                return bisect(breaks, coefficients, body, r, low, inside)
            low = high
    return stop


@njit(**FAST)
def bisect(breaks, coefficients, body, r, low, high):
    """Time between ``low`` and ``high`` at which the load passes one."""
    while high - low > 1e-15 + 4e-16 * abs(high):
        middle = 0.5 * (low + high)
        if middle <= low or middle >= high:
            break
        if stick_load(breaks, coefficients, body, r, middle) > 1.0:
            high = middle
        else:
            low = middle
    return high


@njit(**FAST)
def begin_slide(breaks, coefficients, body, r, t, y):
    """State of an object that still moves with the hand, at the moment when its grip gives way."""
    h0, h1, h2, _a0, _a1, _a2 = hand_at(breaks, coefficients, body[4], t)
    theta = angle_at(breaks, coefficients, body[4], t) - r[2]
    c, s = np.cos(theta), np.sin(theta)
    r_x, r_y = c * r[0] - s * r[1], s * r[0] + c * r[1]
    y[0], y[1], y[2] = r[0], r[1], theta
    y[3], y[4], y[5] = h0 + h2 * r_y, h1 - h2 * r_x, h2


@njit(**FAST)
def advance(breaks, coefficients, body, tolerance, t, limit, y, speed, left, steps, table, work):
    """Try one step from y at t, no further than ``limit``, by whichever method gets further for its work.

    ``steps`` holds what is tried next: the lengths of an implicit and of an explicit step, k of the contact, and one
    if ``work[0]`` holds the rate at t. Returns (length tried, whether y went on, whether to ``limit``).
    """
    stable = min(steps[1], stable_step(body, y, speed))
    stiff = stable < CHEAPER * steps[0]
    h = min(steps[0] if stiff else stable, LEAVE * left)
    at_limit = h >= limit - t
    # A phase ends just before the acceleration jumps.
    h = (limit - t) * INSIDE if at_limit else h
    if stiff:
        error, k, longest = implicit_step(breaks, coefficients, body, tolerance, t, y, h, steps[2], table)
        good, steps[3] = 0.0 <= error <= 1.0, 0.0
        if good:
            steps[0], steps[1], steps[2] = longest, 2.0 * steps[1], k
        else:
            steps[0] = 0.5 * h if not error >= 0.0 else min(0.9 * h, max(0.2 * h, longest))
    else:
        if steps[3] == 0.0:
            slide_rate(breaks, coefficients, body, t, piece_of(breaks, t), y, work[0])
        error = explicit_step(breaks, coefficients, body, tolerance, SCALES, t, y, h, work, table[0])
        good = error <= 1.0
        steps[1] = h * min(MOST_GROWTH, max(0.2, 0.9 * error**-0.125)) if error > 0.0 else MOST_GROWTH * h
        steps[2], steps[3] = 0.0, 1.0
        if good:
            # The rate goes on where the acceleration jumps.
            work[0, :] = work[STAGES]
            if error < IDLE:
                steps[0] *= 1.5
    if good:
        y[:] = table[0]
    return h, good, at_limit


@njit(**FAST)
def slide(breaks, coefficients, jumps, body, tolerance, end, r, t, y, table, work, path, count):
    """Integrate a slide until it stops, leaves the face or ``end`` comes: (time, ended as, knots in ``path``)."""
    steps, d = np.array([FIRST_STEP_S, np.inf, 0.0, 0.0]), np.empty(3)
    jump, left, speed, peak = 0, np.inf, 0.0, 0.0
    for _ in range(MOST_STEPS):
        while jump < len(breaks) and (breaks[jump] <= t or not jumps[jump]):
            jump += 1
        limit = min(end, breaks[jump]) if jump < len(breaks) else end
        h, good, at_limit = advance(breaks, coefficients, body, tolerance, t, limit, y, speed, left, steps, table, work)
        if not good:
            if h < 1e-14:
                return t, FAILED, count
            continue
        t = limit if at_limit else t + h
        speed, rate = sliding(breaks, coefficients, body, t, y, d)
        peak = max(peak, speed)
        r[0], r[1], r[2] = y[0], y[1], angle_at(breaks, coefficients, body[4], t) - y[2]
        if count < len(path):
            path[count, 0] = t
            path[count, 1:4] = r
            path[count, 4:7] = d
            count += 1
        if abs(y[0]) > body[5] or abs(y[1]) > body[6]:
            return t, LEFT, count
        # Where the acceleration has jumped, even a slide at its fastest may be about to turn.
        left = -speed / rate if rate < 0.0 and (speed < peak or at_limit) else np.inf
        if 0.5 * left * speed < REST * tolerance:
            for i in range(3):
                r[i] += 0.5 * left * d[i]
            return t + left, STUCK, count
        if t >= end:
            return t, SLIDING, count
    return t, FAILED, count


@njit(**FAST)
def run_trial(breaks, coefficients, jumps, body, tolerance, end, r, path, out):
    """Run one trial; ``r`` goes from the first to the last relative pose.

    ``body`` is (m, I, mu f_N, c a, hand scale, half length, half width); ``out`` receives (ended as, slides, begun,
    ended, knots).
    """
    y, table, work = np.empty(6), np.empty((ORDER, 6)), np.empty((STAGES + 1, 6))
    t, ended, slides, begun, stopped, count = breaks[0], STUCK, 0, np.nan, np.nan, 0
    jump = 1
    while t < end and slides < MOST_STEPS:
        while jump < len(breaks) and (breaks[jump] <= t or not jumps[jump]):
            jump += 1
        limit = min(end, breaks[jump]) if jump < len(breaks) else end
        t = find_onset(breaks, coefficients, body, r, t, limit)
        if t >= limit:
            continue
        slides += 1
        if slides == 1:
            begun = t
        begin_slide(breaks, coefficients, body, r, t, y)
        t, ended, count = slide(breaks, coefficients, jumps, body, tolerance, end, r, t, y, table, work, path, count)
        stopped = t
        if ended != STUCK:
            break
    out[0], out[1], out[2], out[3], out[4] = ended, slides, begun, stopped, count


@njit(parallel=True, **FAST)
def run_batch(breaks, coefficients, jumps, bodies, tolerance, end, r, out):
    """Run many trials on all cores; ``bodies`` (N, 7), ``r`` (N, 3) and ``out`` (N, 5) row by row."""
    for trial in prange(len(bodies)):
        path = np.empty((0, 7))
        run_trial(breaks, coefficients, jumps, bodies[trial], tolerance, end, r[trial], path, out[trial])
