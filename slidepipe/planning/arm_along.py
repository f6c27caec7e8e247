"""The arm along a motion that a search found, at the search's own nodes: what its local model misses there."""

from dataclasses import dataclass

import mujoco
import numpy as np

from slidepipe.arm import wam
from slidepipe.arm.dynamics import elbow_speed, inverse_dynamics
from slidepipe.arm.inverse_kinematics import HandPath, InverseKinematics
from slidepipe.arm.local_model import LocalModel
from slidepipe.errors import InfeasibleError
from slidepipe.mechanics.planar import MotionPlane
from slidepipe.planning import arm_kernel
from slidepipe.planning.nodes import COARSE, nodes
from slidepipe.planning.planner import postures
from slidepipe.planning.profile_kernel import BRAKE, CATCH, PHASES
from slidepipe.series import FloatArray


@dataclass(frozen=True, slots=True)
class ArmAlong:
    """Joint angles at the nodes of a motion.

    Attributes
    ----------
    times : (PHASES,)
        Durations, s; a phase of no length has no angles.
    position_rad : (PHASES, COARSE, 7)
    offsets : (PHASES, COARSE, OFFSETS, 7)
        What the local model misses, as :mod:`slidepipe.planning.arm_kernel` numbers it.
    """

    times: FloatArray
    position_rad: FloatArray
    offsets: FloatArray

    def near(self, time_s: FloatArray) -> FloatArray:
        """Joint angles (T, 7) at times within the motion, good enough to start from."""
        edges = np.concatenate([[0.0], np.cumsum(self.times)])
        phase = np.clip(np.searchsorted(edges, np.mean(time_s), side="right") - 1, 0, PHASES - 1)
        share = (time_s - edges[phase]) / self.times[phase]
        return nodes(COARSE).between(self.position_rad[phase], share)


class ArmAsked:
    """Asks the arm along the motions of a search, with the posture that reaches their poses."""

    def __init__(self, model: mujoco.MjModel, posture_rad: FloatArray, plane: MotionPlane) -> None:
        self._model, self._posture_rad, self._plane = model, posture_rad, plane

    def along(self, arm: LocalModel, offsets: FloatArray, times: FloatArray, tables: FloatArray) -> ArmAlong:
        """The arm at the nodes of a motion, ``tables`` (PHASES, COARSE, COLUMNS).

        ``offsets`` are what the local model missed along another motion, or zero; its angles are where to start from.

        Raises
        ------
        InfeasibleError
            The arm cannot reach one of its poses.
        """
        long, told = times > 0.0, _told(arm, tables)
        expected = (told + offsets)[long, :, arm_kernel.OFF_ANGLE].reshape(-1, wam.JOINT_COUNT)
        poses = tables[long, :, 9:12].reshape(-1, 3)
        path = HandPath(_node_times(times)[long].ravel(), *self._plane.lift(poses))
        q = self._angles(path, expected).reshape(-1, COARSE, wam.JOINT_COUNT)
        missed, position = np.zeros_like(told), np.zeros(told[:, :, 0].shape)
        missed[long], position[long] = self._values(q, times[long]) - told[long], q
        if not long[CATCH]:
            # A catch goes on as the brake ends.
            missed[CATCH] = missed[BRAKE, -1]
        return ArmAlong(times, position, missed)

    def _angles(self, path: HandPath, expected: FloatArray) -> FloatArray:
        """Joint angles (T, 7) for hand poses, near those that are expected, else each from the one before."""
        try:
            near = InverseKinematics(self._model, self._posture_rad)
            return near.solve(path, expected)
        except InfeasibleError as refusal:
            refusals = [refusal]
        for posture in postures(self._posture_rad):
            kinematics = InverseKinematics(self._model, posture)
            kinematics.approach(path)
            try:
                return kinematics.solve(path)
            except InfeasibleError as refusal:
                refusals.append(refusal)
        raise refusals[1]

    def _values(self, q: FloatArray, times: FloatArray) -> FloatArray:
        """The arm's own values (P, COARSE, OFFSETS, 7) for angles (P, COARSE, 7) over phases that take ``times``."""
        rate, duration = nodes(COARSE).rate, times[:, None, None]
        dq = rate @ q / duration
        ddq = rate @ dq / duration
        flat = [values.reshape(-1, wam.JOINT_COUNT) for values in (q, dq, ddq)]
        values = np.zeros((*q.shape[:2], arm_kernel.OFFSETS, wam.JOINT_COUNT))
        values[:, :, arm_kernel.OFF_ANGLE], values[:, :, arm_kernel.OFF_SPEED] = q, dq
        values[:, :, arm_kernel.OFF_ACCELERATION] = ddq
        values[:, :, arm_kernel.OFF_TORQUE] = inverse_dynamics(self._model, *flat).reshape(q.shape)
        values[:, :, arm_kernel.OFF_ELBOW, 0] = elbow_speed(self._model, *flat[:2]).reshape(q.shape[:2])
        return values


def _told(arm: LocalModel, tables: FloatArray) -> FloatArray:
    """What the local model says of nodes, (PHASES, COARSE, OFFSETS, 7)."""
    rows, told = arm.rows(), np.zeros((*tables.shape[:2], arm_kernel.OFFSETS, wam.JOINT_COUNT))
    for index in np.ndindex(*tables.shape[:2]):
        arm_kernel.arm_values(rows, tables[index], told[index])
    return told


def _node_times(times: FloatArray) -> FloatArray:
    """Times (PHASES, COARSE) of the nodes."""
    ends = np.cumsum(times)
    return np.asarray((ends - times)[:, None] + times[:, None] * nodes(COARSE).points)
