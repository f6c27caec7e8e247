"""Where the hand is for given joint angles."""

from dataclasses import dataclass

import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

from slidepipe.arm.model import HAND
from slidepipe.series import FloatArray, JointSeries, PoseSeries


@dataclass(frozen=True, slots=True)
class HandError:
    """Distance and angle between two hand trajectories over time: (T,) m and (T,) rad."""

    position_m: FloatArray
    angle_rad: FloatArray


def hand_poses(model: mujoco.MjModel, joints: JointSeries) -> PoseSeries:
    """Pose of the hand {f} in the base frame for each joint state, on the same stamps."""
    position, matrix = _hand_poses(model, joints.position_rad)
    quaternion = Rotation.from_matrix(matrix).as_quat() if len(matrix) else np.zeros((0, 4))
    return PoseSeries(joints.stamp_ns, position, quaternion, np.arange(len(position), dtype=np.int64))


def hand_error(model: mujoco.MjModel, joints_rad: FloatArray, other_rad: FloatArray) -> HandError:
    """How far apart the hand is for two joint trajectories (T, 7), commanded and measured say."""
    position, matrix = _hand_poses(model, joints_rad)
    other_position, other_matrix = _hand_poses(model, other_rad)
    trace = np.einsum("tij,tij->t", matrix, other_matrix)
    return HandError(
        position_m=np.linalg.norm(position - other_position, axis=1),
        angle_rad=np.arccos(np.clip((trace - 1.0) / 2.0, -1.0, 1.0)),
    )


def link_points(model: mujoco.MjModel, joints_rad: FloatArray) -> FloatArray:
    """Points along the arm (T, P, 3) in the base frame, m: the joints' anchors from the shoulder on, then the hand.

    Parameters
    ----------
    model : MjModel
    joints_rad : (T, 7)
    """
    data = mujoco.MjData(model)
    points = np.empty((len(joints_rad), model.njnt + 1, 3))
    for index, angles in enumerate(joints_rad):
        data.qpos[:] = angles
        mujoco.mj_kinematics(model, data)
        points[index, :-1], points[index, -1] = data.xanchor, data.site(HAND).xpos
    return points


def _hand_poses(model: mujoco.MjModel, joints_rad: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Positions (T, 3) and rotation matrices (T, 3, 3) of {f} in the base frame for joint angles (T, 7)."""
    data = mujoco.MjData(model)
    position, matrix = np.empty((len(joints_rad), 3)), np.empty((len(joints_rad), 3, 3))
    for index, angles in enumerate(joints_rad):
        data.qpos[:] = angles
        mujoco.mj_kinematics(model, data)
        site = data.site(HAND)
        position[index], matrix[index] = site.xpos, site.xmat.reshape(3, 3)
    return position, matrix
