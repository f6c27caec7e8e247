"""A slide of a pinched object under a moving hand, of high order, from the onset until it stops.

The state of a slide is ``(r_x, r_y, theta, v_x, v_y, omega)``: the finger's place in {b} and the object's angle and
velocities in {w}. The object's position follows from the hand's: nothing small is a difference of large numbers.

A slow slide is stiff: the direction of its friction settles within a time |dv| m / (mu f_N). Its steps are made of
implicit Euler's, whose contact is solved outright (:mod:`slidepipe.mechanics.contact_kernel`), in 1, 2 ... 7 parts that
are extrapolated to order seven at most, as in Hairer and Wanner's SEULEX. They start from rest by themselves, and a
slide that comes to its end is cut into steps that each leave a share of its speed. Where the slide is fast and its
direction changes, explicit steps of order eight get further (:mod:`slidepipe.mechanics.explicit_kernel`).

``hand`` is (breaks, coefficients) and ``body`` (m, I, mu f_N, c a, hand scale, half length, half width, curve): the
curve of :mod:`slidepipe.mechanics.curve_kernel`, or None for an ellipsoid.
"""

import numpy as np
from numba import njit

from slidepipe.mechanics.contact_kernel import contact_force
from slidepipe.mechanics.explicit_kernel import (
    GRAVITY,
    STAGES,
    explicit_step,
    slide_rate,
    sliding_friction,
    stable_step,
)
from slidepipe.mechanics.hand_kernel import FAST, hand_at, hand_velocity, piece_of

ORDER = 7
STUCK, SLIDING, LEFT, FAILED, GRAZED = 0, 1, 2, 3, 4
"""How a trial ends: held, sliding, with the contact beyond the face, or with a step that could not be taken; and a
slide, before it began."""
FIRST_STEP_S = 1e-2
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
MOST_STEPS = 4000
GRAZE_S = 1e-6
"""How long a grip at least holds on that is overloaded by so little that no step of a slide can be taken."""
SCRATCH = ORDER + STAGES + 3
"""Rows of memory that a slide needs."""
INSIDE = 1.0 - 1e-13


@njit(**FAST)
def euler(hand, body, t, near, h, parts, y, k, growth, new):
    """Implicit Euler from y at t over ``parts`` steps of h into ``new``; returns k of the contact, -1 if it stuck.

    ``k`` is that at t, and ``growth`` what it is expected to grow by in the first part: later ones go on alike.
    """
    h_m, h_i = h / body[0], h / body[1]
    y0, y1, theta, v_x, v_y, omega = y[0], y[1], y[2], y[3], y[4], y[5]
    for part in range(1, parts + 1):
        h0, h1, h2 = hand_velocity(hand[0], hand[1], body[4], t + part * h, near)
        c, s = np.cos(theta), np.sin(theta)
        r_x, r_y = c * y0 - s * y1, s * y0 + c * y1
        v_y -= h * GRAVITY
        b_x, b_y, b_w = h0 - v_x + omega * r_y, h1 - v_y - omega * r_x, h2 - omega
        before = k
        guess = max(k + growth, 0.0)
        f_x, f_y, m_z, k = contact_force(body[7], h_m, h_i, body[2], body[3], r_x, r_y, b_x, b_y, b_w, guess)
        if k <= 0.0:
            return -1.0
        growth = k - before
        v_x += h_m * f_x
        v_y += h_m * f_y
        omega += h_i * (m_z + r_x * f_y - r_y * f_x)
        d_x, d_y = h0 - v_x + omega * r_y, h1 - v_y - omega * r_x
        y0 += h * (c * d_x + s * d_y)
        y1 += h * (-s * d_x + c * d_y)
        theta += h * omega
    new[0], new[1], new[2], new[3], new[4], new[5] = y0, y1, theta, v_x, v_y, omega
    return k


@njit(**FAST)
def implicit_step(hand, body, tolerance, t, y, h, k, rate, table):
    """One extrapolated step from y at t into ``table[0]``, of the lowest order that is good enough.

    ``k`` is that of the contact at t and ``rate`` how fast it changes, zero if not known. Returns (error over
    tolerance, the next step's length: that which gets furthest for its work); the error is -1 if it stuck on the way.
    """
    near, work, least, error, longest = piece_of(hand[0], t), 0.0, np.inf, np.inf, 0.0
    for row in range(ORDER):
        parts = row + 1
        part = h / parts
        after = euler(hand, body, t, near, part, parts, y, k, rate * part, table[row])
        if after < 0.0:
            return -1.0, h
        rate = (after - k) / h
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
            return error, min(MOST_GROWTH * h, longest * ahead)
    return error, longest


@njit(**FAST)
def sliding(hand, body, t, y, d):
    """Sliding velocity in {b} into ``d``, eq. (18).

    Returns (its size, with spin counted by rho, the size's rate, the angle of the hand).
    """
    angle, h0, h1, h2, a_x, a_y, alpha = hand_at(hand[0], hand[1], body[4], t, piece_of(hand[0], t))
    c, s = np.cos(y[2]), np.sin(y[2])
    r_x, r_y = c * y[0] - s * y[1], s * y[0] + c * y[1]
    d_x, d_y, d_w = h0 - y[3] + y[5] * r_y, h1 - y[4] - y[5] * r_x, h2 - y[5]
    d[0], d[1], d[2] = c * d_x + s * d_y, -s * d_x + c * d_y, d_w
    square = body[3] * body[3]
    speed = np.sqrt(d_x * d_x + d_y * d_y + square * d_w * d_w)
    if speed == 0.0:
        return 0.0, 0.0, angle
    f_x, f_y, m_z = sliding_friction(body[7], body[2], body[3], d_x, d_y, d_w)
    spin_rate = (m_z + r_x * f_y - r_y * f_x) / body[1]
    spin = y[5] * y[5]
    e_x = a_x - f_x / body[0] + spin_rate * r_y + spin * r_x + y[5] * d_y
    e_y = a_y - f_y / body[0] + GRAVITY - spin_rate * r_x + spin * r_y - y[5] * d_x
    return speed, (d_x * e_x + d_y * e_y + square * d_w * (alpha - spin_rate)) / speed, angle


@njit(**FAST)
def advance(hand, body, tolerance, t, limit, y, speed, rate, left, steps, table, work):
    """Try one step from y at t, no further than ``limit``, by whichever method gets further for its work.

    ``speed`` and its ``rate`` are those at t. ``steps`` holds what is tried next, the lengths of an implicit and of an
    explicit step, and one if ``work[0]`` holds the rate of y. Returns (length tried, whether y went on,
    whether to ``limit``).
    """
    stable = min(steps[1], stable_step(body, y, speed))
    stiff = stable < CHEAPER * steps[0]
    h = min(steps[0] if stiff else stable, LEAVE * left)
    at_limit = h >= limit - t
    # A phase ends just before the acceleration jumps.
    h = (limit - t) * INSIDE if at_limit else h
    if stiff:
        force = body[2]
        error, longest = implicit_step(hand, body, tolerance, t, y, h, force * speed, force * rate, table)
        good, steps[2] = 0.0 <= error <= 1.0, 0.0
        if good:
            steps[0], steps[1] = longest, 2.0 * steps[1]
        else:
            steps[0] = 0.5 * h if not error >= 0.0 else min(0.9 * h, max(0.2 * h, longest))
    else:
        if steps[2] == 0.0:
            slide_rate(hand, body, t, piece_of(hand[0], t), y, work[0])
        error = explicit_step(hand, body, tolerance, SCALES, t, y, h, work, table[0])
        good = error <= 1.0
        steps[1] = h * min(MOST_GROWTH, max(0.2, 0.9 * error**-0.125)) if error > 0.0 else MOST_GROWTH * h
        steps[2] = 1.0
        if good:
            # The rate goes on where the acceleration jumps.
            work[0, :] = work[STAGES]
            if error < IDLE:
                steps[0] *= 1.5
    if good:
        y[:] = table[0]
    return h, good, at_limit


@njit(**FAST)
def slide(hand, jumps, body, tolerance, end, r, t, y, scratch, path, count):
    """Integrate a slide until it stops, leaves the face or ``end`` comes: (time, ended as, knots in ``path``)."""
    table, work, d, steps = scratch[:ORDER], scratch[ORDER:-2], scratch[-2], scratch[-1]
    steps[0], steps[1], steps[2] = FIRST_STEP_S, np.inf, 0.0
    breaks, jump, left, speed, rate, peak = hand[0], 0, np.inf, 0.0, 0.0, 0.0
    for _ in range(MOST_STEPS):
        while jump < len(breaks) and (breaks[jump] <= t or not jumps[jump]):
            jump += 1
        limit = min(end, breaks[jump]) if jump < len(breaks) else end
        h, good, at_limit = advance(hand, body, tolerance, t, limit, y, speed, rate, left, steps, table, work)
        if not good:
            if h < 1e-14:
                # A load that grazes what the grip bears: what slides is less than can be told.
                return t, GRAZED if speed * GRAZE_S <= REST * tolerance else FAILED, count
            continue
        t = limit if at_limit else t + h
        speed, rate, angle = sliding(hand, body, t, y, d)
        peak = max(peak, speed)
        r[0], r[1], r[2] = y[0], y[1], angle - y[2]
        if count < len(path):
            path[count, 0] = t
            path[count, 1:4] = r
            path[count, 4:7] = d[:3]
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
