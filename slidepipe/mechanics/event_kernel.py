"""Event-driven integration of a pinched object under a moving hand: exact stick, located slip, order eight between.

The state of a slide is ``(r_x, r_y, theta, v_x, v_y, omega)``: the finger's place in {b} and the object's angle and
velocities in {w}. The object's position follows from the hand's: nothing small is a difference of large numbers.
"""

import numpy as np
from numba import njit, prange
from scipy.integrate import DOP853

from slidepipe.mechanics.contact_kernel import contact_force

FAST = {"cache": True, "error_model": "numpy", "fastmath": {"contract", "arcp", "nsz", "reassoc"}}
"""Sums may be reordered and fused; NaN and infinity keep their meaning."""
STAGES = DOP853.n_stages
A, B, C, E3, E5 = (np.ascontiguousarray(table) for table in (DOP853.A, DOP853.B, DOP853.C, DOP853.E3, DOP853.E5))
GRAVITY = 9.81
STUCK, SLIDING, LEFT, FAILED = 0, 1, 2, 3
"""How a trial ends: held, still sliding, with the contact beyond the face, or with a step that could not be taken."""
FIRST_STEP_S = 1e-6
SCALES = np.array([1.0, 1.0, 50.0, 10.0, 10.0, 500.0])
"""Tolerances beside that of the place in {b}: speeds count by how far they carry in some 0.1 s."""
DIRECTION = 0.003
"""Share of the sliding speed that a step may be wrong by."""
REST = 0.1
"""Share of the tolerance that the rest of a slide may be worth, to be taken as a parabola."""
SCANS = 6
"""Places in each piece of the hand's motion where a sticking grip is looked at."""
MOST_STEPS = 4000


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
    v0, v1, v2, a0, a1, a2 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for d in range(coefficients.shape[1] - 1, 0, -1):
        c = coefficients[low, d]
        v0, v1, v2 = v0 * s + d * c[0], v1 * s + d * c[1], v2 * s + d * c[2]
        if d > 1:
            e = d * (d - 1)
            a0, a1, a2 = a0 * s + e * c[0], a1 * s + e * c[1], a2 * s + e * c[2]
    return scale * v0, scale * v1, scale * v2, scale * a0, scale * a1, scale * a2


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
def slide_rate(breaks, coefficients, body, t, y, rate):
    """Rate of the sliding state, eqs. (18) to (21); returns the sliding speed, with spin counted by rho."""
    h0, h1, h2, _a0, _a1, _a2 = hand_at(breaks, coefficients, body[4], t)
    c, s = np.cos(y[2]), np.sin(y[2])
    r_x, r_y = c * y[0] - s * y[1], s * y[0] + c * y[1]
    d_x = h0 - y[3] + y[5] * r_y
    d_y = h1 - y[4] - y[5] * r_x
    d_w = h2 - y[5]
    rho = body[3]
    speed = np.sqrt(d_x * d_x + d_y * d_y + rho * rho * d_w * d_w)
    share = body[2] / speed if speed > 0.0 else 0.0
    f_x, f_y, moment = share * d_x, share * d_y, share * rho * rho * d_w
    rate[0] = c * d_x + s * d_y
    rate[1] = -s * d_x + c * d_y
    rate[2] = y[5]
    rate[3] = f_x / body[0]
    rate[4] = f_y / body[0] - GRAVITY
    rate[5] = (moment + r_x * f_y - r_y * f_x) / body[1]
    return speed


@njit(**FAST)
def try_step(breaks, coefficients, body, tolerance, t, y, speed, h, work, new):
    """One step of order eight from y at t into ``new``; ``work[0]`` holds the rate at t. Returns the error's size.

    However small the sliding speed is, its direction must be told: velocities are good to a share of it.
    """
    for stage in range(1, STAGES):
        combine(A[stage], stage, y, h, work, new)
        slide_rate(breaks, coefficients, body, t + C[stage] * h, new, work[stage])
    combine(B, STAGES, y, h, work, new)
    slide_rate(breaks, coefficients, body, t + h, new, work[STAGES])
    five, three = 0.0, 0.0
    for i in range(6):
        e5, e3 = 0.0, 0.0
        for j in range(STAGES + 1):
            e5 += E5[j] * work[j, i]
            e3 += E3[j] * work[j, i]
        allowed = tolerance * SCALES[i]
        if i > 2:
            allowed = min(allowed, DIRECTION * (speed if i < 5 else speed / body[3]))
        scale = 1.0 / allowed
        five += (e5 * scale) ** 2
        three += (e3 * scale) ** 2
    if five == 0.0 and three == 0.0:
        return 0.0
    return abs(h) * five / np.sqrt((five + 0.01 * three) * 6.0)


@njit(**FAST)
def combine(weights, stages, y, h, work, new):
    """``y`` plus h times a weighted sum of the rates so far."""
    n0, n1, n2, n3, n4, n5 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for j in range(stages):
        w = weights[j]
        if w != 0.0:
            n0 += w * work[j, 0]
            n1 += w * work[j, 1]
            n2 += w * work[j, 2]
            n3 += w * work[j, 3]
            n4 += w * work[j, 4]
            n5 += w * work[j, 5]
    new[0], new[1], new[2] = y[0] + h * n0, y[1] + h * n1, y[2] + h * n2
    new[3], new[4], new[5] = y[3] + h * n3, y[4] + h * n4, y[5] + h * n5


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
    """State just after a slide begins: relative acceleration and friction agree; returns the time of that state."""
    theta = angle_at(breaks, coefficients, body[4], t) - r[2]
    r_x, r_y, b_x, b_y, b_w = free_acceleration(breaks, coefficients, body, r, theta, t)
    f_x, f_y, moment, _k = contact_force(1.0 / body[0], 1.0 / body[1], body[2], body[3], r_x, r_y, b_x, b_y, b_w, 0.0)
    h0, h1, h2, _a0, _a1, _a2 = hand_at(breaks, coefficients, body[4], t)
    step = FIRST_STEP_S
    y[0], y[1] = r[0], r[1]
    y[2] = theta + step * h2
    y[3] = h0 + h2 * r_y + step * f_x / body[0]
    y[4] = h1 - h2 * r_x + step * (f_y / body[0] - GRAVITY)
    y[5] = h2 + step * (moment + r_x * f_y - r_y * f_x) / body[1]
    return t + step


@njit(**FAST)
def slide(breaks, coefficients, jumps, body, tolerance, end, r, t, y, work, new, path, count):
    """Integrate a slide until it stops, leaves the face or ``end`` comes; ``r`` receives the relative pose.

    Returns (time, ended as, knots in ``path``).
    """
    speed = slide_rate(breaks, coefficients, body, t, y, work[0])
    h, jump, peak = FIRST_STEP_S, 0, speed
    for _ in range(MOST_STEPS):
        while jump < len(breaks) and (breaks[jump] <= t or not jumps[jump]):
            jump += 1
        limit = min(end, breaks[jump]) if jump < len(breaks) else end
        h = min(h, limit - t)
        error = try_step(breaks, coefficients, body, tolerance, t, y, speed, h, work, new)
        if not error <= 1.0:
            shrink = 0.9 * error ** (-0.125) if error < 1e30 else 0.2
            h *= max(0.2, shrink)
            if h < 1e-15:
                return t, FAILED, count
            continue
        at_limit = h >= limit - t
        t = limit if at_limit else t + h
        y[:] = new
        h *= min(6.0, 0.9 * error ** (-0.125)) if error > 0.0 else 6.0
        speed = slide_rate(breaks, coefficients, body, t, y, work[0])
        turn = angle_at(breaks, coefficients, body[4], t) - y[2]
        if count < len(path):
            path[count, 0] = t
            path[count, 1:7] = y
            path[count, 7] = turn
            count += 1
        r[0], r[1], r[2] = y[0], y[1], turn
        if abs(y[0]) > body[5] or abs(y[1]) > body[6]:
            return t, LEFT, count
        left = 0.5 * time_left(breaks, coefficients, body, t, y, work[0], speed)
        peak = max(peak, speed)
        if speed < 0.5 * peak and 0.0 < left * speed < REST * tolerance:
            r[0] += left * work[0, 0]
            r[1] += left * work[0, 1]
            r[2] += left * (hand_at(breaks, coefficients, body[4], t)[2] - y[5])
            return t + 2.0 * left, STUCK, count
        if t >= end:
            return t, SLIDING, count
    return t, FAILED, count


@njit(**FAST)
def time_left(breaks, coefficients, body, t, y, rate, speed):
    """Time in which a slide stops if it goes on slowing down as it does; zero if it does not slow down."""
    h0, h1, h2, a_x, a_y, alpha = hand_at(breaks, coefficients, body[4], t)
    c, s = np.cos(y[2]), np.sin(y[2])
    r_x, r_y = c * y[0] - s * y[1], s * y[0] + c * y[1]
    d_x, d_y, d_w = h0 - y[3] + y[5] * r_y, h1 - y[4] - y[5] * r_x, h2 - y[5]
    spin = y[5] * y[5]
    b_x = a_x - rate[3] + rate[5] * r_y + spin * r_x
    b_y = a_y - rate[4] - rate[5] * r_x + spin * r_y
    rho = body[3]
    slowing = -(d_x * b_x + d_y * b_y + rho * rho * d_w * (alpha - rate[5])) / speed
    return speed / slowing if slowing > 0.0 else 0.0


@njit(**FAST)
def run_trial(breaks, coefficients, jumps, body, tolerance, end, r, path, out):
    """Run one trial; ``r`` goes from the first to the last relative pose.

    ``body`` is (m, I, mu f_N, c a, hand scale, half length, half width); ``out`` receives (ended as, slides, begun,
    ended, knots).
    """
    y, new, work = np.empty(6), np.empty(6), np.empty((STAGES + 1, 6))
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
        t = begin_slide(breaks, coefficients, body, r, t, y)
        t, ended, count = slide(breaks, coefficients, jumps, body, tolerance, end, r, t, y, work, new, path, count)
        stopped = t
        if ended != STUCK:
            break
    out[0], out[1], out[2], out[3], out[4] = ended, slides, begun, stopped, count


@njit(parallel=True, **FAST)
def run_batch(breaks, coefficients, jumps, bodies, tolerance, end, r, out):
    """Run many trials on all cores; ``bodies`` (N, 7), ``r`` (N, 3) and ``out`` (N, 5) row by row."""
    for trial in prange(len(bodies)):
        path = np.empty((0, 8))
        run_trial(breaks, coefficients, jumps, bodies[trial], tolerance, end, r[trial], path, out[trial])
