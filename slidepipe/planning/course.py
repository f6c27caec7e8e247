"""The course of a regrasp: everything that fixes its motion, whoever chose it, and the motion itself (Section VII)."""

from dataclasses import dataclass

import numpy as np

from slidepipe.errors import InputError
from slidepipe.mechanics.dynamics import Block, finger_acceleration, finger_velocity, sticking_load
from slidepipe.mechanics.grasp import Contact, Grasp
from slidepipe.mechanics.hand_motion import HandMotion
from slidepipe.mechanics.limit_surface import SoftFinger
from slidepipe.mechanics.planar import finger_pose, rotation
from slidepipe.mechanics.stepping import PlacedFinger
from slidepipe.mechanics.sticking import needed_wrench, sticking_loads
from slidepipe.planning import profile_kernel
from slidepipe.planning.nodes import FINE, nodes
from slidepipe.series import FloatArray

ROUNDING_S = 1e-9
"""Times that differ by less are the same."""
PHASE_NAMES = ("stick", "tear", "brake", "catch", "settle")


@dataclass(frozen=True, slots=True)
class Course:
    """Everything that fixes the motion of a regrasp.

    The object sticks and is brought to speed for T1; the finger tears loose and accelerates along the straight line
    from ``r_start`` to ``r_goal`` in {b} for T2 and brakes for T3, so ``r'' = 2 (r_goal - r_start) / (T2 (T2 + T3))``
    and then the opposite times T2 / T3; for Tc the hand goes on as it braked, to catch an object that stops late; for
    T4 the object sticks and comes to rest. While it sticks, the object moves on cubics in time.

    Attributes
    ----------
    q_o_start, q_o_slide, q_o_end : (3,)
        Pose of the object in {w} at rest before, when sliding starts, and at rest after.
    dq_o_slide : (3,)
        The paper's free choice: velocity of the object in {w} when sliding starts.
    r_start, r_goal : (3,)
        Relative pose of the finger in {b} before and after.
    T1, T2, T3, Tc, T4 : float
        Durations, s; Tc may be zero.
    """

    q_o_start: FloatArray
    q_o_slide: FloatArray
    dq_o_slide: FloatArray
    q_o_end: FloatArray
    r_start: FloatArray
    r_goal: FloatArray
    T1: float
    T2: float
    T3: float
    Tc: float
    T4: float

    def __post_init__(self) -> None:
        for name in ("T1", "T2", "T3", "T4"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0.0):
                raise InputError(f"course: {name} must be a positive time in s, got {value!r}")
        if not (np.isfinite(self.Tc) and self.Tc >= 0.0):
            raise InputError(f"course: Tc must be a time in s from zero on, got {self.Tc!r}")
        if not np.any(self.r_goal - self.r_start):
            raise InputError("course: the goal is where the finger already is: nothing to slide")

    @property
    def times(self) -> FloatArray:
        """(5,) durations of the phases, s."""
        return np.array([self.T1, self.T2, self.T3, self.Tc, self.T4])

    @property
    def T23(self) -> float:
        """The paper's duration of the slide, s."""
        return self.T2 + self.T3

    @property
    def edges(self) -> FloatArray:
        """(6,) times at which the phases begin, and the end, s."""
        return np.concatenate([[0.0], np.cumsum(self.times)])

    @property
    def boundaries(self) -> FloatArray:
        """Times at which an acceleration changes, first and last included, s."""
        return np.unique(self.edges)

    @property
    def slide_s(self) -> float:
        """When sliding starts."""
        return self.T1

    @property
    def stop_s(self) -> float:
        """When sliding stops."""
        return float(self.edges[3])

    @property
    def ddr(self) -> FloatArray:
        """(3,) relative acceleration in {b} while tearing, m/s^2 and rad/s^2."""
        return np.asarray(2.0 * (self.r_goal - self.r_start) / (self.T2 * self.T23))

    @property
    def ddr_brake(self) -> FloatArray:
        """(3,) relative acceleration in {b} while braking."""
        return -self.ddr * self.T2 / self.T3


@dataclass(frozen=True, slots=True)
class Motion:
    """Hand and object over time, (T,) and (T, 3) in {w}; ``r_b`` in {b}; ``load`` is the friction in use (1 slides)."""

    time_s: FloatArray
    q_o: FloatArray
    dq_o: FloatArray
    ddq_o: FloatArray
    q_f: FloatArray
    dq_f: FloatArray
    ddq_f: FloatArray
    r_b: FloatArray
    dr_b: FloatArray
    load: FloatArray


def finger_rows(fingers: tuple[PlacedFinger, ...]) -> FloatArray:
    """(n, 4) mu f_N, c a and place in {f}, as the compiled motion reads them."""
    return np.array([[p.finger.mu * p.finger.f_N, p.finger.a * p.finger.c, *p.place] for p in fingers])


class CourseMotion:
    """The motion along a course, for a block and the fingers that are believed to hold it."""

    def __init__(self, course: Course, block: Block, fingers: tuple[PlacedFinger, ...]) -> None:
        self.course, self.block, self.fingers = course, block, fingers
        grid = nodes(FINE)
        self._tables = np.zeros((profile_kernel.PHASES, FINE, profile_kernel.COLUMNS))
        profile_kernel.fill(
            np.array([block.m, block.inertia]), finger_rows(fingers), course.r_start, course.r_goal - course.r_start,
            course.times, course.q_o_start, course.q_o_slide, course.dq_o_slide, course.q_o_end,
            self._tables, grid.points, grid.integral,
        )  # fmt: skip

    def sample(self, time_s: FloatArray) -> Motion:
        """Hand and object at the given times; at a boundary the phase that begins there counts."""
        time_s = _on_boundaries(np.asarray(time_s, dtype=float), self.course.boundaries)
        q_o, dq_o, ddq_o = self._object(time_s)
        r_b, dr_b, ddr_b = self._relative(time_s)
        return Motion(
            time_s=time_s,
            q_o=q_o,
            dq_o=dq_o,
            ddq_o=ddq_o,
            q_f=finger_pose(q_o, r_b),
            dq_f=finger_velocity(q_o[:, 2], dq_o, r_b, dr_b),
            ddq_f=finger_acceleration(q_o[:, 2], dq_o[:, 2], ddq_o, r_f_b=r_b, dr_f_b=dr_b, ddr_f_b=ddr_b),
            r_b=r_b,
            dr_b=dr_b,
            load=self._load(time_s, q_o[:, 2], ddq_o, r_b),
        )

    def hand_motion(self) -> HandMotion:
        """The hand's motion as polynomials, to simulate an object under it."""
        return HandMotion.from_function(self.hand_poses, self.course.boundaries)

    def hand_poses(self, time_s: FloatArray) -> FloatArray:
        """Poses (T, 3) of the hand in {w} at times (T,)."""
        time_s = _on_boundaries(time_s, self.course.boundaries)
        return finger_pose(self._object(time_s)[0], self._relative(time_s)[0])

    def _object(self, time_s: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        edges, state = self.course.edges, np.zeros((len(time_s), 9))
        for phase in range(profile_kernel.PHASES):
            inside = (time_s >= edges[phase]) & (time_s < edges[phase + 1])
            if np.any(inside):
                share = (time_s[inside] - edges[phase]) / (edges[phase + 1] - edges[phase])
                state[inside] = nodes(FINE).between(self._tables[phase, :, :9], share)
        state[time_s >= edges[-1], :3] = self.course.q_o_end
        return state[:, :3], state[:, 3:6], state[:, 6:]

    def _relative(self, time_s: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        course = self.course
        t = np.clip(time_s - course.T1, 0.0, course.T23)[:, None]
        back = course.T23 - t
        tears = (time_s < course.edges[2])[:, None]
        ddr, ddr_brake = course.ddr, course.ddr_brake
        r_b = np.where(tears, course.r_start + 0.5 * ddr * t**2, course.r_goal + 0.5 * ddr_brake * back**2)
        dr_b = np.where(tears, ddr * t, -ddr_brake * back)
        slides = (time_s >= course.slide_s) & (time_s < course.stop_s)
        return r_b, dr_b, np.where(slides[:, None], np.where(tears, ddr, ddr_brake), 0.0)

    def _load(self, time_s: FloatArray, theta: FloatArray, ddq_o: FloatArray, r_b: FloatArray) -> FloatArray:
        finger = self.fingers[0].finger
        if lone(self.fingers) and isinstance(finger, SoftFinger):
            return sticking_load(self.block, finger, theta, ddq_o, r_b)
        turned = np.einsum("tij,nj->tni", rotation(r_b[:, 2])[:, :2, :2], np.array([p.place for p in self.fingers]))
        angles = np.broadcast_to(r_b[:, None, 2:], (*turned.shape[:2], 1))
        places = np.concatenate([r_b[:, None, :2] + turned, angles], axis=2)
        grasp = Grasp([Contact(p.finger, r) for p, r in zip(self.fingers, places[0], strict=True)])
        loads = sticking_loads(grasp, needed_wrench(self.block, theta, ddq_o), r_f_b=places)
        slides = (time_s >= self.course.slide_s) & (time_s < self.course.stop_s)
        return np.where(slides, 1.0, loads)


def lone(fingers: tuple[PlacedFinger, ...]) -> bool:
    """Whether the fingers are a single one at the hand's origin."""
    return len(fingers) == 1 and not np.any(fingers[0].place)


def _on_boundaries(time_s: FloatArray, boundaries: FloatArray) -> FloatArray:
    """Times with those that miss a boundary by rounding alone moved onto it, so that they fall into its phase."""
    nearest = boundaries[np.argmin(np.abs(time_s[:, None] - boundaries), axis=1)]
    return np.where(np.abs(time_s - nearest) < ROUNDING_S, nearest, time_s)
