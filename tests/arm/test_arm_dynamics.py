"""Torques that give the accelerations back, and speeds against the Denavit-Hartenberg product."""

import mujoco
import numpy as np
import pytest
from wam_by_hand import hand_frame, link_frames

from slidepipe.arm import wam
from slidepipe.arm.dynamics import ArmLoad, HandWrench, arm_load, beside_joint_control, with_wrench
from slidepipe.arm.inverse_kinematics import JointPath
from slidepipe.arm.kinematics import hand_error
from slidepipe.arm.model import HAND, Tool, nominal_model
from slidepipe.lab.controller import SPEED_RAD_S, JointController
from slidepipe.lab.protocols import JointCommand

TOOL = Tool(length_m=0.1, angle_rad=0.7)
TICK = 0.002
MIDDLE = np.array([0.3, -0.5, 0.4, 1.5, -1.0, 0.2, 0.5])
SWING = np.array([0.4, 0.3, -0.5, 0.6, -0.7, 0.4, 1.0])
RATE = np.array([5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0])


def swinging(time_s: np.ndarray) -> JointPath:
    """Every joint on a sine of its own."""
    phase = RATE * time_s[:, None]
    return JointPath(
        time_s=time_s,
        position_rad=MIDDLE + SWING * np.sin(phase),
        velocity_rad_s=SWING * RATE * np.cos(phase),
        acceleration_rad_s2=-SWING * RATE**2 * np.sin(phase),
    )


def from_rest(time_s: np.ndarray) -> JointPath:
    """As slow as the joint control's clip allows."""
    swing, phase = 0.2 * SWING, RATE * time_s[:, None]
    return JointPath(
        time_s=time_s,
        position_rad=MIDDLE + swing * (1.0 - np.cos(phase)),
        velocity_rad_s=swing * RATE * np.sin(phase),
        acceleration_rad_s2=swing * RATE**2 * np.cos(phase),
    )


def friction(dq: np.ndarray) -> np.ndarray:
    """Dry friction that turns over within 0.02 rad/s, and viscous friction."""
    return np.array(wam.COULOMB_FRICTION) * np.tanh(dq / 0.02) + np.array(wam.VISCOUS_FRICTION) * dq


def forward(model: mujoco.MjModel, q: np.ndarray, dq: np.ndarray, torque: np.ndarray) -> np.ndarray:
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:], data.qfrc_applied[:] = q, dq, torque
    mujoco.mj_forward(model, data)
    return data.qacc.copy()


def gravity(model: mujoco.MjModel, q: np.ndarray) -> np.ndarray:
    data = mujoco.MjData(model)
    data.qpos[:] = q
    mujoco.mj_forward(model, data)
    return data.qfrc_bias.copy()


@pytest.fixture(scope="module")
def model() -> mujoco.MjModel:
    return nominal_model(TOOL)


@pytest.fixture(scope="module")
def path() -> JointPath:
    return swinging(np.arange(200) * TICK)


@pytest.fixture(scope="module")
def load(model: mujoco.MjModel, path: JointPath) -> ArmLoad:
    return arm_load(model, path)


def test_the_torque_accelerates_the_arm_as_the_path_does(model: mujoco.MjModel, path: JointPath, load: ArmLoad) -> None:
    for index in range(0, 200, 7):
        q, dq = path.position_rad[index], path.velocity_rad_s[index]
        found = forward(model, q, dq, load.torque_n_m[index] - friction(dq))
        np.testing.assert_allclose(found, path.acceleration_rad_s2[index], atol=1e-7)


def test_gravity_and_feedforward_give_the_ticks_mean_acceleration_in_its_middle(
    model: mujoco.MjModel, path: JointPath, load: ArmLoad
) -> None:
    q, dq = path.position_rad, path.velocity_rad_s
    for index in range(0, 199, 7):
        middle_q, middle_dq = 0.5 * (q[index] + q[index + 1]), 0.5 * (dq[index] + dq[index + 1])
        torque = gravity(model, middle_q) + load.feedforward_n_m[index] - friction(middle_dq)
        mean = (dq[index + 1] - dq[index]) / TICK
        np.testing.assert_allclose(forward(model, middle_q, middle_dq, torque), mean, atol=1e-7)


def test_joint_control_that_sees_the_path_followed_exactly_gives_what_the_path_needs(
    model: mujoco.MjModel,
) -> None:
    """Its damping compares with a speed that is late; what that adds is in the feedforward, with the other sign."""
    path = from_rest(np.arange(200) * TICK)
    load = arm_load(model, path)
    control = JointController(TOOL, feedforward=True)
    given = beside_joint_control(load, path).feedforward_n_m
    assert np.max(np.abs(given - load.feedforward_n_m)) > 0.2
    rounding = np.array(wam.KD) * SPEED_RAD_S
    for index in range(199):
        q = path.position_rad[index]
        found = control.torque(JointCommand(q, path.velocity_rad_s[index], given[index]), q)
        needed = gravity(model, q) + load.feedforward_n_m[index]
        assert np.all(np.abs(found - needed) <= 2.0 * rounding)


def test_a_wrench_at_the_hand_is_met_by_the_torque_that_does_the_same_work(
    model: mujoco.MjModel, path: JointPath, load: ArmLoad
) -> None:
    wrench = np.tile([1.0, -2.0, 0.5, 0.1, 0.2, -0.3], (200, 1))
    torque = with_wrench(load, model, path, HandWrench(wrench, wrench)).torque_n_m - load.torque_n_m
    data, site = mujoco.MjData(model), model.site(HAND).id
    for index in range(0, 200, 31):
        data.qpos[:], data.qvel[:] = path.position_rad[index], path.velocity_rad_s[index]
        mujoco.mj_forward(model, data)
        speed = np.zeros(6)
        mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_SITE, site, speed, 0)
        power = wrench[index, :3] @ speed[3:] + wrench[index, 3:] @ speed[:3]
        assert torque[index] @ data.qvel == pytest.approx(power, abs=1e-9)


def test_an_arm_that_is_only_fed_forward_follows_the_path_for_a_while(
    model: mujoco.MjModel, path: JointPath, load: ArmLoad
) -> None:
    """Held for a tick each on top of gravity compensation, integrated by MuJoCo without any feedback."""
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:] = path.position_rad[0], path.velocity_rad_s[0]
    step_s, steps = model.opt.timestep, round(0.12 / model.opt.timestep)
    per_tick = round(TICK / step_s)
    assert per_tick * step_s == pytest.approx(TICK)
    held = np.zeros(7)
    for step in range(steps):
        if step % per_tick == 0:
            held = load.feedforward_n_m[step // per_tick]
        data.qfrc_applied[:] = gravity(model, data.qpos) + held - friction(data.qvel)
        mujoco.mj_step(model, data)
    moved = np.max(np.abs(path.position_rad[60] - path.position_rad[0]))
    assert moved > 0.3
    np.testing.assert_allclose(data.qpos, path.position_rad[60], atol=0.02 * moved)


def test_an_arm_at_rest_needs_its_gravity_and_nothing_more(model: mujoco.MjModel) -> None:
    still = np.zeros((5, 7))
    load = arm_load(model, JointPath(np.arange(5) * TICK, np.tile(MIDDLE, (5, 1)), still, still))
    np.testing.assert_allclose(load.torque_n_m, np.tile(gravity(model, MIDDLE), (5, 1)), atol=1e-12)
    np.testing.assert_allclose(load.feedforward_n_m, 0.0, atol=1e-12)
    np.testing.assert_array_equal(load.elbow_speed_m_s, 0.0)


def test_nothing_is_fed_forward_after_the_last_sample(load: ArmLoad) -> None:
    np.testing.assert_array_equal(load.feedforward_n_m[-1], 0.0)
    assert np.max(np.abs(load.feedforward_n_m[-2])) > 1.0


def test_the_elbow_speed_is_that_of_the_point_past_the_elbow(path: JointPath, load: ArmLoad) -> None:
    h = 1e-5
    ahead, behind = swinging(path.time_s + h).position_rad, swinging(path.time_s - h).position_rad

    def point(joints: np.ndarray) -> np.ndarray:
        elbow = link_frames(joints)[4]
        return elbow[:3, 3] + 0.35 * elbow[:3, 2]

    for index in range(0, 200, 13):
        speed = np.linalg.norm(point(ahead[index]) - point(behind[index])) / (2 * h)
        assert load.elbow_speed_m_s[index] == pytest.approx(speed, rel=1e-6)


def test_a_hand_error_by_the_last_joint_is_an_angle_alone(model: mujoco.MjModel) -> None:
    joints = np.tile(MIDDLE, (4, 1))
    turned = joints + np.outer([0.0, 1e-3, -0.5, 2.0], np.eye(7)[6])
    error = hand_error(model, joints, turned)
    np.testing.assert_allclose(error.position_m, 0.0, atol=1e-12)
    np.testing.assert_allclose(error.angle_rad, [0.0, 1e-3, 0.5, 2.0], atol=1e-7)


def test_a_hand_error_by_the_first_joint_is_a_chord(model: mujoco.MjModel) -> None:
    hand = hand_frame(MIDDLE, TOOL.length_m, TOOL.angle_rad)[:3, 3]
    radius = np.hypot(hand[0], hand[1])
    turns = np.array([1e-4, 0.1, 1.0])
    error = hand_error(model, np.tile(MIDDLE, (3, 1)), MIDDLE + np.outer(turns, np.eye(7)[0]))
    np.testing.assert_allclose(error.position_m, 2 * radius * np.sin(turns / 2), rtol=1e-9)
    np.testing.assert_allclose(error.angle_rad, turns, atol=1e-7)
