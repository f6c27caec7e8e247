"""Differential evolution, compiled: islands that evolve apart from each other, and a polish on the grid of durations.

Every island is evolved by one core from its own random numbers, so that the outcome does not depend on how many cores
there are. A trial choice is only assessed until it is clear that it does not beat the one it would replace.
"""

import numpy as np
from numba import njit, prange

from slidepipe.planning.assess_kernel import (
    ANGLE,
    CATCH_SHARE,
    FIGURES,
    GRID_S,
    LOG_BRAKE,
    LOG_SETTLE,
    LOG_STICK,
    LOG_TEAR,
    assess,
    read_choice,
)
from slidepipe.planning.assess_kernel import COST as FIGURE_COST
from slidepipe.planning.profile_kernel import BRAKE, CATCH, FAST, PHASES, SETTLE, STICK, TEAR

LEAST_STEP, STEP_RANGE, CROSSED = 0.3, 0.6, 0.85
"""Factor of a difference of two choices, at least and above, and share of the entries that a trial takes from it."""
TOWARDS_BEST = 0.7
"""Share of the trials that start from the island's best."""
POLISH_STEPS = (16, 4, 1)
"""Of durations on their grid."""
WORTH = 1e-4
"""Gain of a pass over all entries from which on another is made: a ridge may be followed for long, for nothing."""
ANGLE_STEP_RAD = 1e-3
"""Of the angle for one step of a duration."""
NO_GAIN = 1e-7


@njit(**FAST)
def trial_choice(population, best, at, low, high, trial):
    """A trial for the choice ``at``: a base and a difference of two others, crossed with it, within the bounds."""
    size, count = population.shape
    base = best if np.random.random() < TOWARDS_BEST else np.random.randint(size)
    one, other = np.random.randint(size), np.random.randint(size)
    step = LEAST_STEP + STEP_RANGE * np.random.random()
    sure = np.random.randint(count)
    for i in range(count):
        trial[i] = population[at, i]
        if i == sure or np.random.random() < CROSSED:
            trial[i] = population[base, i] + step * (population[one, i] - population[other, i])
            if trial[i] < low[i] or trial[i] > high[i]:
                # Between the base and the bound that was overstepped.
                bound = low[i] if trial[i] < low[i] else high[i]
                trial[i] = bound + np.random.random() * (population[base, i] - bound)


@njit(**FAST)
def evolve_island(population, costs, problem, simulated, low, high, rounds, close, seed):
    """Evolve a population (S, CHOICES) with its costs (S,) in place, until it has converged or for all rounds."""
    np.random.seed(seed)
    trial, figures = np.empty(population.shape[1]), np.empty(FIGURES)
    best = int(np.argmin(costs))
    for _ in range(rounds):
        for at in range(len(population)):
            trial_choice(population, best, at, low, high, trial)
            assess(trial, problem, simulated, costs[at], figures)
            if figures[FIGURE_COST] < costs[at]:
                population[at, :] = trial
                costs[at] = figures[FIGURE_COST]
                if costs[at] < costs[best]:
                    best = at
        if np.max(costs) - costs[best] < close:
            break


@njit(parallel=True, **FAST)
def evolve_islands(populations, costs, problem, simulated, low, high, rounds, close, seed):
    """Evolve islands (K, S, CHOICES) for some rounds, each by itself."""
    for island in prange(len(populations)):
        evolve_island(populations[island], costs[island], problem, simulated, low, high, rounds, close, seed + island)


@njit(**FAST)
def write_choice(times, choice):
    """The durations' entries of a choice, from the durations."""
    choice[LOG_STICK], choice[LOG_TEAR], choice[LOG_SETTLE] = (
        np.log(times[STICK]),
        np.log(times[TEAR]),
        np.log(times[SETTLE]),
    )
    choice[LOG_BRAKE], choice[CATCH_SHARE] = np.log(times[BRAKE] / times[TEAR]), times[CATCH] / times[TEAR]


@njit(**FAST)
def stepped(choice, low, high, one, other, step, trial):
    """A choice with one entry a step up and another a step down; False where that is out of bounds.

    Entries are the durations, then the angle; ``other`` of -1 is none.
    """
    times = np.empty(PHASES)
    read_choice(choice, times)
    trial[:] = choice
    for entry, change in ((one, step), (other, -step)):
        if 0 <= entry < PHASES:
            times[entry] += change * GRID_S
            if times[entry] < 0.5 * GRID_S and entry != CATCH:
                return False
        if entry == PHASES:
            trial[ANGLE] += change * ANGLE_STEP_RAD
    write_choice(times, trial)
    return np.all(trial >= low - NO_GAIN) and np.all(trial <= high + NO_GAIN)


@njit(**FAST)
def polish(choice, cost, problem, simulated, low, high):
    """Move a choice in place by whole steps, of one entry or of two against each other, while it pays; its cost."""
    trial, figures = np.empty(len(choice)), np.empty(FIGURES)
    for step in POLISH_STEPS:
        before = np.inf
        while before - cost > WORTH:
            before = cost
            for one in range(PHASES + 1):
                for other in range(-1, PHASES + 1):
                    for way in (step, -step):
                        if one == other or not stepped(choice, low, high, one, other, way, trial):
                            continue
                        assess(trial, problem, simulated, cost - NO_GAIN, figures)
                        if figures[FIGURE_COST] < cost - NO_GAIN:
                            choice[:] = trial
                            cost = figures[FIGURE_COST]
    return cost
