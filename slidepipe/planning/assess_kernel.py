"""What a choice of motion is worth, compiled: limits broken, friction error survived, and one number to minimise."""

import numpy as np
from numba import njit, prange

from slidepipe.mechanics.event_kernel import run_trial
from slidepipe.mechanics.load_kernel import certified_load
from slidepipe.mechanics.slide_kernel import STUCK
from slidepipe.planning.profile_kernel import (
    BRAKE,
    CATCH,
    COLUMNS,
    FAST,
    GRAVITY,
    PHASES,
    SETTLE,
    STICK,
    TEAR,
    even_velocity,
    fill,
    hand_pieces,
)

GRID_S = 1e-4
"""Durations are whole numbers of this, so that a plan can be read."""
MOST_TURN_RAD = 0.3
"""An object that turned further in the hand than it was to is lost."""
REST_S = 0.5
SEARCH_TOLERANCE_M = 1e-6
ERROR_STEP = 0.03
ACCELERATION_UNIT = 20.0
"""Hand acceleration that counts one, m/s^2."""
LOST = 1.5
"""Measure of a trial whose object is lost; from one on it is no better than not to have tried."""
ANGLE, LOG_STICK, LOG_TEAR, LOG_BRAKE, CATCH_SHARE, LOG_SETTLE, LOG_FORCE = range(7)
"""Entries of a choice: the object's angle at the start of sliding, logarithms of T1, T2, T3 / T2, Tc / T2, that of
T4, and that of the grip force beside the believed one."""
CHOICES = 7
(
    EXCESS, LENGTH_S, HAND_ACCELERATION, HAND_SPEED, OFF_CENTRE, FACE_SHARE, LOAD_BEFORE, LOAD_AFTER, ARM_SHARE,
    ERROR, COST,
) = range(11)  # fmt: skip
FIGURES = 11
FOR_TIME, FOR_ACCELERATION, FOR_ERROR, FOR_LOAD, FOR_FORCE, DEMANDED, MOST, SIMULATED = range(8)
WISHES = 8
POSE, ANGLES, WEIGHT, DRY, VISCOUS, MIDDLE, HALF, SPEED, ACCELERATION, TORQUE, ARM_ROWS = range(9, 20)
"""Rows of the arm's local model, after three of its joints' rates, three of its torques and three of its elbow."""
SURVIVES_TOO_LITTLE, BREAKS_LIMITS = 50.0, 100.0
"""Costs from which on a choice does not do."""


@njit(**FAST)
def rounded(duration):
    """A duration on the grid that plans are written with, s."""
    return round(duration / GRID_S) * GRID_S


@njit(**FAST)
def read_choice(choice, times):
    """Durations of the phases."""
    T2 = np.exp(choice[LOG_TEAR])
    times[STICK] = rounded(np.exp(choice[LOG_STICK]))
    times[TEAR] = rounded(T2)
    times[BRAKE] = rounded(T2 * np.exp(choice[LOG_BRAKE]))
    times[CATCH] = rounded(T2 * choice[CATCH_SHARE])
    times[SETTLE] = rounded(np.exp(choice[LOG_SETTLE]))


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
    """Worse measure of a trial with that much less friction and one with that much more."""
    worst = 0.0
    for ratio in (1.0 - error, 1.0 + error):
        ended = tried(breaks, coefficients, jumps, body, ratio, SEARCH_TOLERANCE_M, r_start, r)
        worst = max(worst, measure(body, r, ended, r_start, r_goal, body[3]))
    return worst


@njit(**FAST)
def error_survived(breaks, coefficients, jumps, body, r_start, r_goal, most, guess):
    """Largest friction error both ways that a lone finger's trial survives, interpolated between steps from a guess."""
    r = np.empty(3)
    error = min(max(guess, ERROR_STEP), most)
    worst = worst_of_two(breaks, coefficients, jumps, body, r_start, r_goal, error, r)
    way = 1.0 if worst < 1.0 else -1.0
    while True:
        last, before = worst, error
        if way > 0.0 and error >= most - 1e-9:
            return most
        if way < 0.0 and error <= 1e-9:
            return 0.0
        error = min(most, max(0.0, error + way * ERROR_STEP))
        worst = worst_of_two(breaks, coefficients, jumps, body, r_start, r_goal, error, r)
        if (worst < 1.0) != (last < 1.0):
            return before + (error - before) * (1.0 - last) / (worst - last)


@njit(**FAST)
def arm_share(arm, row):
    """Largest share of a joint's range, speed or torque that a node asks of the arm, near the pose of ``arm``.

    ``arm`` (ARM_ROWS, 7) is what :func:`slidepipe.arm.local_model.rows` makes.
    """
    x, y, angle = row[9] - arm[POSE, 0], row[10] - arm[POSE, 1], row[11] - arm[POSE, 2]
    worst = 0.0
    for joint in range(arm.shape[1]):
        q = arm[ANGLES, joint] + arm[0, joint] * x + arm[1, joint] * y + arm[2, joint] * angle
        speed = arm[0, joint] * row[12] + arm[1, joint] * row[13] + arm[2, joint] * row[14]
        torque = arm[3, joint] * row[15] + arm[4, joint] * row[16] + arm[5, joint] * row[17] + arm[WEIGHT, joint]
        drag = arm[DRY, joint] + arm[VISCOUS, joint] * abs(speed)
        off = abs(q - arm[MIDDLE, joint]) / arm[HALF, joint]
        worst = max(worst, off, abs(speed) / arm[SPEED, joint], (abs(torque) + drag) / arm[TORQUE, joint])
        change = arm[0, joint] * row[15] + arm[1, joint] * row[16] + arm[2, joint] * row[17]
        worst = max(worst, abs(change) / arm[ACCELERATION, joint])
    v_x = arm[6, 0] * row[12] + arm[6, 1] * row[13] + arm[6, 2] * row[14]
    v_y = arm[7, 0] * row[12] + arm[7, 1] * row[13] + arm[7, 2] * row[14]
    v_z = arm[8, 0] * row[12] + arm[8, 1] * row[13] + arm[8, 2] * row[14]
    return max(worst, np.sqrt(v_x * v_x + v_y * v_y + v_z * v_z) / arm[POSE, 3])


@njit(**FAST)
def over(value, bound):
    """By what share a value is beyond its bound."""
    return max(0.0, value / bound - 1.0)


@njit(**FAST)
def lay_out(choice, body, fingers, task, times, tables, nodes, integral, q_start, q_slide, dq_slide):
    """Fill the nodes of the motion that a choice stands for, and the object's state where it starts and slides."""
    even_velocity(body, fingers, task[1], task[2], times, choice[ANGLE], tables, nodes, integral, dq_slide)
    for axis in range(3):
        q_start[axis] = task[0, axis]
        q_slide[axis] = task[0, axis] + 0.5 * times[STICK] * dq_slide[axis]
    q_slide[2] = choice[ANGLE]
    if task[4, 0] > 0.0:
        q_start[2] = choice[ANGLE] - 0.5 * times[STICK] * dq_slide[2]
    fill(body, fingers, task[1], task[2], times, q_start, q_slide, dq_slide, task[3], tables, nodes, integral)


@njit(**FAST)
def hand_figures(times, tables, limits, arm, figures):
    """Figures of the hand and the arm: length, accelerations, speeds, how far off the middle of the workspace."""
    for phase in range(PHASES):
        if times[phase] <= 0.0:
            continue
        figures[LENGTH_S] += times[phase]
        for row in tables[phase]:
            figures[HAND_ACCELERATION] = max(figures[HAND_ACCELERATION], np.hypot(row[15], row[16]))
            figures[HAND_SPEED] = max(figures[HAND_SPEED], np.hypot(row[12], row[13]))
            off = np.hypot(row[9] - limits[2], row[10] - limits[3])
            figures[OFF_CENTRE] = max(figures[OFF_CENTRE], off)
            figures[ARM_SHARE] = max(figures[ARM_SHARE], arm_share(arm, row))


@njit(**FAST)
def grip_figures(body, fingers, r_start, d, times, tables, figures):
    """Figures of the grip: how far out on the face it slides, and its loads; returns that at rest, the larger one."""
    r_goal, before, after = r_start + d, tables[STICK, 0], tables[SETTLE, tables.shape[1] - 1]
    for phase in (TEAR, BRAKE):
        for row in tables[phase]:
            c, s = np.cos(row[2]), np.sin(row[2])
            x, y = row[9] - row[0], row[10] - row[1]
            share = face_share(body, fingers, c * x + s * y, -s * x + c * y, row[11] - row[2])
            figures[FACE_SHARE] = max(figures[FACE_SHARE], share)
    held_before = stick_share(body, fingers, r_start[0], r_start[1], r_start[2], before[2], 0.0, 0.0, 0.0)
    held_after = stick_share(body, fingers, r_goal[0], r_goal[1], r_goal[2], after[2], 0.0, 0.0, 0.0)
    figures[LOAD_BEFORE] = max(held_before, phase_load(body, fingers, r_start, tables[STICK]))
    figures[LOAD_AFTER] = max(held_after, phase_load(body, fingers, r_goal, tables[SETTLE]))
    if times[CATCH] > 0.0:
        figures[LOAD_AFTER] = max(figures[LOAD_AFTER], phase_load(body, fingers, r_goal, tables[CATCH]))
    return max(held_before, held_after)


@njit(**FAST)
def excess(figures, limits, bound, rest):
    """By how much all limits together are broken; ``rest`` is the hand's last row."""
    return (
        over(figures[HAND_ACCELERATION], limits[0])
        + over(figures[HAND_SPEED], limits[1])
        + over(figures[OFF_CENTRE], limits[4])
        + over(np.hypot(rest[9] - limits[6], rest[10] - limits[7]), limits[8])
        + over(figures[FACE_SHARE], 1.0)
        + over(figures[ARM_SHARE], 1.0)
        + over(figures[LOAD_BEFORE], bound)
        + over(figures[LOAD_AFTER], bound)
    )


@njit(**FAST)
def assess(choice, body, fingers, task, limits, arm, wish, nodes, integral, powers, figures):
    """Fill ``figures`` for a choice.

    ``task`` (5, 3): start pose of the object, r_start, d, end pose of the object (NaN where free), and (free angle,
    -, -). ``limits`` (9,): hand acceleration and speed, workspace (x, y, radius), load while sticking, region (x, y,
    radius). ``wish`` (WISHES,): weights of what is to be small or large, the friction error demanded and the most
    that counts, and whether friction errors are simulated or taken from the formula of a straight slide.
    """
    N, times = len(nodes), np.zeros(PHASES)
    tables, q_start, q_slide, dq_slide = np.empty((PHASES, N, COLUMNS)), np.empty(3), np.empty(3), np.empty(3)
    read_choice(choice, times)
    gripped, grip = fingers.copy(), body.copy()
    gripped[:, 0] *= np.exp(choice[LOG_FORCE])
    grip[2] *= np.exp(choice[LOG_FORCE])
    r_start, d = task[1], task[2]
    lay_out(choice, body, gripped, task, times, tables, nodes, integral, q_start, q_slide, dq_slide)
    figures[:] = 0.0
    hand_figures(times, tables, limits, arm, figures)
    held = grip_figures(body, gripped, r_start, d, times, tables, figures)
    figures[EXCESS] = excess(figures, limits, (1.0 - wish[DEMANDED]) * limits[5], tables[SETTLE, N - 1])
    if figures[EXCESS] > 0.0:
        figures[COST] = BREAKS_LIMITS + figures[EXCESS]
        return
    figures[ERROR] = min(wish[MOST], straight_error(grip, gripped, times, r_start + d, d, held))
    if wish[SIMULATED] > 0.0:
        breaks, coefficients, jumps = hand_pieces(times, tables, powers)
        survived = error_survived(breaks, coefficients, jumps, grip, r_start, r_start + d, wish[MOST], figures[ERROR])
        figures[ERROR] = min(survived, 1.0 - held)
    if figures[ERROR] < wish[DEMANDED]:
        figures[COST] = SURVIVES_TOO_LITTLE + wish[DEMANDED] - figures[ERROR]
        return
    figures[COST] = (
        wish[FOR_TIME] * figures[LENGTH_S]
        + wish[FOR_ACCELERATION] * figures[HAND_ACCELERATION] / ACCELERATION_UNIT
        - wish[FOR_ERROR] * figures[ERROR]
        + wish[FOR_LOAD] * (figures[LOAD_BEFORE] + figures[LOAD_AFTER])
        + wish[FOR_FORCE] * abs(choice[LOG_FORCE])
    )


@njit(**FAST)
def straight_error(body, fingers, times, r_goal, d, held):
    """Friction error that a straight slide survives, by formula.

    With tearing and braking accelerations r_2 and r_3 and the friction's kappa, friction that is less by a share e
    slides (1 + e kappa / r_2) / (1 - e kappa / r_3) times as far; it may slide twice as far, or to the edge of the
    face. More friction by r_2 / kappa does not slide at all.
    """
    length = np.sqrt(d[0] * d[0] + d[1] * d[1] + (body[3] * d[2]) ** 2)
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


@njit(parallel=True, **FAST)
def assess_all(choices, body, fingers, task, limits, arm, wish, nodes, integral, powers, figures):
    """Assess many choices (S, CHOICES) on all cores; ``figures`` (S, FIGURES)."""
    for index in prange(len(choices)):
        assess(choices[index], body, fingers, task, limits, arm, wish, nodes, integral, powers, figures[index])
