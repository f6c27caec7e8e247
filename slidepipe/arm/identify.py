"""What the real arm has that its table does not say: link masses and joint friction, from how it was driven.

A trial records the joint angles and the torques that were applied. What the torques are beyond those of the nominal arm
under the measured motion is linear in a few numbers for each joint: the share by which what it carries is heavier, in
motion and at rest, and the dry and viscous friction that are missing. Least squares with a prior finds them; both
sides go through the same zero-phase low-pass filter, so that differentiating the encoders does no harm and nothing is
delayed.

The numbers belong to the arm and not to the motion, so that what one trial taught holds for the next, which is another
motion: a correction of the trajectory sample by sample could not be carried over.
"""

from dataclasses import dataclass

import mujoco
import numpy as np
from scipy.signal import butter, sosfiltfilt

from slidepipe.arm import wam
from slidepipe.arm.dynamics import FRICTION_SPEED_RAD_S, ArmLoad, arm_load, middles
from slidepipe.arm.inverse_kinematics import JointPath
from slidepipe.errors import InputError
from slidepipe.series import FloatArray, JointSeries

CUTOFF_HZ = 30.0
ORDER = 2
MOVING_RAD_S = 0.2
"""A joint that is slower, or about to turn, tells dry friction from viscous badly."""
PRIOR_STD = np.array([0.1, 0.1, 0.5, 0.5])
"""Standard deviations of what is looked for before anything was seen: shares of the table's numbers."""
CORRELATED = 500.0 / (2.0 * CUTOFF_HZ)
"""Samples for each independent one behind the filter."""


@dataclass(frozen=True, slots=True)
class ArmCorrection:
    """By which shares of the table's numbers each joint differs, (7,) each, and their standard deviations (7, 4).

    Attributes
    ----------
    moving_mass, resting_mass : (7,)
        Of what the joint carries, as inertia and as weight.
    coulomb, viscous : (7,)
        Of the joint's friction.
    std : (7, 4)
        In that order.
    torque_rms_n_m, left_rms_n_m : (7,)
        Of the torque that the nominal arm does not explain, and of what this correction leaves.
    """

    moving_mass: FloatArray
    resting_mass: FloatArray
    coulomb: FloatArray
    viscous: FloatArray
    std: FloatArray
    torque_rms_n_m: FloatArray
    left_rms_n_m: FloatArray


def identify(model: mujoco.MjModel, trials: list[JointSeries]) -> ArmCorrection:
    """Find the correction that the measured motions and torques of some trials ask for.

    Parameters
    ----------
    model : mujoco.MjModel
        The nominal arm.
    trials : list of JointSeries
        Measured angles and the torques applied in the tick after each, at the loop's rate.

    Raises
    ------
    InputError
        There is no trial, or one is too short to be filtered.
    """
    if not trials:
        raise InputError("arm: to identify it takes one recorded trial or more, got none")
    rows = [_regression(model, trial) for trial in trials]
    columns = np.concatenate([columns for columns, _ in rows])
    missing = np.concatenate([missing for _, missing in rows])
    shares, stds = np.empty((wam.JOINT_COUNT, 4)), np.empty((wam.JOINT_COUNT, 4))
    before, after = np.empty(wam.JOINT_COUNT), np.empty(wam.JOINT_COUNT)
    for joint in range(wam.JOINT_COUNT):
        X, y = columns[:, joint], missing[:, joint]
        shares[joint], stds[joint] = _ridge(X, y)
        before[joint], after[joint] = _rms(y), _rms(y - X @ shares[joint])
    moving, resting, coulomb, viscous = shares.T
    return ArmCorrection(moving, resting, coulomb, viscous, std=stds, torque_rms_n_m=before, left_rms_n_m=after)


def correct(load: ArmLoad, model: mujoco.MjModel, path: JointPath, correction: ArmCorrection) -> ArmLoad:
    """Torques along a path as the corrected arm needs them; what it weighs at rest is left to the joint control.

    Parameters
    ----------
    load : ArmLoad
        What is to be corrected.
    model : mujoco.MjModel
        The nominal arm, which says what each joint carries.
    path : JointPath
    correction : ArmCorrection
    """
    middle = middles(path)
    dry, viscous = _friction(middle.velocity_rad_s)
    rotors = np.array(wam.ROTOR_INERTIA) * middle.acceleration_rad_s2
    carried = arm_load(model, path).feedforward_n_m - dry - viscous - rotors
    extra = correction.moving_mass * carried + correction.coulomb * dry + correction.viscous * viscous
    extra[-1] = 0.0
    return ArmLoad(load.torque_n_m + extra, load.feedforward_n_m + extra, load.elbow_speed_m_s)


def _regression(model: mujoco.MjModel, trial: JointSeries) -> tuple[FloatArray, FloatArray]:
    """Columns (T, 7, 4) and the torques (T, 7) that they are to explain; a joint that rests counts for nothing."""
    path = _smooth_path(trial)
    still = np.zeros_like(path.position_rad)
    dry, viscous = _friction(path.velocity_rad_s)
    nominal = arm_load(model, path).torque_n_m - dry - viscous
    weight = arm_load(model, JointPath(path.time_s, path.position_rad, still, still)).torque_n_m
    carried = nominal - weight - np.array(wam.ROTOR_INERTIA) * path.acceleration_rad_s2
    # A torque is held for the tick after its sample: what acts at the sample is the mean of two.
    held = trial.effort_n_m
    applied = _filtered(0.5 * (held + np.concatenate([held[:1], held[:-1]])))
    columns = np.stack([carried, weight, _filtered(dry), _filtered(viscous)], axis=-1)
    moving = np.abs(path.velocity_rad_s) > MOVING_RAD_S
    missing = applied - nominal - _filtered(dry) - _filtered(viscous)
    return columns * moving[..., None], missing * moving


def _smooth_path(trial: JointSeries) -> JointPath:
    if len(trial.stamp_ns) < 50:
        raise InputError(f"arm: to identify it takes 50 samples of a trial or more, got {len(trial.stamp_ns)}")
    time_s = 1e-9 * (trial.stamp_ns - trial.stamp_ns[0])
    position = _filtered(trial.position_rad)
    velocity = np.gradient(position, time_s, axis=0)
    return JointPath(time_s, position, velocity, np.gradient(velocity, time_s, axis=0))


def _filtered(values: FloatArray) -> FloatArray:
    """The zero-phase low-pass: forwards, then backwards."""
    return np.asarray(sosfiltfilt(butter(ORDER, CUTOFF_HZ, fs=500.0, output="sos"), values, axis=0))


def _friction(dq: FloatArray) -> tuple[FloatArray, FloatArray]:
    dry = np.array(wam.COULOMB_FRICTION) * np.tanh(dq / FRICTION_SPEED_RAD_S)
    return dry, np.array(wam.VISCOUS_FRICTION) * dq


def _ridge(X: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Most likely shares (4,) and their standard deviations, with the noise that the fit itself leaves."""
    noise = max(_rms(y), 1e-9)
    for _ in range(5):
        precision = X.T @ X / (CORRELATED * noise**2) + np.diag(PRIOR_STD**-2.0)
        shares = np.linalg.solve(precision, X.T @ y / (CORRELATED * noise**2))
        noise = max(_rms(y - X @ shares), 1e-9)
    stds: FloatArray = np.sqrt(np.diag(np.linalg.inv(precision)))
    return np.asarray(shares, dtype=float), stds


def _rms(values: FloatArray) -> float:
    used = values[values != 0.0]
    return float(np.sqrt(np.mean(used**2))) if len(used) else 0.0
