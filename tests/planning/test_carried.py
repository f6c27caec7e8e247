"""What the object asks of the arm beyond a mass at the hand, against the wrench that friction must supply."""

import numpy as np
import pytest

from slidepipe.mechanics.dynamics import GRAVITY, Block
from slidepipe.mechanics.planar import MotionPlane, rotation
from slidepipe.mechanics.sticking import needed_wrench
from slidepipe.planning.carried import carried_wrench
from slidepipe.planning.course import Motion

BLOCK = Block(length=0.06, width=0.1, m=0.023)
PLANE = MotionPlane(np.array([0.5, 0.0, 0.4]), 0.7)


@pytest.fixture
def random() -> np.random.Generator:
    return np.random.default_rng(5)


def random_motion(random: np.random.Generator) -> Motion:
    poses = [random.normal(size=(20, 3)) for _ in range(6)]
    return Motion(np.arange(20.0), *poses, r_b=np.zeros((20, 3)), dr_b=np.zeros((20, 3)), load=np.zeros(20))


def test_with_a_mass_in_the_contact_it_is_the_wrench_of_friction(random: np.random.Generator) -> None:
    motion = random_motion(random)
    wrench = carried_wrench(motion, BLOCK, PLANE)
    on_object = np.einsum(
        "tij,tj->ti", rotation(motion.q_o[:, 2]), needed_wrench(BLOCK, motion.q_o[:, 2], motion.ddq_o)
    )
    lumped = BLOCK.m * (motion.ddq_f[:, :2] + np.array([0.0, GRAVITY]))
    in_plane = wrench[:, :3] @ PLANE.axes
    np.testing.assert_allclose(in_plane[:, :2] + lumped, on_object[:, :2], atol=1e-12)
    np.testing.assert_allclose(in_plane[:, 2], 0.0, atol=1e-12)
    arm = motion.q_o[:, :2] - motion.q_f[:, :2]
    moment = on_object[:, 2] + arm[:, 0] * on_object[:, 1] - arm[:, 1] * on_object[:, 0]
    np.testing.assert_allclose(wrench[:, 3:], moment[:, None] * PLANE.axes[:, 2], atol=1e-12)


def test_an_object_that_rests_with_its_centre_in_the_contact_asks_for_nothing() -> None:
    still = np.zeros((5, 3))
    motion = Motion(np.arange(5.0), *[still] * 6, r_b=still, dr_b=still, load=np.zeros(5))
    assert np.max(np.abs(carried_wrench(motion, BLOCK, PLANE))) == pytest.approx(0.0)
