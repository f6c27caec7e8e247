"""The vendor's joint control, term by term."""

import mujoco
import numpy as np
import pytest

from slidepipe.arm import wam
from slidepipe.arm.model import Tool, nominal_model
from slidepipe.lab.controller import JointController, read_encoders, to_drive
from slidepipe.lab.protocols import JointCommand

TOOL = Tool(length_m=0.1, angle_rad=0.0)
KP = np.array([900, 2500, 600, 500, 50, 50, 8])
KI = np.array([2.5, 5, 2, 0.5, 0.5, 0.5, 0.1])
KD = np.array([10, 20, 5, 2, 0.5, 0.5, 0.05])
CLIP = np.array([25, 20, 15, 15, 5, 5, 5])
PEAK = np.array([77.3, 160.6, 95.6, 29.4, 11.6, 11.6, 2.7])
HERE = np.array([0.3, -0.5, 0.4, 1.5, -1.0, 0.2, 0.5])
STILL = np.zeros(7)


def gravity(joints_rad: np.ndarray) -> np.ndarray:
    model = nominal_model(TOOL)
    data = mujoco.MjData(model)
    data.qpos[:] = joints_rad
    mujoco.mj_forward(model, data)
    return data.qfrc_bias.copy()


@pytest.fixture
def controller() -> JointController:
    return JointController(TOOL, feedforward=True)


def test_an_arm_that_is_where_it_should_be_gets_its_gravity(controller: JointController) -> None:
    np.testing.assert_allclose(controller.torque(JointCommand(HERE, STILL, STILL), HERE), gravity(HERE), atol=1e-12)


def test_an_error_is_answered_in_proportion_and_adds_up(controller: JointController) -> None:
    error = np.array([0.002, -0.001, 0.003, 0.004, -0.02, 0.03, 0.1])
    for tick in range(1, 200):
        torque = controller.torque(JointCommand(HERE + error, STILL, STILL), HERE)
        np.testing.assert_allclose(torque - gravity(HERE), KP * error + tick * 0.002 * KI * error, atol=1e-9)


def test_a_wanted_speed_is_answered_by_damping(controller: JointController) -> None:
    wanted = np.array([0.1, -0.2, 0.3, 0.4, -0.5, 0.6, 1.0])
    torque = controller.torque(JointCommand(HERE, wanted, STILL), HERE)
    np.testing.assert_allclose(torque - gravity(HERE), KD * wanted, atol=1e-9)


def test_the_speed_is_low_passed_at_180_rad_s(controller: JointController) -> None:
    """A ramp: the first-order filter's step response at the ticks, in steps of 2^-10 rad/s."""
    speed = np.array([0.5, -0.4, 0.3, 1.0, -2.0, 3.0, 0.0])
    for tick in range(40):
        controller.torque(JointCommand(HERE, STILL, STILL), HERE + speed * 0.002 * tick)
        expected = speed * (1 - np.exp(-180 * 0.002 * tick))
        np.testing.assert_allclose(controller.velocity_rad_s, expected, atol=3 * 2**-10)
    np.testing.assert_array_equal(controller.velocity_rad_s % 2**-10, 0.0)


@pytest.mark.parametrize("way", [-1.0, 1.0])
def test_control_is_clipped_on_top_of_gravity(controller: JointController, way: float) -> None:
    torque = controller.torque(JointCommand(HERE + way, STILL, STILL), HERE)
    np.testing.assert_allclose(torque, np.clip(gravity(HERE) + way * CLIP, -PEAK, PEAK), atol=1e-9)
    assert np.any(np.abs(torque) < PEAK), "not every joint is at its peak"


@pytest.mark.parametrize("way", [-1.0, 1.0])
def test_no_joint_gets_more_than_its_peak_torque(controller: JointController, way: float) -> None:
    torque = controller.torque(JointCommand(HERE + way, STILL, np.full(7, way * 1000.0)), HERE)
    np.testing.assert_array_equal(torque, way * PEAK)


def test_feedforward_is_added_unclipped_by_the_control_and_only_where_there_is_one() -> None:
    ahead = np.array([40.0, -60.0, 30.0, 10.0, 6.0, -6.0, 1.0])
    command = JointCommand(HERE, STILL, ahead)
    with_it = JointController(TOOL, feedforward=True).torque(command, HERE)
    without = JointController(TOOL, feedforward=False).torque(command, HERE)
    np.testing.assert_allclose(with_it - without, ahead, atol=1e-12)
    np.testing.assert_allclose(without, gravity(HERE), atol=1e-12)


def test_encoders_and_drives_are_quantised_to_the_nearest_step() -> None:
    values = np.random.default_rng(0).uniform(-3, 3, 1000)
    for function, step in ((read_encoders, 2.0**-15), (to_drive, 2.0**-10)):
        shown = function(values)
        np.testing.assert_array_equal(shown % step, 0.0)
        assert np.max(np.abs(shown - values)) <= step / 2
        assert len(np.unique(shown)) > 900
    turns_of_the_motor = 2 * np.pi / 42
    assert turns_of_the_motor / 2.0**-15 == pytest.approx(4096, rel=0.25)


def test_the_gains_are_the_vendors() -> None:
    found = (wam.KP, wam.KI, wam.KD, wam.CONTROL_LIMIT, wam.PEAK_TORQUE)
    np.testing.assert_array_equal(found, [KP, KI, KD, CLIP, PEAK])
