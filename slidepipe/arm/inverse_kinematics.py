"""Joint trajectories for hand trajectories, by mink's differential inverse kinematics on the nominal model."""

from contextlib import suppress
from dataclasses import dataclass
from itertools import pairwise

import mink
import mujoco
import numpy as np
from scipy.interpolate import make_interp_spline
from scipy.spatial.transform import Rotation

from slidepipe.arm.model import HAND
from slidepipe.errors import InfeasibleError
from slidepipe.series import FloatArray

APPROACH_POSTURE_COST = 1e-3
"""Weight of the posture beside the hand's pose on the way to the start of a path; along it the pose is exact."""
STEP_TOLERANCE_RAD = 1e-9
MAX_STEPS = 50
POSITION_TOLERANCE_M = 1e-7
ANGLE_TOLERANCE_RAD = 1e-6


@dataclass(frozen=True, slots=True)
class HandPath:
    """Hand poses in the base frame over time: (T,), (T, 3) and (T, 3, 3)."""

    time_s: FloatArray
    position_m: FloatArray
    matrix: FloatArray


@dataclass(frozen=True, slots=True)
class JointPath:
    """Joint motion over time: (T,) and (T, 7), in rad, rad/s and rad/s^2."""

    time_s: FloatArray
    position_rad: FloatArray
    velocity_rad_s: FloatArray
    acceleration_rad_s2: FloatArray


class InverseKinematics:
    """Answers hand poses with the joint angles nearest to a posture, within the joint limits.

    Parameters
    ----------
    model : mujoco.MjModel
        An arm with a hand site.
    posture_rad : (7,)
        What the redundancy keeps near, and where the search starts.
    """

    def __init__(self, model: mujoco.MjModel, posture_rad: FloatArray) -> None:
        self._configuration = mink.Configuration(model, q=np.array(posture_rad, dtype=float))
        self._hand = mink.FrameTask(HAND, "site", position_cost=1.0, orientation_cost=0.3)
        self._posture = mink.PostureTask(model, cost=APPROACH_POSTURE_COST)
        self._posture.set_target(np.array(posture_rad, dtype=float))
        self._limits = [mink.ConfigurationLimit(model)]

    def solve(self, path: HandPath) -> FloatArray:
        """Joint angles (T, 7) along a path; raises InfeasibleError where a pose is out of reach within the limits."""
        self._aim(path.position_m[0], path.matrix[0])
        self._descend([self._hand, self._posture], [])
        return np.array([self._pose(*sample) for sample in zip(path.time_s, path.position_m, path.matrix, strict=True)])

    def _pose(self, time_s: float, position_m: FloatArray, matrix: FloatArray) -> FloatArray:
        """Nearest to the posture among the configurations that hold the hand exactly there."""
        self._aim(position_m, matrix)
        with suppress(mink.NoSolutionFound):  # then the pose is out of reach: how far, the error tells
            self._descend([self._posture], [self._hand])
        error = self._hand.compute_error(self._configuration)
        missed_m, missed_rad = np.linalg.norm(error[:3]), np.linalg.norm(error[3:])
        if missed_m > POSITION_TOLERANCE_M or missed_rad > ANGLE_TOLERANCE_RAD:
            raise InfeasibleError(
                f"inverse kinematics: the hand cannot reach its pose at t = {time_s:.3f} s within the joint limits: "
                f"{1e3 * missed_m:.3g} mm and {1e3 * missed_rad:.3g} mrad off (allowed: "
                f"{1e3 * POSITION_TOLERANCE_M:g} mm, {1e3 * ANGLE_TOLERANCE_RAD:g} mrad); "
                "move arm.plane or change arm.posture_rad"
            )
        return np.array(self._configuration.q)

    def _aim(self, position_m: FloatArray, matrix: FloatArray) -> None:
        quaternion = Rotation.from_matrix(matrix).as_quat(scalar_first=True)
        self._hand.set_target(mink.SE3(np.concatenate([quaternion, position_m])))

    def _descend(self, tasks: list[mink.Task], constraints: list[mink.Task]) -> None:
        for _ in range(MAX_STEPS):
            step = mink.solve_ik(self._configuration, tasks, 1.0, "daqp", limits=self._limits, constraints=constraints)
            self._configuration.integrate_inplace(step, 1.0)
            if np.max(np.abs(step)) < STEP_TOLERANCE_RAD:
                break


def differentiate(time_s: FloatArray, position_rad: FloatArray, boundaries_s: FloatArray) -> JointPath:
    """Velocity and acceleration of joint angles that are smooth between boundaries and whose acceleration jumps there.

    Parameters
    ----------
    time_s : (T,)
    position_rad : (T, 7)
    boundaries_s : (K,)
        Times that are among the samples, first and last included; the value at one is that of the piece which begins.

    Returns
    -------
    JointPath
    """
    velocity, acceleration = np.empty_like(position_rad), np.empty_like(position_rad)
    edges = np.searchsorted(time_s, boundaries_s - 1e-9)
    for first, last in pairwise(edges):
        piece = slice(first, last + 1)
        spline = make_interp_spline(time_s[piece], position_rad[piece], k=min(5, last - first))
        velocity[piece], acceleration[piece] = spline(time_s[piece], 1), spline(time_s[piece], 2)
    return JointPath(time_s, position_rad, velocity, acceleration)
