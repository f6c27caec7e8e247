"""What a choice of motion is worth, compiled: limits broken, friction error survived, and one number to minimise."""

import numpy as np
from numba import njit, prange

from slidepipe.planning.arm_kernel import OFFSETS, arm_share
from slidepipe.planning.grip_kernel import face_share, phase_load, stick_share
from slidepipe.planning.profile_kernel import (
    BRAKE,
    CATCH,
    COLUMNS,
    FAST,
    PHASES,
    SETTLE,
    STICK,
    TEAR,
    fill_evenly,
    hand_pieces,
)
from slidepipe.planning.trial_kernel import error_survived, straight_error, straight_length

GRID_S = 1e-4
"""Durations are whole numbers of this, so that a plan can be read."""
ACCELERATION_UNIT = 20.0
"""Hand acceleration that counts one, m/s^2."""
ANGLE, LOG_STICK, LOG_TEAR, LOG_BRAKE, CATCH_SHARE, LOG_SETTLE, LOG_FORCE = range(7)
"""Entries of a choice: the object's angle at the start of sliding, logarithms of T1, T2, T3 / T2, Tc / T2, that of
T4, and that of the grip force beside the believed one."""
CHOICES = 7
(
    EXCESS, LENGTH_S, HAND_ACCELERATION, HAND_SPEED, OFF_CENTRE, FACE_SHARE, LOAD_BEFORE, LOAD_AFTER, ARM_SHARE,
    ERROR, COST,
) = range(11)  # fmt: skip
FIGURES = 11
FOR_TIME, FOR_ACCELERATION, FOR_ERROR, FOR_LOAD, FOR_FORCE, DEMANDED, MOST, WISHES = range(8)
SURVIVES_TOO_LITTLE, BREAKS_LIMITS = 50.0, 100.0
"""Costs from which on a choice does not do."""
FORCE_GRID = 1e-4
"""Of the grip force beside the believed one: nobody sets a gripper finer."""


@njit(**FAST)
def rounded(duration):
    """A duration on the grid that plans are written with, s."""
    return round(duration / GRID_S) * GRID_S


@njit(**FAST)
def force_share(choice):
    """Grip force beside the believed one, on its grid."""
    return round(np.exp(choice[LOG_FORCE]) / FORCE_GRID) * FORCE_GRID


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
def over(value, bound):
    """By what share a value is beyond its bound."""
    return max(0.0, value / bound - 1.0)


@njit(**FAST)
def hand_figures(times, tables, limits, figures):
    """Figures of the hand: accelerations, speeds, how far off the middle of the workspace."""
    for phase in range(PHASES):
        if times[phase] <= 0.0:
            continue
        for row in tables[phase]:
            figures[HAND_ACCELERATION] = max(figures[HAND_ACCELERATION], np.hypot(row[15], row[16]))
            figures[HAND_SPEED] = max(figures[HAND_SPEED], np.hypot(row[12], row[13]))
            off = np.hypot(row[9] - limits[2], row[10] - limits[3])
            figures[OFF_CENTRE] = max(figures[OFF_CENTRE], off)


@njit(**FAST)
def arm_figure(times, tables, arm, offsets, figures):
    """Largest share of the arm's limits that a motion asks."""
    values = np.empty((OFFSETS, arm.shape[1]))
    for phase in range(PHASES):
        if times[phase] <= 0.0:
            continue
        for node in range(tables.shape[1]):
            share = arm_share(arm, offsets[phase, node], tables[phase, node], values)
            figures[ARM_SHARE] = max(figures[ARM_SHARE], share)


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
    """By how much all limits together are broken, those not yet known left out; ``rest`` is the hand's last row."""
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
def hopeless(times, body, d, wish, simulated, beat):
    """Whether a choice costs more than ``beat``, which does, for its durations alone."""
    if beat >= SURVIVES_TOO_LITTLE:
        return False
    most = wish[MOST]
    if not simulated:
        # By the formula, with more friction than this it does not slide at all.
        tear = 2.0 * straight_length(d, body[3]) / (times[TEAR] * (times[TEAR] + times[BRAKE]))
        most = min(most, tear * body[0] / body[2])
    return most < wish[DEMANDED] or wish[FOR_TIME] * np.sum(times) - wish[FOR_ERROR] * most >= beat


@njit(**FAST)
def survived(breaks, coefficients, jumps, body, task, wish, rest, beat):
    """Friction error that simulated trials survive, -1 where that is too little to cost less than ``beat``.

    ``rest`` is what a choice costs beside.
    """
    r_goal, least = task[1] + task[2], wish[DEMANDED]
    if beat < SURVIVES_TOO_LITTLE and wish[FOR_ERROR] > 0.0:
        least = max(least, (rest - beat) / wish[FOR_ERROR])
    if least > wish[MOST]:
        return -1.0
    found = error_survived(breaks, coefficients, jumps, body, task[1], r_goal, least, wish[MOST])
    if found < 0.0 and beat >= SURVIVES_TOO_LITTLE:
        found = max(0.0, error_survived(breaks, coefficients, jumps, body, task[1], r_goal, 0.0, least))
    return found


@njit(**FAST)
def assess(choice, problem, simulated, beat, figures):
    """Fill ``figures`` for a choice; one that cannot cost less than ``beat`` may be given up with an infinite cost.

    ``problem`` is (body, fingers, task, limits, arm, offsets, wish, nodes, integral, powers). ``task`` (5, 3): start
    pose of the object, r_start, d, end pose of the object (NaN where free), and (free angle, -, -). ``limits`` (9,):
    hand acceleration and speed, workspace (x, y, radius), load while sticking, region (x, y, radius). ``arm`` and
    ``offsets`` are those of :mod:`slidepipe.planning.arm_kernel`, the latter node by node. ``wish`` (WISHES,): weights
    of what is to be small or large, the friction error demanded and the most that counts. Friction errors are
    ``simulated`` or taken from the formula of a straight slide.
    """
    body, fingers, task, limits, arm, offsets, wish, nodes, integral, powers = problem
    N, times = len(nodes), np.zeros(PHASES)
    read_choice(choice, times)
    gripped, grip, force = fingers.copy(), body.copy(), force_share(choice)
    gripped[:, 0] *= force
    grip[2] *= force
    figures[:] = 0.0
    figures[COST], figures[LENGTH_S] = np.inf, np.sum(times)
    if hopeless(times, grip, task[2], wish, simulated, beat):
        return
    tables, q_start, q_slide, dq_slide = np.empty((PHASES, N, COLUMNS)), np.empty(3), np.empty(3), np.empty(3)
    angle = choice[ANGLE]
    fill_evenly(grip, gripped, task, angle, times, tables, nodes, integral, q_start, q_slide, dq_slide)
    bound, last = (1.0 - wish[DEMANDED]) * limits[5], tables[SETTLE, N - 1]
    hand_figures(times, tables, limits, figures)
    if excess(figures, limits, bound, last) > max(0.0, beat - BREAKS_LIMITS):
        return
    arm_figure(times, tables, arm, offsets, figures)
    if excess(figures, limits, bound, last) > max(0.0, beat - BREAKS_LIMITS):
        return
    held = grip_figures(grip, gripped, task[1], task[2], times, tables, figures)
    figures[EXCESS] = excess(figures, limits, bound, last)
    if figures[EXCESS] > 0.0:
        figures[COST] = BREAKS_LIMITS + figures[EXCESS]
        return
    rest = (
        wish[FOR_TIME] * figures[LENGTH_S]
        + wish[FOR_ACCELERATION] * figures[HAND_ACCELERATION] / ACCELERATION_UNIT
        + wish[FOR_LOAD] * (figures[LOAD_BEFORE] + figures[LOAD_AFTER])
        + wish[FOR_FORCE] * abs(choice[LOG_FORCE])
    )
    if simulated:
        breaks, coefficients, jumps = hand_pieces(times, tables, powers)
        figures[ERROR] = min(survived(breaks, coefficients, jumps, grip, task, wish, rest, beat), 1.0 - held)
        if figures[ERROR] < 0.0:
            return
    else:
        figures[ERROR] = min(wish[MOST], straight_error(grip, gripped, times, task[1] + task[2], task[2], held))
    if figures[ERROR] < wish[DEMANDED]:
        figures[COST] = SURVIVES_TOO_LITTLE + wish[DEMANDED] - figures[ERROR]
        return
    figures[COST] = rest - wish[FOR_ERROR] * figures[ERROR]


@njit(parallel=True, **FAST)
def assess_all(choices, problem, simulated, beat, figures):
    """Assess many choices (S, CHOICES) on all cores, each against ``beat``; ``figures`` (S, FIGURES)."""
    for index in prange(len(choices)):
        assess(choices[index], problem, simulated, beat, figures[index])
