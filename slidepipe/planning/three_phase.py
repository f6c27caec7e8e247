"""The paper's own choice of a motion, Section VII: the times are given, and the hand is told where to come to rest.

The slide is the bang-bang profile of Fig. 6, ``r'' = +-4 (r_goal - r_init) / T23^2`` in {b}, and the object's
accelerations while it sticks are constant. While it slides in one direction the friction wrench in {b} is constant
(eq. 14), so the object's acceleration does not depend on its velocity. The velocity at which sliding starts therefore
enters the final pose linearly, and is chosen such that the hand comes to rest where it is told to.
"""

from dataclasses import dataclass

import numpy as np

from slidepipe.errors import InputError
from slidepipe.mechanics.dynamics import Block
from slidepipe.mechanics.limit_surface import SoftFinger
from slidepipe.mechanics.planar import object_pose
from slidepipe.mechanics.stepping import PlacedFinger
from slidepipe.planning import profile_kernel
from slidepipe.planning.course import Course, CourseMotion, finger_rows
from slidepipe.planning.nodes import FINE, nodes
from slidepipe.series import FloatArray


@dataclass(frozen=True, slots=True)
class Regrasp:
    """What is asked of one motion.

    Attributes
    ----------
    q_o_start : (3,)
        Pose of the object at rest in {w} before the motion.
    r_start, r_goal : (3,)
        Relative pose of the finger in {b} before and after.
    q_f_end : (3,)
        Pose in {w} where the hand comes to rest.
    T1, T23, T4 : float
        Durations of the three phases, s.
    """

    q_o_start: FloatArray
    r_start: FloatArray
    r_goal: FloatArray
    q_f_end: FloatArray
    T1: float
    T23: float
    T4: float

    def __post_init__(self) -> None:
        for name in ("T1", "T23", "T4"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0.0):
                raise InputError(f"regrasp: {name} must be a positive time in s, got {value!r}")
        if not np.any(self.r_goal - self.r_start):
            raise InputError("regrasp: the goal is where the finger already is: nothing to slide")

    @property
    def boundaries(self) -> FloatArray:
        """(5,) times at which an acceleration changes: 0, T1, T1 + T23/2, T1 + T23, T1 + T23 + T4, in s."""
        return np.cumsum([0.0, self.T1, self.T23 / 2, self.T23 / 2, self.T4])

    @property
    def ddr(self) -> FloatArray:
        """(3,) relative acceleration in {b} in the first half of sliding, m/s^2 and rad/s^2."""
        return np.asarray(4.0 * (self.r_goal - self.r_start) / self.T23**2)


def course_of(regrasp: Regrasp, block: Block, fingers: tuple[PlacedFinger, ...]) -> Course:
    """The course that answers a regrasp under a believed friction."""
    task, grid = regrasp, nodes(FINE)
    times = np.array([task.T1, task.T23 / 2, task.T23 / 2, 0.0, task.T4])
    tables = np.zeros((profile_kernel.PHASES, FINE, profile_kernel.COLUMNS))
    moved, gained = np.empty(3), np.empty(3)
    q_o_end = object_pose(task.q_f_end, task.r_goal)

    def velocity(theta: float, omega: float) -> FloatArray:
        """Change of the velocity at the start of sliding that would end a slide begun so where it should."""
        profile_kernel.change(
            np.array([block.m, block.inertia]), finger_rows(fingers), task.r_start, task.r_goal - task.r_start,
            times, theta, omega, tables, grid.points, grid.integral, moved, gained,
        )  # fmt: skip
        missed = q_o_end - task.q_o_start - moved - 0.5 * gained * task.T4
        return np.asarray(missed / (0.5 * task.T1 + task.T23 + 0.5 * task.T4))

    # The angle first: while sliding its acceleration depends on r_f_b alone, so omega enters linearly.
    omega = float(velocity(float(task.q_o_start[2]), 0.0)[2])
    theta = float(task.q_o_start[2]) + 0.5 * omega * task.T1
    dq_o_slide = np.append(velocity(theta, omega)[:2], omega)
    return Course(
        q_o_start=np.asarray(task.q_o_start, dtype=float),
        q_o_slide=task.q_o_start + 0.5 * dq_o_slide * task.T1,
        dq_o_slide=dq_o_slide,
        q_o_end=q_o_end,
        r_start=np.asarray(task.r_start, dtype=float),
        r_goal=np.asarray(task.r_goal, dtype=float),
        T1=task.T1,
        T2=task.T23 / 2,
        T3=task.T23 / 2,
        Tc=0.0,
        T4=task.T4,
    )


class ThreePhaseMotion(CourseMotion):
    """The motion that answers a :class:`Regrasp` under a believed friction.

    Attributes
    ----------
    dq_o_slide : (3,)
        Velocity of the object in {w} when sliding starts.
    ddq_o_stick, ddq_o_settle : (3,)
        Constant accelerations of the object in the two sticking phases.
    """

    def __init__(self, regrasp: Regrasp, block: Block, finger: SoftFinger) -> None:
        fingers = (PlacedFinger(finger, np.zeros(2)),)
        super().__init__(course_of(regrasp, block, fingers), block, fingers)
        self.regrasp = regrasp
        self.dq_o_slide = self.course.dq_o_slide
        ends = self.sample(regrasp.boundaries[[0, 3]]).ddq_o
        self.ddq_o_stick, self.ddq_o_settle = ends
