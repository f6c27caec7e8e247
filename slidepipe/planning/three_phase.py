"""The three-phase regrasp of Section VII: stick for T1, slide for T23, stick for T4.

The relative motion is the bang-bang profile of Fig. 6: it accelerates from the initial to the goal relative pose for
half of T23 and brakes for the other half, so ``r'' = +-4 (r_goal - r_init) / T23^2`` in {b}. While it slides in one
direction the friction wrench in {b} is constant (eq. 14), so the object's acceleration does not depend on its
velocity. The velocity at which sliding starts therefore enters the final pose linearly, and is chosen such that the
hand comes to rest where it is told to.
"""

from dataclasses import dataclass

import numpy as np
from scipy.integrate import OdeSolution, solve_ivp

from slidepipe.errors import InputError
from slidepipe.mechanics.dynamics import (
    Block,
    finger_acceleration,
    finger_velocity,
    sliding_acceleration,
    sticking_load,
)
from slidepipe.mechanics.hand_motion import HandMotion
from slidepipe.mechanics.limit_surface import SoftFinger
from slidepipe.mechanics.planar import finger_pose, object_pose
from slidepipe.series import FloatArray

ROUNDING_S = 1e-9
"""Times that differ by less are the same."""


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


class ThreePhaseMotion:
    """The motion that answers a :class:`Regrasp` under a believed friction.

    Attributes
    ----------
    dq_o_slide : (3,)
        The paper's free choice: velocity of the object in {w} when sliding starts.
    ddq_o_stick, ddq_o_settle : (3,)
        Constant accelerations of the object in the two sticking phases.
    """

    def __init__(self, regrasp: Regrasp, block: Block, finger: SoftFinger) -> None:
        self.regrasp, self.block, self.finger = regrasp, block, finger
        # The angle first: while sliding its acceleration depends on r_f_b alone, so omega enters linearly.
        at_rest = self._slide(np.zeros(3))
        omega = self._velocity_for(at_rest)[2]
        self.dq_o_slide = self._velocity_for(self._slide(np.array([0.0, 0.0, omega])), omega)
        self._sliding = self._slide(self.dq_o_slide)
        self.ddq_o_stick = self.dq_o_slide / regrasp.T1
        self.ddq_o_settle = -self._sliding(regrasp.T23)[3:] / regrasp.T4

    def sample(self, time_s: FloatArray) -> Motion:
        """Hand and object at the given times; at a boundary the phase that begins there counts."""
        time_s = _on_boundaries(np.asarray(time_s, dtype=float), self.regrasp.boundaries)
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
            load=sticking_load(self.block, self.finger, q_o[:, 2], ddq_o, r_b),
        )

    def hand_motion(self) -> HandMotion:
        """The hand's motion as polynomials, to simulate an object under it."""
        return HandMotion.from_function(lambda time_s: self.sample(time_s).q_f, self.regrasp.boundaries)

    def _slide(self, dq_o: FloatArray) -> OdeSolution:
        """Object ``[q_o, dq_o]`` over the sliding phase, which begins at time 0 with velocity ``dq_o``."""
        task = self.regrasp
        start = np.concatenate([task.q_o_start + 0.5 * dq_o * task.T1, dq_o])

        def rate(t: float, state: FloatArray) -> FloatArray:
            r_b = self._relative(np.array([task.T1 + t]))[0][0]
            ddq_o = sliding_acceleration(self.block, self.finger, state[2], r_b, task.ddr)
            return np.concatenate([state[3:], ddq_o])

        return solve_ivp(rate, (0.0, task.T23), start, "DOP853", dense_output=True, rtol=1e-12, atol=1e-14).sol

    def _velocity_for(self, sliding: OdeSolution, omega: float = 0.0) -> FloatArray:
        """Velocity at the start of sliding that ends where it should, from a slide that began with ``omega`` alone."""
        task = self.regrasp
        end = sliding(task.T23)
        missed = object_pose(task.q_f_end, task.r_goal) - (end[:3] + 0.5 * end[3:] * task.T4)
        gain = 0.5 * task.T1 + task.T23 + 0.5 * task.T4
        return np.asarray(np.array([0.0, 0.0, omega]) + missed / gain)

    def _object(self, time_s: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        task, (_, t_slide, _, t_settle, t_end) = self.regrasp, self.regrasp.boundaries
        sliding = self._sliding(np.clip(time_s - t_slide, 0.0, task.T23)).T
        t1 = np.clip(time_s, 0.0, t_slide)[:, None]
        t4 = np.clip(time_s - t_settle, 0.0, task.T4)[:, None]
        before, after = (time_s < t_slide)[:, None], (time_s >= t_settle)[:, None]
        rest = (time_s >= t_end)[:, None]
        q_o = np.where(before, task.q_o_start + 0.5 * self.ddq_o_stick * t1**2, sliding[:, :3])
        dq_o = np.where(before, self.ddq_o_stick * t1, sliding[:, 3:])
        q_o = q_o + np.where(after, sliding[:, 3:] * t4 + 0.5 * self.ddq_o_settle * t4**2, 0.0)
        dq_o = dq_o + np.where(after, self.ddq_o_settle * t4, 0.0)
        r_b = self._relative(time_s)[0]
        slide = sliding_acceleration(self.block, self.finger, q_o[:, 2], r_b, task.ddr)
        ddq_o = np.where(before, self.ddq_o_stick, np.where(after, self.ddq_o_settle, slide))
        return q_o, np.where(rest, 0.0, dq_o), np.where(rest, 0.0, ddq_o)

    def _relative(self, time_s: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        task, half = self.regrasp, 0.5 * self.regrasp.T23
        t = np.clip(time_s - task.T1, 0.0, task.T23)[:, None]
        back = task.T23 - t
        r_b = np.where(t < half, task.r_start + 0.5 * task.ddr * t**2, task.r_goal - 0.5 * task.ddr * back**2)
        dr_b = task.ddr * np.minimum(t, back)
        _, t_slide, t_switch, t_settle, _ = task.boundaries
        sign = np.where((time_s >= t_slide) & (time_s < t_switch), 1.0, 0.0)
        sign = np.where((time_s >= t_switch) & (time_s < t_settle), -1.0, sign)
        return r_b, dr_b, sign[:, None] * task.ddr


def _on_boundaries(time_s: FloatArray, boundaries: FloatArray) -> FloatArray:
    """Times with those that miss a boundary by rounding alone moved onto it, so that they fall into its phase."""
    nearest = boundaries[np.argmin(np.abs(time_s[:, None] - boundaries), axis=1)]
    return np.where(np.abs(time_s - nearest) < ROUNDING_S, nearest, time_s)
