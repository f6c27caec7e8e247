"""A regrasp's motion from what was chosen for it, compiled: five phases, each a row of Chebyshev nodes.

The finger slides along the straight line ``r_f_b = r_start + s d`` with ``d = r_goal - r_start`` and ``s`` from 0 to
1, so that the friction wrench in {b} depends on ``s`` alone (eq. 14): the object's spin is an integral over ``s``,
its path an integral over its angle. Both are taken on the nodes, exact to rounding. Phases: stick (T1), tear (T2,
``s`` accelerates), brake (T3), catch (Tc: the hand goes on as it braked, so that an object which stops late stops on
the same line), settle (T4). A phase of no length is left out.
"""

import numpy as np
from numba import njit

FAST = {"cache": True, "error_model": "numpy", "fastmath": {"contract", "arcp", "nsz"}}
GRAVITY = 9.81
PHASES = 5
STICK, TEAR, BRAKE, CATCH, SETTLE = range(PHASES)
NEGLIGIBLE = 1e-10
"""Of a hand's polynomial over a phase, m or rad."""
COLUMNS = 18
"""Of a node: q_o, dq_o, ddq_o, q_f, dq_f, ddq_f."""


@njit(**FAST)
def slide_wrench(fingers, d, r_x, r_y, angle):
    """Friction wrench on the object about its CoM in {b} while the hand slides along ``d`` at relative pose r.

    ``fingers`` (n, 4) hold mu f_N, c a and the place in {f}. Returns (f_x, f_y, m_z): eqs. (14) and (15), summed.
    """
    c, s = np.cos(angle), np.sin(angle)
    f_x, f_y, m_z = 0.0, 0.0, 0.0
    for i in range(len(fingers)):
        force, rho = fingers[i, 0], fingers[i, 1]
        p_x = c * fingers[i, 2] - s * fingers[i, 3]
        p_y = s * fingers[i, 2] + c * fingers[i, 3]
        v_x, v_y, spin = d[0] - d[2] * p_y, d[1] + d[2] * p_x, rho * d[2]
        size = np.sqrt(v_x * v_x + v_y * v_y + spin * spin)
        if size == 0.0:
            continue
        share = force / size
        f_x += share * v_x
        f_y += share * v_y
        m_z += share * rho * spin + (r_x + p_x) * share * v_y - (r_y + p_y) * share * v_x
    return f_x, f_y, m_z


@njit(**FAST)
def integrate(integral, T, start, rate, values):
    """Values (N,) at the nodes from their rates there and the value at the phase's start."""
    for i in range(len(rate)):
        total = 0.0
        for j in range(len(rate)):
            total += integral[i, j] * rate[j]
        values[i] = start + T * total


@njit(**FAST)
def slide_phase(body, fingers, r_start, d, T, path, q, dq, table, nodes, integral):
    """Fill the nodes of a tear or brake; ``path`` is (s, s', s'') at its start, ``q`` and ``dq`` the object's state.

    Moves ``path``, ``q`` and ``dq`` to the phase's end.
    """
    N = len(nodes)
    rates = np.empty((3, N))
    wrench = np.empty((2, N))
    for i in range(N):
        t = T * nodes[i]
        s = path[0] + t * (path[1] + 0.5 * t * path[2])
        f_x, f_y, m_z = slide_wrench(fingers, d, r_start[0] + s * d[0], r_start[1] + s * d[1], r_start[2] + s * d[2])
        wrench[0, i], wrench[1, i], rates[2, i] = f_x / body[0], f_y / body[0], m_z / body[1]
    integrate(integral, T, dq[2], rates[2], table[:, 5])
    integrate(integral, T, q[2], table[:, 5], table[:, 2])
    for i in range(N):
        c, sn = np.cos(table[i, 2]), np.sin(table[i, 2])
        rates[0, i] = c * wrench[0, i] - sn * wrench[1, i]
        rates[1, i] = sn * wrench[0, i] + c * wrench[1, i] - GRAVITY
    for axis in range(2):
        integrate(integral, T, dq[axis], rates[axis], table[:, 3 + axis])
        integrate(integral, T, q[axis], table[:, 3 + axis], table[:, axis])
    for i in range(N):
        t = T * nodes[i]
        s, ds = path[0] + t * (path[1] + 0.5 * t * path[2]), path[1] + t * path[2]
        for axis in range(3):
            table[i, 6 + axis] = rates[axis, i]
        place_hand(table[i], r_start, d, s, ds, path[2])
    advance(table, N, q, dq)
    path[0] += T * (path[1] + 0.5 * T * path[2])
    path[1] += T * path[2]


@njit(**FAST)
def place_hand(row, r_start, d, s, ds, dds):
    """Hand's pose, velocity and acceleration of eq. (22) and its derivatives, from the object's in the same row."""
    c, sn = np.cos(row[2]), np.sin(row[2])
    omega, alpha = row[5], row[8]
    x, y = r_start[0] + s * d[0], r_start[1] + s * d[1]
    v_x, v_y = ds * d[0] - omega * y, ds * d[1] + omega * x
    a_x = dds * d[0] - 2.0 * omega * ds * d[1] - alpha * y - omega * omega * x
    a_y = dds * d[1] + 2.0 * omega * ds * d[0] + alpha * x - omega * omega * y
    row[9], row[10], row[11] = row[0] + c * x - sn * y, row[1] + sn * x + c * y, row[2] + r_start[2] + s * d[2]
    row[12], row[13], row[14] = row[3] + c * v_x - sn * v_y, row[4] + sn * v_x + c * v_y, omega + ds * d[2]
    row[15], row[16], row[17] = row[6] + c * a_x - sn * a_y, row[7] + sn * a_x + c * a_y, alpha + dds * d[2]


@njit(**FAST)
def advance(table, N, q, dq):
    """Object's state at the end of a phase."""
    for axis in range(3):
        q[axis], dq[axis] = table[N - 1, axis], table[N - 1, 3 + axis]


@njit(**FAST)
def stick_phase(r_start, d, s, T, q, dq, q_end, dq_end, table, nodes):
    """Fill the nodes of a phase in which the object goes with the hand on cubics; moves ``q`` and ``dq`` to its end."""
    N = len(nodes)
    for axis in range(3):
        step, start, end = q_end[axis] - q[axis], T * dq[axis], T * dq_end[axis]
        c2, c3 = 3.0 * step - 2.0 * start - end, start + end - 2.0 * step
        for i in range(N):
            u = nodes[i]
            table[i, axis] = q[axis] + u * (start + u * (c2 + u * c3))
            table[i, 3 + axis] = (start + u * (2.0 * c2 + 3.0 * u * c3)) / T
            table[i, 6 + axis] = (2.0 * c2 + 6.0 * u * c3) / (T * T)
    for i in range(N):
        place_hand(table[i], r_start, d, s, 0.0, 0.0)
    for axis in range(3):
        q[axis], dq[axis] = q_end[axis], dq_end[axis]


@njit(**FAST)
def catch_acceleration(row, r_goal, ddq):
    """Acceleration of an object that is stuck at ``r_goal`` to a hand which goes on as in ``row``."""
    c, sn = np.cos(row[2]), np.sin(row[2])
    x, y = c * r_goal[0] - sn * r_goal[1], sn * r_goal[0] + c * r_goal[1]
    omega, alpha = row[5], row[17]
    ddq[0] = row[15] + alpha * y + omega * omega * x
    ddq[1] = row[16] - alpha * x + omega * omega * y
    ddq[2] = alpha


@njit(**FAST)
def slide_and_catch(body, fingers, r_start, d, times, q, dq, tables, nodes, integral):
    """Fill tear, brake and catch from the object's state at the start of sliding, and move it to their end."""
    T2, T3, Tc = times[TEAR], times[BRAKE], times[CATCH]
    path = np.array([0.0, 0.0, 2.0 / (T2 * (T2 + T3))])
    slide_phase(body, fingers, r_start, d, T2, path, q, dq, tables[TEAR], nodes, integral)
    path[2] = -path[1] / T3
    slide_phase(body, fingers, r_start, d, T3, path, q, dq, tables[BRAKE], nodes, integral)
    if Tc > 0.0:
        ddq, q_end, dq_end = np.empty(3), np.empty(3), np.empty(3)
        catch_acceleration(tables[BRAKE, len(nodes) - 1], r_start + d, ddq)
        for axis in range(3):
            q_end[axis] = q[axis] + Tc * (dq[axis] + 0.5 * Tc * ddq[axis])
            dq_end[axis] = dq[axis] + Tc * ddq[axis]
        stick_phase(r_start, d, 1.0, Tc, q, dq, q_end, dq_end, tables[CATCH], nodes)


@njit(**FAST)
def fill(body, fingers, r_start, d, times, q_start, q_slide, dq_slide, q_end, tables, nodes, integral):
    """Fill all phases (PHASES, N, COLUMNS) of a motion; ``q_end`` is NaN where the settling decelerates evenly."""
    q, dq = q_start.copy(), np.zeros(3)
    stick_phase(r_start, d, 0.0, times[STICK], q, dq, q_slide, dq_slide, tables[STICK], nodes)
    slide_and_catch(body, fingers, r_start, d, times, q, dq, tables, nodes, integral)
    settle(r_start, d, times, q_end, q, dq, tables, nodes)


@njit(**FAST)
def settle(r_start, d, times, q_end, q, dq, tables, nodes):
    """Fill the last phase from the object's state at its start, to rest at ``q_end``, or evenly where that is NaN."""
    stop = np.empty(3)
    for axis in range(3):
        stop[axis] = q_end[axis] if q_end[axis] == q_end[axis] else q[axis] + 0.5 * times[SETTLE] * dq[axis]
    stick_phase(r_start, d, 1.0, times[SETTLE], q, dq, stop, np.zeros(3), tables[SETTLE], nodes)


@njit(**FAST)
def change(body, fingers, r_start, d, times, theta, omega, tables, nodes, integral, moved, gained):
    """How far a slide and catch that begin with the object at ``theta``, turning by ``omega``, else at rest, go.

    ``moved`` and ``gained`` receive the changes of the object's pose and velocity.
    """
    moved[0], moved[1], moved[2] = 0.0, 0.0, theta
    gained[0], gained[1], gained[2] = 0.0, 0.0, omega
    slide_and_catch(body, fingers, r_start, d, times, moved, gained, tables, nodes, integral)
    moved[2] -= theta
    gained[2] -= omega


@njit(**FAST)
def spin_gained(body, fingers, r_start, d, times, nodes, integral):
    """Spin that an object gains over a slide and catch, whatever it had: its torque depends on ``s`` alone."""
    N, T2, T3 = len(nodes), times[TEAR], times[BRAKE]
    tear = 2.0 / (T2 * (T2 + T3))
    s, ds, dds, gained, last = 0.0, 0.0, tear, 0.0, 0.0
    for T in (T2, T3):
        for i in range(N):
            t = T * nodes[i]
            at = s + t * (ds + 0.5 * t * dds)
            last = slide_wrench(fingers, d, r_start[0] + at * d[0], r_start[1] + at * d[1], r_start[2] + at * d[2])[2]
            gained += T * integral[N - 1, i] * last / body[1]
        s += T * (ds + 0.5 * T * dds)
        ds += T * dds
        dds = -ds / T3
    return gained + times[CATCH] * (last / body[1] - tear * T2 / T3 * d[2])


@njit(**FAST)
def fill_evenly(body, fingers, task, angle, times, tables, nodes, integral, q_start, q_slide, dq_slide):
    """Fill all phases of a motion for which the object accelerates the same while sticking before and after.

    ``angle`` is the object's at the start of sliding; ``task`` (5, 3) holds its start pose, r_start, d, its end pose
    (NaN where the settling decelerates evenly) and whether its angle at the start is free. The object's pose at the
    start, and its pose and velocity when it slides, are returned in ``q_start``, ``q_slide`` and ``dq_slide``.
    """
    share = times[STICK] / (times[STICK] + times[SETTLE])
    dq_slide[2] = -share * spin_gained(body, fingers, task[1], task[2], times, nodes, integral)
    q, dq = np.array([0.0, 0.0, angle]), np.array([0.0, 0.0, dq_slide[2]])
    slide_and_catch(body, fingers, task[1], task[2], times, q, dq, tables, nodes, integral)
    for axis in range(3):
        if axis < 2:
            dq_slide[axis] = -share * dq[axis]
        q_start[axis] = task[0, axis]
        q_slide[axis] = task[0, axis] + 0.5 * times[STICK] * dq_slide[axis]
    q_slide[2] = angle
    if task[4, 0] > 0.0:
        q_start[2] = angle - 0.5 * times[STICK] * dq_slide[2]
    move(times, q_slide, dq_slide, q, dq, tables, nodes)
    settle(task[1], task[2], times, task[3], q, dq, tables, nodes)
    q[:], dq[:] = q_start, 0.0
    stick_phase(task[1], task[2], 0.0, times[STICK], q, dq, q_slide, dq_slide, tables[STICK], nodes)


@njit(**FAST)
def move(times, q_slide, dq_slide, q, dq, tables, nodes):
    """Give a slide and catch, filled from rest at the origin, their place and velocity; ``q``, ``dq`` at their end."""
    before = 0.0
    for phase in (TEAR, BRAKE, CATCH):
        if times[phase] <= 0.0:
            continue
        for i in range(len(nodes)):
            row, t = tables[phase, i], before + times[phase] * nodes[i]
            for axis in range(2):
                moved = q_slide[axis] + t * dq_slide[axis]
                row[axis] += moved
                row[3 + axis] += dq_slide[axis]
                row[9 + axis] += moved
                row[12 + axis] += dq_slide[axis]
        before += times[phase]
    for axis in range(2):
        q[axis] += q_slide[axis] + before * dq_slide[axis]
        dq[axis] += dq_slide[axis]


@njit(**FAST)
def hand_pieces(times, tables, powers):
    """The hand's motion as polynomials in time, phase by phase, of no higher degree than it has.

    Returns the breaks (K + 1,), coefficients (K, D + 1, 3) and jumps (K + 1,) of a hand motion.
    """
    N, count, degree = powers.shape[0], 0, 2
    full = np.zeros((PHASES, N, 3))
    for phase in range(PHASES):
        if times[phase] <= 0.0:
            continue
        for power in range(N):
            for axis in range(3):
                for i in range(N):
                    full[count, power, axis] += powers[power, i] * tables[phase, i, 9 + axis]
                if abs(full[count, power, axis]) > NEGLIGIBLE:
                    degree = max(degree, power)
        count += 1
    breaks, jumps = np.zeros(count + 1), np.ones(count + 1, dtype=np.bool_)
    coefficients = np.empty((count, degree + 1, 3))
    count = 0
    for phase in range(PHASES):
        if times[phase] <= 0.0:
            continue
        for power in range(degree + 1):
            for axis in range(3):
                coefficients[count, power, axis] = full[count, power, axis] / times[phase] ** power
        breaks[count + 1] = breaks[count] + times[phase]
        count += 1
    return breaks, coefficients, jumps
