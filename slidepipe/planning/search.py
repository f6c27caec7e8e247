"""The search for a course: a population of choices, each assessed in some microseconds by the compiled motion.

First with the friction error of a straight slide's formula, which is rough and cheap; then, from the best of these,
with the error that simulated trials survive. Differential evolution by scipy, whole generations at a time on all
cores.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import differential_evolution

from slidepipe.arm.local_model import LocalModel
from slidepipe.mechanics.planar import object_pose
from slidepipe.planning import assess_kernel as kernel
from slidepipe.planning import profile_kernel
from slidepipe.planning.course import Course, finger_rows, lone
from slidepipe.planning.nodes import COARSE, FINE, nodes
from slidepipe.planning.planner import Setup
from slidepipe.planning.wish import Wish
from slidepipe.series import FloatArray

STICK_S, SLIDE_S = (0.1, 1.2), (0.02, 0.6)
"""Shortest and longest sticking phase, and tear."""
BRAKE_SHARE, CATCH_SHARE = (0.1, 2.5), (0.0, 1.0)
"""Of the tear's duration."""
FORCE_DIGITS = 4
"""Of the normal force beside the believed one: nobody sets a gripper finer."""
TO_MOVE = 1e-12
"""What is not free still needs a range for scipy."""
SEED = 1
ROUGH_SIZE, ROUGH_ROUNDS = 64, 40
FINAL_SIZE, FINAL_ROUNDS = 48, 40
MUTATION, RECOMBINATION = (0.4, 0.9), 0.85
KEPT, LOOSE = 8, 0.08
"""How many of the best stay as they are between the two searches, and by what share of their range the others move."""
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
    """The best choice of a search, its figures as ``assess_kernel`` numbers them, and what they were asked to be."""

    choice: FloatArray
    figures: FloatArray
    bounds: FloatArray

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
        return float(np.round(np.exp(self.choice[kernel.LOG_FORCE]), FORCE_DIGITS))


@dataclass(frozen=True, slots=True)
class _Evolved:
    """A population (S, CHOICES), the best first, and the best one's cost."""

    population: FloatArray
    cost: float


class Search:
    """A task with all that its choices are assessed by."""

    def __init__(self, task: Task, setup: Setup, wish: Wish, arm: LocalModel, *, nearest_force: bool = False) -> None:
        self.task, self.setup, self.wish, self.arm = task, setup, wish, arm
        block, finger, limits = setup.block, setup.finger, setup.limits
        self._fingers = finger_rows(setup.fingers)
        self._body = np.array(
            [block.m, block.inertia, finger.mu * finger.f_N, finger.c * finger.a, 1.0, *setup.half_size_m]
        )
        self._task = np.array(_task_rows(task, wish), dtype=float)
        self._arm = arm.rows()
        self.limits = np.array(
            [limits.hand_acceleration_m_s2, limits.tip_speed_m_s, *limits.workspace_centre_m,
             limits.workspace_radius_m, limits.stick_load, *limits.region_centre_m, limits.region_radius_m]
        )  # fmt: skip
        self._wish = _wish_row(wish)
        if nearest_force:
            self._wish[kernel.FOR_FORCE] = FORCE_FIRST

    def best(self) -> Found:
        """Search twice, roughly and then in earnest."""
        rough = self._evolve(self._sobol(), ROUGH_ROUNDS, simulated=0.0)
        if not lone(self.setup.fingers) or rough.cost >= kernel.BREAKS_LIMITS:
            return self.found(rough.population[0], simulated=0.0)
        start = self._loosened(rough.population[:FINAL_SIZE])
        return self.found(self._evolve(start, FINAL_ROUNDS, simulated=1.0).population[0], simulated=1.0)

    def found(self, choice: FloatArray, *, simulated: float) -> Found:
        """A choice with its figures."""
        return Found(np.array(choice), self.assess(np.atleast_2d(choice), simulated)[0], self.limits)

    def course(self, found: Found) -> Course:
        """The course that a choice stands for."""
        times, grid = np.zeros(profile_kernel.PHASES), nodes(FINE)
        kernel.read_choice(found.choice, times)
        q_start, q_slide, dq_slide, q_end = (np.empty(3) for _ in range(4))
        fingers = self._fingers.copy()
        fingers[:, 0] *= found.force
        tables = np.empty((profile_kernel.PHASES, FINE, profile_kernel.COLUMNS))
        kernel.lay_out(
            found.choice, self._body, fingers, self._task, times, tables, grid.points, grid.integral,
            q_start, q_slide, dq_slide,
        )  # fmt: skip
        q_end = tables[profile_kernel.SETTLE, -1, :3].copy()
        return Course(q_start, q_slide, dq_slide, q_end, self.task.r_start, self.task.r_goal, *times)

    def _loosened(self, population: FloatArray) -> FloatArray:
        """A population that has converged, spread again but for its best few."""
        low, high = self.bounds
        random = np.random.default_rng(SEED).normal(size=population.shape) * LOOSE * (high - low)
        random[:KEPT] = 0.0
        return np.clip(population + random, low, high)

    def _sobol(self) -> FloatArray:
        """A population that fills the bounds evenly."""
        from scipy.stats import qmc  # noqa: PLC0415  # slow to import, and only here

        low, high = self.bounds
        return np.asarray(qmc.scale(qmc.Sobol(len(low), rng=SEED).random(ROUGH_SIZE), low, high))

    def _evolve(self, start: FloatArray, rounds: int, *, simulated: float) -> _Evolved:
        low, high = self.bounds
        result = differential_evolution(
            lambda x: self.assess(x.T, simulated)[:, kernel.COST],
            list(zip(low, high, strict=True)),
            vectorized=True,
            updating="deferred",
            polish=False,
            init=start,
            maxiter=rounds,
            mutation=MUTATION,
            recombination=RECOMBINATION,
            tol=1e-6,
            rng=SEED,
        )
        order = np.argsort(result.population_energies)
        return _Evolved(result.population[order], float(result.fun))

    def assess(self, choices: FloatArray, simulated: float = 0.0) -> FloatArray:
        """Figures (S, FIGURES) of choices (S, CHOICES)."""
        choices, grid = np.ascontiguousarray(choices), nodes(COARSE)
        figures, wish = np.empty((len(choices), kernel.FIGURES)), self._wish.copy()
        wish[kernel.SIMULATED] = simulated
        kernel.assess_all(
            choices, self._body, self._fingers, self._task, self.limits, self._arm, wish,
            grid.points, grid.integral, grid.powers, figures,
        )  # fmt: skip
        return figures

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Least and largest choice, (CHOICES,) each."""
        angle, turn = float(self.task.q_o_start[2]), self.wish.turn_rad
        low, high = self.wish.force_range
        stick, slide, brake, force = np.log(STICK_S), np.log(SLIDE_S), np.log(BRAKE_SHARE), np.log([low, high])
        pairs = np.array([(angle - turn, angle + turn), stick, slide, brake, CATCH_SHARE, stick, force])
        return pairs[:, 0], pairs[:, 1] + TO_MOVE


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
    row[kernel.SIMULATED] = 0.0
    return row
