"""The search for a course: a population of choices, each assessed in some microseconds by the compiled motion.

First with the friction error of a straight slide's formula, which is rough and cheap; then, from the best of these,
with the error that simulated trials survive. Islands evolve by themselves on all cores, hand their best on to their
neighbours now and then, and end when they agree; the best choice of all is polished on the grid of durations.
"""

from dataclasses import dataclass, replace

import numpy as np

from slidepipe.arm.local_model import LocalModel
from slidepipe.mechanics.planar import object_pose
from slidepipe.planning import assess_kernel as kernel
from slidepipe.planning import evolve_kernel, profile_kernel
from slidepipe.planning.arm_kernel import OFFSETS
from slidepipe.planning.course import Course, finger_rows, lone
from slidepipe.planning.nodes import COARSE, FINE, nodes
from slidepipe.planning.planner import Setup
from slidepipe.planning.wish import Wish
from slidepipe.series import FloatArray

STICK_S, SLIDE_S = (0.1, 1.2), (0.02, 0.6)
"""Shortest and longest sticking phase, and tear."""
BRAKE_SHARE, CATCH_SHARE = (0.1, 2.5), (0.0, 1.0)
"""Of the tear's duration."""
SEED, STARTS = 1, 6
"""First seed of the random numbers, and with how many a search begins anew before it gives up."""
ISLANDS, SIZE = 2, 24
EPOCH, EPOCHS, FINAL_EPOCHS, REFINING_EPOCHS = 8, 10, 4, 3
"""Rounds between two exchanges of the islands' best, and how many exchanges at most."""
CLOSE = 2e-3
"""Costs that differ by less are alike."""
KEPT, LOOSE = 8, 0.08
"""How many of the best stay as they are between two searches, and by what share of their range the others move."""
ELSEWHERE = 16
"""How many choices of the second search begin anywhere."""
MOST_ERROR = 0.7
"""Friction errors beyond do not count."""
SMALL, SMALL_TIME = 1e-3, 0.02
"""Weights of what is not wished, so that nothing is left to chance."""
FORCE_FIRST = 10.0
"""Weight of a grip force near the believed one, where that is what is sought."""
LOAD_WEIGHT = 0.02
"""Of the friction in use while sticking: an arm that does not follow exactly needs some to spare."""


@dataclass(frozen=True, slots=True)
class Task:
    """What is asked: the object's pose at rest in {w} before, the finger in {b} before and after.

    ``q_f_end`` (3,) is where in {w} the hand is to come to rest, or None where that is free.
    """

    q_o_start: FloatArray
    r_start: FloatArray
    r_goal: FloatArray
    q_f_end: FloatArray | None


@dataclass(frozen=True, slots=True)
class Found:
    """The best choice of a search, its figures as ``assess_kernel`` numbers them, and what they were asked to be.

    ``population`` (S, CHOICES) is where a search of a task that is nearly the same may begin, the best first.
    """

    choice: FloatArray
    figures: FloatArray
    bounds: FloatArray
    population: FloatArray

    @property
    def feasible(self) -> bool:
        """Whether it keeps every limit and survives the friction error that is demanded."""
        return bool(self.figures[kernel.COST] < kernel.SURVIVES_TOO_LITTLE)

    @property
    def length_s(self) -> float:
        """Duration of the motion."""
        return float(self.figures[kernel.LENGTH_S])

    @property
    def force(self) -> float:
        """Normal force beside the believed one."""
        return float(kernel.force_share(self.choice))


@dataclass(frozen=True, slots=True)
class _Evolved:
    """A population (S, CHOICES), the best first, and the best one's cost."""

    population: FloatArray
    cost: float


@dataclass(frozen=True, slots=True)
class _LaidOut:
    """A choice's durations, its motion at nodes, and the object's state at the start and when it slides."""

    times: FloatArray
    tables: FloatArray
    q_start: FloatArray
    q_slide: FloatArray
    dq_slide: FloatArray


class Search:
    """A task with all that its choices are assessed by.

    ``offsets`` (PHASES, COARSE, OFFSETS, 7) is what the arm's local model misses node by node, where that is known.
    """

    def __init__(
        self, task: Task, setup: Setup, wish: Wish, arm: LocalModel, *, offsets: FloatArray | None = None
    ) -> None:
        self.task, self.setup, self.wish, self.arm = task, setup, wish, arm
        block, finger, limits = setup.block, setup.finger, setup.limits
        self._fingers = finger_rows(setup.fingers)
        self._body = np.array(
            [block.m, block.inertia, finger.mu * finger.f_N, finger.c * finger.a, 1.0, *setup.half_size_m]
        )
        self._task = np.array(_task_rows(task, wish), dtype=float)
        self.limits = np.array(
            [limits.hand_acceleration_m_s2, limits.tip_speed_m_s, *limits.workspace_centre_m,
             limits.workspace_radius_m, limits.stick_load, *limits.region_centre_m, limits.region_radius_m]
        )  # fmt: skip
        self.weights, grid = _wish_row(wish), nodes(COARSE)
        missed = self.no_offsets() if offsets is None else offsets
        self._problem = (
            self._body, self._fingers, self._task, self.limits, arm.rows(), missed, self.weights,
            grid.points, grid.integral, grid.powers,
        )  # fmt: skip

    @staticmethod
    def no_offsets() -> FloatArray:
        """Offsets of an arm whose local model misses nothing."""
        return np.zeros((profile_kernel.PHASES, COARSE, OFFSETS, 7))

    def best(self, near: FloatArray | None = None, starts: int = STARTS) -> Found:
        """Search twice, roughly and then in earnest; from ``near``, a population of a search much like this one.

        Else from anywhere; where that ends without a choice that does, from elsewhere again, up to ``starts`` times.
        """
        if near is not None:
            return self._refined(near)
        found = self._twice(self._anywhere(SEED), SEED)
        for seed in range(SEED + 1, SEED + starts):
            if found.feasible:
                break
            other = self._twice(self._anywhere(seed), seed)
            found = min(found, other, key=lambda one: float(one.figures[kernel.COST]))
        return found

    def _refined(self, near: FloatArray) -> Found:
        """Search in earnest at once, for the first search of a task much like this one was rough enough for both."""
        start = self._loosened(near)
        if lone(self.setup.fingers):
            found = self._in_earnest(start, REFINING_EPOCHS, SEED)
            if found.feasible:
                return found
        return self._twice(start, SEED)

    def _twice(self, start: FloatArray, seed: int) -> Found:
        rough = self._evolve(start, EPOCHS, seed, simulated=False)
        if not lone(self.setup.fingers) or rough.cost >= kernel.BREAKS_LIMITS:
            return self._polished(rough, simulated=False)
        again = self._loosened(rough.population)
        # The formula is that of a straight slide: what is best for one that turns may be elsewhere.
        again[-ELSEWHERE:] = self._anywhere(seed)[-ELSEWHERE:]
        return self._in_earnest(again, FINAL_EPOCHS, seed)

    def _in_earnest(self, start: FloatArray, epochs: int, seed: int) -> Found:
        """Search by simulated trials; once more where the polish still gains, for then the islands agreed too soon."""
        evolved = self._evolve(start, epochs, seed, simulated=True)
        found = self._polished(evolved, simulated=True)
        if not found.feasible or evolved.cost - found.figures[kernel.COST] < CLOSE:
            return found
        again = self._evolve(self._loosened(found.population), epochs, seed, simulated=True)
        return self._polished(again, simulated=True)

    def rough(self) -> Found:
        """Search by the formula of a straight slide alone."""
        return self._polished(self._evolve(self._anywhere(SEED), EPOCHS, SEED, simulated=False), simulated=False)

    def _polished(self, evolved: _Evolved, *, simulated: bool) -> Found:
        choice = evolved.population[0].copy()
        evolve_kernel.polish(choice, evolved.cost, self._problem, simulated, *self.bounds)
        figures = self.assess(choice[None], simulated=simulated)[0]
        return Found(choice, figures, self.limits, np.vstack([choice, evolved.population[:-1]]))

    def course(self, found: Found) -> Course:
        """The course that a choice stands for."""
        laid = self._laid_out(found, FINE)
        q_end = laid.tables[profile_kernel.SETTLE, -1, :3].copy()
        times = (float(duration) for duration in laid.times)
        return Course(
            laid.q_start, laid.q_slide, laid.dq_slide, q_end, self.task.r_start, self.task.r_goal, *times
        )  # fmt: skip

    def nodes(self, found: Found) -> tuple[FloatArray, FloatArray]:
        """Durations (PHASES,) of a choice, and its motion at the search's nodes, (PHASES, COARSE, COLUMNS)."""
        laid = self._laid_out(found, COARSE)
        return laid.times, laid.tables

    def _laid_out(self, found: Found, count: int) -> "_LaidOut":
        grid, fingers = nodes(count), self._fingers.copy()
        fingers[:, 0] *= found.force
        laid = _LaidOut(
            np.zeros(profile_kernel.PHASES),
            np.zeros((profile_kernel.PHASES, count, profile_kernel.COLUMNS)),
            *(np.empty(3) for _ in range(3)),
        )
        kernel.read_choice(found.choice, laid.times)
        profile_kernel.fill_evenly(
            self._body, fingers, self._task, found.choice[kernel.ANGLE], laid.times, laid.tables, grid.points,
            grid.integral, laid.q_start, laid.q_slide, laid.dq_slide,
        )  # fmt: skip
        return laid

    def _loosened(self, population: FloatArray) -> FloatArray:
        """A population that has converged, spread again but for its best few."""
        low, high = self.bounds
        random = np.random.default_rng(SEED).normal(size=population.shape) * LOOSE * (high - low)
        random[:KEPT] = 0.0
        return np.clip(population + random, low, high)

    def _anywhere(self, seed: int) -> FloatArray:
        low, high = self.bounds
        return low + (high - low) * np.random.default_rng(seed).random((ISLANDS * SIZE, len(low)))

    def _evolve(self, start: FloatArray, epochs: int, seed: int, *, simulated: bool) -> _Evolved:
        low, high = self.bounds
        told = self.assess(start, simulated=simulated)[:, kernel.COST]
        # The best go to islands in turn.
        islands = np.ascontiguousarray(start.reshape(SIZE, ISLANDS, -1).swapaxes(0, 1))
        costs = np.ascontiguousarray(told.reshape(SIZE, ISLANDS).T)
        for epoch in range(epochs):
            drawn = seed + epoch * ISLANDS
            evolve_kernel.evolve_islands(islands, costs, self._problem, simulated, low, high, EPOCH, CLOSE, drawn)
            if np.max(costs) - np.min(costs) < CLOSE:
                break
            _exchange(islands, costs)
        population, told = islands.reshape(ISLANDS * SIZE, -1), costs.ravel()
        order = np.argsort(told, kind="stable")
        return _Evolved(population[order], float(told[order[0]]))

    def assess(self, choices: FloatArray, *, simulated: bool = False, beat: float = np.inf) -> FloatArray:
        """Figures (S, FIGURES) of choices (S, CHOICES); what cannot cost less than ``beat`` may cost infinity."""
        figures = np.empty((len(choices), kernel.FIGURES))
        kernel.assess_all(np.ascontiguousarray(choices), self._problem, simulated, beat, figures)
        return figures

    def assess_one(self, choice: FloatArray) -> FloatArray:
        """Figures (FIGURES,) of one choice by the formula, on the caller's own core."""
        figures = np.empty(kernel.FIGURES)
        kernel.assess(choice, self._problem, False, np.inf, figures)  # noqa: FBT003  # compiled: positional alone
        return figures

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Least and largest choice, (CHOICES,) each."""
        angle, turn = float(self.task.q_o_start[2]), self.wish.turn_rad
        low, high = self.wish.force_range
        stick, slide, brake, force = np.log(STICK_S), np.log(SLIDE_S), np.log(BRAKE_SHARE), np.log([low, high])
        pairs = np.array([(angle - turn, angle + turn), stick, slide, brake, CATCH_SHARE, stick, force])
        return pairs[:, 0].copy(), pairs[:, 1].copy()


def _exchange(islands: FloatArray, costs: FloatArray) -> None:
    """Each island's best takes the place of the next one's worst."""
    best, worst, each = np.argmin(costs, axis=1), np.argmax(costs, axis=1), np.arange(len(islands))
    leaving, told = islands[each, best].copy(), costs[each, best].copy()
    after = np.roll(each, -1)
    islands[after, worst[after]], costs[after, worst[after]] = leaving, told


def scaled(task: Task, share: float) -> Task:
    """The same task with its goal at a share of the way."""
    return replace(task, r_goal=task.r_start + share * (task.r_goal - task.r_start))


def _task_rows(task: Task, wish: Wish) -> list[FloatArray]:
    end = np.full(3, np.nan) if task.q_f_end is None else object_pose(task.q_f_end, task.r_goal)
    free = np.array([float(wish.angle_free), 0.0, 0.0])
    return [task.q_o_start, task.r_start, task.r_goal - task.r_start, end, free]


def _wish_row(wish: Wish) -> FloatArray:
    row, weights = np.empty(kernel.WISHES), wish.weights
    row[kernel.FOR_TIME] = max(weights.time, SMALL_TIME)
    row[kernel.FOR_ACCELERATION] = max(weights.hand_acceleration, SMALL)
    row[kernel.FOR_ERROR] = weights.friction_error
    row[kernel.FOR_LOAD] = LOAD_WEIGHT
    row[kernel.FOR_FORCE] = SMALL
    row[kernel.DEMANDED] = wish.friction_error
    row[kernel.MOST] = MOST_ERROR if weights.friction_error > 0.0 else wish.friction_error
    return row
