"""The vendor's joint position control: PID with a clip, on top of gravity compensation."""

import mujoco
import numpy as np

from slidepipe.arm import wam
from slidepipe.arm.model import Tool, nominal_model
from slidepipe.lab.protocols import JointCommand
from slidepipe.series import FloatArray
from slidepipe.tick import TICK_S

ENCODER_RAD = 2.0**-15
"""Resolution of the joint angle: about 4096 counts a turn of the motor behind a reduction of 42."""
DRIVE_N_M = 2.0**-10
"""Resolution of the joint torque."""
SPEED_RAD_S = 2.0**-10
"""Resolution of the joint speed that the control loop reports."""


class JointController:
    """Turns commands and encoder readings into joint torques at 500 Hz.

    The gravity compensation and the feedforward know the nominal arm, never the simulated one. The vendor's own program
    has no feedforward.
    """

    def __init__(self, tool: Tool, *, feedforward: bool) -> None:
        self._model = nominal_model(tool)
        self._data = mujoco.MjData(self._model)
        self._feedforward = feedforward
        self._integral = np.zeros(wam.JOINT_COUNT)
        self._last_position: FloatArray | None = None
        self.velocity_rad_s = np.zeros(wam.JOINT_COUNT)

    def torque(self, command: JointCommand, position_rad: FloatArray) -> FloatArray:
        """Torques (7,) in N m to hold for the coming tick, within the drives' peak torques."""
        self._measure_speed(position_rad)
        error = command.position_rad - position_rad
        self._integral += np.array(wam.KI) * error * TICK_S
        damping = np.array(wam.KD) * (command.velocity_rad_s - self.velocity_rad_s)
        control = np.array(wam.KP) * error + self._integral + damping
        limit = np.array(wam.CONTROL_LIMIT)
        torque = self._gravity(position_rad) + np.clip(control, -limit, limit)
        if self._feedforward:
            torque += command.feedforward_n_m
        peak = np.array(wam.PEAK_TORQUE)
        return np.asarray(np.clip(torque, -peak, peak))

    def _measure_speed(self, position_rad: FloatArray) -> None:
        """Differentiate the encoders and low-pass the result, as the vendor's loop does."""
        if self._last_position is not None:
            raw = (position_rad - self._last_position) / TICK_S
            blend = 1.0 - np.exp(-wam.VELOCITY_FILTER_RAD_S * TICK_S)
            self.velocity_rad_s = _rounded(self.velocity_rad_s + blend * (raw - self.velocity_rad_s), SPEED_RAD_S)
        self._last_position = position_rad.copy()

    def _gravity(self, position_rad: FloatArray) -> FloatArray:
        self._data.qpos[:] = position_rad
        self._data.qvel[:] = 0.0
        mujoco.mj_kinematics(self._model, self._data)
        mujoco.mj_comPos(self._model, self._data)
        torque = np.empty(wam.JOINT_COUNT)
        mujoco.mj_rne(self._model, self._data, 0, torque)
        return torque


def read_encoders(position_rad: FloatArray) -> FloatArray:
    """Joint angles as the encoders show them."""
    return _rounded(position_rad, ENCODER_RAD)


def to_drive(torque_n_m: FloatArray) -> FloatArray:
    """Torques as the drives take them."""
    return _rounded(torque_n_m, DRIVE_N_M)


def _rounded(values: FloatArray, step: float) -> FloatArray:
    return np.asarray(np.round(np.asarray(values) / step) * step)
