"""Cameras against joints: how late the one's clock is on the other's, and how the cameras' world is turned.

Both saw the hand. Where the joints say it was, moved by an unknown offset in time, an unknown placing of the cameras'
world in the arm's base and an unknown placing of the markers on the hand, is fitted to where the cameras saw it. The
arm's base is level, so the turn of the world in the plane of motion is the turn of gravity in what the cameras measure.
"""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from slidepipe.errors import EstimationError
from slidepipe.estimation.track import Track
from slidepipe.series import FloatArray

FEWEST = 30
REACH_S, GRID_S = 0.2, 0.004
ROUNDS = 8
SDS = np.array([1.0, 0.1, 0.1, 0.1, 0.05, 0.05, 0.1])
"""Of offset in time, world's x, y and angle, markers' x, y and angle: wide, for what a motion does not tell apart."""
STEPS = np.array([1e-5, 1e-6, 1e-6, 1e-6, 1e-6, 1e-6, 1e-6])
LEVEL_SD_RAD = 5e-4
"""How well an arm's base is level and its kinematics known."""


@dataclass(frozen=True, slots=True)
class JointClock:
    """What cameras and joints together tell.

    Attributes
    ----------
    offset_s, sd_s : float
        By how much the cameras' stamps are late on the joint log's clock, and the standard deviation.
    tilt_rad, tilt_sd_rad : float
        Angle by which gravity is turned in the cameras' plane of motion, counter-clockwise.
    residual_m : float
        Root mean square of what is left between the two, of the position.
    """

    offset_s: float
    sd_s: float
    tilt_rad: float
    tilt_sd_rad: float
    residual_m: float


def fit_joint_clock(
    time_s: FloatArray, hand: Track, noise: FloatArray, joints_s: FloatArray, joint_pose: FloatArray
) -> JointClock:
    """Fit the offset between the cameras and the joint log.

    Parameters
    ----------
    time_s : (T,)
        Stamps of the camera frames.
    hand : Track
        What the cameras saw.
    noise : (3,)
        Standard deviation of one pose.
    joints_s, joint_pose : (J,), (J, 3)
        Stamps of the joint log on the same clock, and the hand's pose in the plane by the joints.

    Raises
    ------
    EstimationError
        Too few joint states, or none at the same time as the cameras.
    """
    inside = hand.valid & (time_s > joints_s[0] + REACH_S) & (time_s < joints_s[-1] - REACH_S)
    if np.count_nonzero(inside) < FEWEST:
        raise EstimationError(
            f"joints: {np.count_nonzero(inside)} camera frames lie within the joint log, at least {FEWEST} are needed"
        )
    joints = CubicSpline(joints_s, np.column_stack([joint_pose[:, :2], np.unwrap(joint_pose[:, 2])]))
    pose = hand.pose[inside]
    pose[:, 2] -= 2.0 * np.pi * np.round(np.median(pose[:, 2] - joints(time_s[inside])[:, 2]) / (2.0 * np.pi))
    problem = _Problem(time_s[inside], pose, noise, joints)
    parameters = problem.first()
    for _ in range(ROUNDS):
        jacobian = problem.jacobian(parameters)
        information = jacobian.T @ jacobian + np.diag(SDS**-2.0)
        score = jacobian.T @ problem.residuals(parameters) + parameters * SDS**-2.0
        parameters = parameters - np.linalg.solve(information, score)
    left = problem.residuals(parameters)
    scale = np.sqrt(max(1.0, float(left @ left) / max(len(left) - len(parameters), 1)))
    sd = scale * np.sqrt(np.diagonal(np.linalg.inv(information)))
    away = left.reshape(-1, 3)[:, :2] * noise[:2]
    return JointClock(
        offset_s=float(parameters[0]),
        sd_s=float(sd[0]),
        tilt_rad=float(parameters[3]),
        tilt_sd_rad=float(np.hypot(sd[3], LEVEL_SD_RAD)),
        residual_m=float(np.sqrt(np.mean(np.sum(away**2, axis=1)))),
    )


@dataclass(frozen=True, slots=True)
class _Problem:
    time_s: FloatArray
    pose: FloatArray
    noise: FloatArray
    joints: CubicSpline

    def first(self) -> FloatArray:
        """The offset at which the two paths look most alike."""
        offsets = np.arange(-REACH_S, REACH_S, GRID_S)
        away = self.pose[:, :2] - self.joints(self.time_s - offsets[:, None])[..., :2]
        misfit = np.sum(np.var(away, axis=1), axis=1)
        return np.concatenate([offsets[[np.argmin(misfit)]], np.zeros(6)])

    def residuals(self, parameters: FloatArray) -> FloatArray:
        """(3 T,) weighted distances."""
        offset, w_x, w_y, turn, m_x, m_y, mark = parameters
        joint = self.joints(self.time_s - offset)
        c, s = np.cos(joint[:, 2]), np.sin(joint[:, 2])
        x, y = joint[:, 0] + c * m_x - s * m_y, joint[:, 1] + s * m_x + c * m_y
        seen = np.stack(
            [
                w_x + np.cos(turn) * x - np.sin(turn) * y,
                w_y + np.sin(turn) * x + np.cos(turn) * y,
                joint[:, 2] + turn + mark,
            ],
            axis=1,
        )
        return np.asarray(((seen - self.pose) / self.noise).ravel())

    def jacobian(self, parameters: FloatArray) -> FloatArray:
        """(3 T, 7) by central differences."""
        columns = [
            (self.residuals(parameters + step) - self.residuals(parameters - step)) / (2.0 * size)
            for step, size in zip(np.diag(STEPS), STEPS, strict=True)
        ]
        return np.stack(columns, axis=1)
