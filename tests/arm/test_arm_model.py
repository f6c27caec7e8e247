"""The MuJoCo model against its table multiplied out by hand, and against published numbers."""

import mujoco
import numpy as np
import pytest
from wam_by_hand import DH, LOWER, MASS, UPPER, hand_frame, link_frames, mass_matrix, random_joints

from slidepipe.arm import wam
from slidepipe.arm.model import ELBOW, FLANGE, HAND, Tool, arm_spec, nominal_model

TOOL = Tool(length_m=0.1, angle_rad=0.7)


def posed(model: mujoco.MjModel, joints_rad: np.ndarray) -> mujoco.MjData:
    data = mujoco.MjData(model)
    data.qpos[:] = joints_rad
    mujoco.mj_forward(model, data)
    return data


@pytest.fixture(scope="module")
def bare() -> mujoco.MjModel:
    return arm_spec(TOOL).compile()


def test_the_table_is_the_vendors() -> None:
    assert [(link.alpha_rad, link.a_m, link.d_m) for link in wam.LINKS] == list(DH)
    assert [link.range_rad for link in wam.LINKS] == list(zip(LOWER, UPPER, strict=True))
    assert [link.mass_kg for link in wam.LINKS] == list(MASS)


def test_every_link_is_where_the_table_says(bare: mujoco.MjModel) -> None:
    random = np.random.default_rng(1)
    for _ in range(50):
        joints = random_joints(random)
        data = posed(bare, joints)
        for index, frame in enumerate(link_frames(joints)[1:], start=1):
            body = data.body(f"link{index}")
            np.testing.assert_allclose(body.xpos, frame[:3, 3], atol=1e-12)
            np.testing.assert_allclose(body.xmat.reshape(3, 3), frame[:3, :3], atol=1e-12)


def test_the_hand_is_where_the_table_and_the_tool_say(bare: mujoco.MjModel) -> None:
    random = np.random.default_rng(2)
    for _ in range(50):
        joints = random_joints(random)
        hand = posed(bare, joints).site(HAND)
        frame = hand_frame(joints, TOOL.length_m, TOOL.angle_rad)
        np.testing.assert_allclose(hand.xpos, frame[:3, 3], atol=1e-12)
        np.testing.assert_allclose(hand.xmat.reshape(3, 3), frame[:3, :3], atol=1e-12)


def test_at_zero_the_arm_stands_straight_up(bare: mujoco.MjModel) -> None:
    data = posed(bare, np.zeros(7))
    np.testing.assert_allclose(data.body(FLANGE).xpos, [0.0, 0.0, 0.9109], atol=1e-12)
    np.testing.assert_allclose(data.site(HAND).xpos, [0.0, 0.0, 1.0109], atol=1e-12)
    np.testing.assert_allclose(data.site(ELBOW).xpos, [0.0, 0.0, 0.9], atol=1e-12)


def test_the_elbow_point_is_350_mm_past_the_elbow(bare: mujoco.MjModel) -> None:
    random = np.random.default_rng(3)
    for _ in range(10):
        joints = random_joints(random)
        forearm = link_frames(joints)[4]
        expected = forearm[:3, 3] + 0.35 * forearm[:3, 2]
        np.testing.assert_allclose(posed(bare, joints).site(ELBOW).xpos, expected, atol=1e-12)


def test_the_joints_stop_at_the_vendors_limits(bare: mujoco.MjModel) -> None:
    np.testing.assert_array_equal(bare.jnt_range, np.column_stack([LOWER, UPPER]))
    assert bare.jnt_limited.all()


def test_gravity_asks_for_the_published_torques(bare: mujoco.MjModel) -> None:
    torque = posed(bare, np.array([0.0, np.pi / 2, 0, 0, 0, 0, 0])).qfrc_bias
    np.testing.assert_allclose(torque, [0.0, -27.96, -0.06, -5.06, -0.06, -0.14, 0.0], atol=0.005)


def test_the_mass_matrix_is_that_of_the_links_in_their_own_frames(bare: mujoco.MjModel) -> None:
    random, found = np.random.default_rng(4), np.empty((7, 7))
    for _ in range(20):
        joints = random_joints(random)
        data = posed(bare, joints)
        mujoco.mj_fullM(bare, data, found)
        np.testing.assert_allclose(found, mass_matrix(joints), atol=1e-9)


def test_a_heavier_arm_is_heavier_in_every_link_but_not_in_its_rotors(bare: mujoco.MjModel) -> None:
    heavier = arm_spec(TOOL, mass_scale=1.1).compile()
    np.testing.assert_allclose(heavier.body_mass, 1.1 * bare.body_mass, rtol=1e-12)
    np.testing.assert_allclose(heavier.body_inertia, 1.1 * bare.body_inertia, rtol=1e-9)
    np.testing.assert_array_equal(heavier.dof_armature, bare.dof_armature)
    np.testing.assert_allclose(heavier.body_ipos, bare.body_ipos)


def test_the_nominal_arm_carries_the_gripper_between_flange_and_contact(bare: mujoco.MjModel) -> None:
    joints = random_joints(np.random.default_rng(5))
    loaded, empty = posed(nominal_model(TOOL), joints), posed(bare, joints)
    frame = link_frames(joints)[7]
    gripper = frame[:3, 3] + 0.05 * frame[:3, 2]
    axes = [f[:3, 2] for f in link_frames(joints)[:7]]
    origins = [f[:3, 3] for f in link_frames(joints)[:7]]
    lever = [np.cross(axis, gripper - origin)[2] for axis, origin in zip(axes, origins, strict=True)]
    np.testing.assert_allclose(loaded.qfrc_bias - empty.qfrc_bias, 0.105 * 9.81 * np.array(lever), atol=1e-12)
