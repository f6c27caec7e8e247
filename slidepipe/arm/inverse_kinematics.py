"""Joint trajectories for hand trajectories, by mink's differential inverse kinematics on the nominal model."""

from dataclasses import dataclass

import mink
import mujoco
import numpy as np
from scipy.interpolate import make_interp_spline
from scipy.spatial.transform import Rotation

from slidepipe.arm.model import HAND
from slidepipe.errors import InfeasibleError
from slidepipe.series import FloatArray

POSTURE_COST = 1e-3
"""Weight of the posture beside the hand's pose: it picks one of the redundant arm's answers and moves the hand 1 um."""
STEP_TOLERANCE_RAD = 1e-11
MAX_STEPS = 100
POSITION_TOLERANCE_M = 2e-5
ANGLE_TOLERANCE_RAD = 1e-4


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
        self._posture = mink.PostureTask(model, cost=POSTURE_COST)
        self._posture.set_target(np.array(posture_rad, dtype=float))
        self._limits = [mink.ConfigurationLimit(model)]

    def solve(self, path: HandPath) -> FloatArray:
        """Joint angles (T, 7) along a path; raises InfeasibleError where a pose is out of reach within the limits."""
        return np.array([self._pose(*sample) for sample in zip(path.time_s, path.position_m, path.matrix, strict=True)])

    def _pose(self, time_s: float, position_m: FloatArray, matrix: FloatArray) -> FloatArray:
        quaternion = Rotation.from_matrix(matrix).as_quat(scalar_first=True)
        self._hand.set_target(mink.SE3(np.concatenate([quaternion, position_m])))
        for _ in range(MAX_STEPS):
            step = mink.solve_ik(
                self._configuration, [self._hand, self._posture], 1.0, "daqp", damping=0.0, limits=self._limits
            )
            self._configuration.integrate_inplace(step, 1.0)
            if np.max(np.abs(step)) < STEP_TOLERANCE_RAD:
                break
        error = self._hand.compute_error(self._configuration)
        missed_m, missed_rad = np.linalg.norm(error[:3]), np.linalg.norm(error[3:])
        if missed_m > POSITION_TOLERANCE_M or missed_rad > ANGLE_TOLERANCE_RAD:
            raise InfeasibleError(
                f"inverse kinematics: the hand cannot reach its pose at t = {time_s:.3f} s within the joint limits: "
                f"{1e3 * missed_m:.2f} mm and {1e3 * missed_rad:.2f} mrad off (allowed: {1e3 * POSITION_TOLERANCE_M:.2f} "
                f"mm, {1e3 * ANGLE_TOLERANCE_RAD:.2f} mrad); move arm.plane or change arm.posture_rad"
            )
        return np.array(self._configuration.q)


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
    for first, last in zip(edges[:-1], edges[1:], strict=True):
        piece = slice(first, last + 1)
        spline = make_interp_spline(time_s[piece], position_rad[piece], k=min(5, last - first))
        velocity[piece], acceleration[piece] = spline(time_s[piece], 1), spline(time_s[piece], 2)
    return JointPath(time_s, position_rad, velocity, acceleration)
