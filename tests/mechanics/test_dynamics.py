"""Sections VI and VIII: the object's dynamics against closed forms, finite differences and published numbers."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from mechanics_draws import ANGLES, BLOCKS, FINGERS, OFFSETS, POSES, SLIDES
from paper_cases import BLOCK, LINEAR, ROTATIONAL, linear_finger, rotational_finger

from slidepipe.errors import InputError
from slidepipe.mechanics.dynamics import (
    Block,
    about_com,
    finger_acceleration,
    finger_velocity,
    sliding_acceleration,
    sticking_load,
)
from slidepipe.mechanics.limit_surface import SoftFinger
from slidepipe.mechanics.planar import finger_pose, rotation

SMOOTH = arrays(float, (2, 3, 5), elements=st.floats(-1, 1))
"""Coefficients of two motions in the plane: a polynomial of degree four for each coordinate."""


def grasp_map(r_f: np.ndarray) -> np.ndarray:
    """G of eq. (15)."""
    return np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-r_f[1], r_f[0], 1.0]])


def test_the_inertia_is_that_of_many_small_masses() -> None:
    x, y = np.meshgrid((np.arange(400) + 0.5) / 400 * 0.06 - 0.03, (np.arange(400) + 0.5) / 400 * 0.1 - 0.05)
    assert BLOCK.inertia == pytest.approx(BLOCK.m * np.mean(x**2 + y**2), rel=1e-4)
    np.testing.assert_array_equal(BLOCK.M, [BLOCK.m, BLOCK.m, BLOCK.inertia])


def test_gravity_pulls_at_the_centre_of_mass_down_along_y() -> None:
    np.testing.assert_allclose(BLOCK.g, [0.0, -0.22563, 0.0], atol=1e-12)


@given(OFFSETS, OFFSETS)
def test_a_wrench_about_the_com_is_eq_15(f: np.ndarray, r_f: np.ndarray) -> None:
    np.testing.assert_allclose(about_com(f, r_f), grasp_map(r_f) @ f, atol=1e-15)


@given(POSES, OFFSETS, OFFSETS, OFFSETS)
def test_a_wrench_does_the_same_work_at_the_contact_and_at_the_com(
    q_o: np.ndarray, dq_o: np.ndarray, r_f_b: np.ndarray, f: np.ndarray
) -> None:
    """Duality: the object's velocity at the contact is that of a finger that does not slide."""
    contact_velocity = finger_velocity(q_o[2], dq_o, r_f_b, np.zeros(3))
    r_f = rotation(q_o[2]) @ r_f_b
    assert about_com(f, r_f) @ dq_o == pytest.approx(f @ contact_velocity, abs=1e-11)


@given(POSES, OFFSETS, OFFSETS, SLIDES)
def test_the_sliding_velocity_of_eq_18_is_the_derivative_in_the_body_frame(
    q_o: np.ndarray, dq_o: np.ndarray, r_f_b: np.ndarray, dr_f_b: np.ndarray
) -> None:
    r_f = rotation(q_o[2]) @ r_f_b
    dv = finger_velocity(q_o[2], dq_o, r_f_b, dr_f_b) - grasp_map(r_f).T @ dq_o
    np.testing.assert_allclose(dv, rotation(q_o[2]) @ dr_f_b, atol=1e-11)


@given(SMOOTH)
def test_the_fingers_velocity_and_acceleration_are_derivatives_of_its_pose(coefficients: np.ndarray) -> None:
    def motion(which: int, t: np.ndarray, order: int) -> np.ndarray:
        polynomials = (np.polynomial.Polynomial(row) for row in coefficients[which])
        return np.stack([(p.deriv(order) if order else p)(t) for p in polynomials], axis=-1)

    def pose(t: np.ndarray) -> np.ndarray:
        return finger_pose(motion(0, t, 0), motion(1, t, 0))

    t, h = np.linspace(-0.5, 0.5, 7), 1e-3
    q_o, dq_o, ddq_o = (motion(0, t, order) for order in range(3))
    r_b, dr_b, ddr_b = (motion(1, t, order) for order in range(3))
    near, far = (pose(t + h), pose(t - h)), (pose(t + 2 * h), pose(t - 2 * h))
    velocity = (8 * (near[0] - near[1]) - (far[0] - far[1])) / (12 * h)
    acceleration = (16 * (near[0] + near[1]) - (far[0] + far[1]) - 30 * pose(t)) / (12 * h**2)
    np.testing.assert_allclose(finger_velocity(q_o[:, 2], dq_o, r_b, dr_b), velocity, atol=1e-7)
    found = finger_acceleration(q_o[:, 2], dq_o[:, 2], ddq_o, r_f_b=r_b, dr_f_b=dr_b, ddr_f_b=ddr_b)
    np.testing.assert_allclose(found, acceleration, atol=1e-5)


@pytest.mark.parametrize(("normal_force_n", "gained"), [(1.25, (1.85, 1.73)), (2.5, (3.69, 5.43))])
def test_the_linear_slide_changes_the_objects_velocity_as_published(
    normal_force_n: float, gained: tuple[float, float]
) -> None:
    share = np.linspace(0, 1, 11)[:, None]
    r_b = LINEAR.r_start + share * (LINEAR.r_goal - LINEAR.r_start)
    ddq_o = sliding_acceleration(
        BLOCK, linear_finger(normal_force_n=normal_force_n), np.zeros(11), r_b, np.array([2.0, 4.0, 0.0])
    )
    np.testing.assert_allclose(ddq_o[:, :2] * LINEAR.T23, np.tile(gained, (11, 1)), atol=0.005)
    np.testing.assert_allclose(ddq_o[:, 2], 0.0, atol=1e-9, err_msg="the force passes through the centre of mass")


@pytest.mark.parametrize(("normal_force_n", "published"), [(2.5, -110.0), (5.0, -219.0)])
def test_the_rotational_slide_turns_the_object_as_published(normal_force_n: float, published: float) -> None:
    finger = rotational_finger(normal_force_n=normal_force_n)
    dv = np.array([2.0, 0.0, 25 * np.pi])
    for r_b in (ROTATIONAL.r_start, ROTATIONAL.r_goal):
        assert sliding_acceleration(BLOCK, finger, 0.0, r_b, dv)[2] == pytest.approx(published, abs=1.0)


@given(BLOCKS, FINGERS, POSES, OFFSETS, SLIDES)
def test_a_sliding_object_obeys_newton_and_euler(
    block: Block, finger: SoftFinger, q_o: np.ndarray, r_f_b: np.ndarray, dv_b: np.ndarray
) -> None:
    """Force and moment about the centre of mass, in complex numbers."""
    fx, fy, mz = finger.friction(dv_b)
    force = np.exp(1j * q_o[2]) * complex(fx, fy)
    arm = np.exp(1j * q_o[2]) * complex(r_f_b[0], r_f_b[1])
    linear = force / block.m - 9.81j
    angular = (mz + (np.conj(arm) * force).imag) / (block.m * (block.length**2 + block.width**2) / 12)
    found = sliding_acceleration(block, finger, q_o[2], r_f_b, dv_b)
    np.testing.assert_allclose(found, [linear.real, linear.imag, angular], rtol=1e-9, atol=1e-9 * abs(force) / block.m)


@given(BLOCKS, FINGERS, POSES, OFFSETS, SLIDES)
def test_an_object_that_accelerates_as_if_it_slid_is_about_to_slide(
    block: Block, finger: SoftFinger, q_o: np.ndarray, r_f_b: np.ndarray, dv_b: np.ndarray
) -> None:
    ddq_o = sliding_acceleration(block, finger, q_o[2], r_f_b, dv_b)
    assert sticking_load(block, finger, q_o[2], ddq_o, r_f_b) == pytest.approx(1.0, rel=1e-9)


@given(BLOCKS, FINGERS, POSES, OFFSETS)
def test_a_falling_object_needs_no_friction(
    block: Block, finger: SoftFinger, q_o: np.ndarray, r_f_b: np.ndarray
) -> None:
    assert sticking_load(block, finger, q_o[2], np.array([0.0, -9.81, 0.0]), r_f_b) == pytest.approx(0.0, abs=1e-9)


def test_0_315_n_of_friction_just_hold_the_linear_examples_goal() -> None:
    """Closed form: weight W at a horizontal distance x needs ``W sqrt(1 + (x / (a c))^2)``."""
    just = 0.023 * 9.81 * np.sqrt(1 + (0.01 / (0.0174 * 0.6)) ** 2)
    assert just == pytest.approx(0.315, rel=0.01)
    for friction_n, load in ((just, 1.0), (2 * just, 0.5)):
        finger = SoftFinger(mu=friction_n, f_N=1.0, a=0.0174, c=0.6)
        assert sticking_load(BLOCK, finger, 0.0, np.zeros(3), LINEAR.r_goal) == pytest.approx(load, rel=1e-12)


@given(BLOCKS, FINGERS, POSES, OFFSETS, st.floats(0.1, 10))
def test_a_heavier_object_with_as_much_more_grip_moves_alike(
    block: Block, finger: SoftFinger, q_o: np.ndarray, r_f_b: np.ndarray, factor: float
) -> None:
    heavier = Block(block.length, block.width, factor * block.m)
    stronger = SoftFinger(finger.mu, factor * finger.f_N, finger.a, finger.c)
    dv_b = np.array([0.3, -0.2, 2.0])
    first, second = (sliding_acceleration(b, f, q_o[2], r_f_b, dv_b) for b, f in ((block, finger), (heavier, stronger)))
    np.testing.assert_allclose(first, second, rtol=1e-9, atol=1e-9 * np.max(np.abs(first)))


@given(BLOCKS, FINGERS, ANGLES, OFFSETS, st.floats(0.1, 10))
def test_a_grasp_twice_as_large_accelerates_alike_and_turns_half_as_fast(
    block: Block, finger: SoftFinger, theta: float, r_f_b: np.ndarray, factor: float
) -> None:
    dv_b, lengths = np.array([0.3, -0.2, 2.0]), np.array([factor, factor, 1.0])
    larger = Block(factor * block.length, factor * block.width, block.m)
    wider = SoftFinger(finger.mu, finger.f_N, factor * finger.a, finger.c)
    first = sliding_acceleration(block, finger, theta, r_f_b, dv_b)
    second = sliding_acceleration(larger, wider, theta, r_f_b * lengths, dv_b * lengths)
    size = np.max(np.abs(first))
    np.testing.assert_allclose(second * [1.0, 1.0, factor], first, rtol=1e-9, atol=1e-9 * size)


@given(BLOCKS, FINGERS, POSES, OFFSETS, ANGLES)
def test_the_load_does_not_depend_on_which_way_the_body_frame_points(
    block: Block, finger: SoftFinger, q_o: np.ndarray, r_f_b: np.ndarray, angle: float
) -> None:
    ddq_o = np.array([3.0, -2.0, 40.0])
    load = sticking_load(block, finger, q_o[2], ddq_o, r_f_b)
    turned = sticking_load(block, finger, q_o[2] + angle, ddq_o, rotation(-angle) @ r_f_b)
    assert turned == pytest.approx(float(load), rel=1e-9)


@pytest.mark.parametrize("name", ["length", "width", "m"])
@pytest.mark.parametrize("value", [0.0, -0.1, np.nan, np.inf])
def test_a_block_is_made_of_positive_numbers(name: str, value: float) -> None:
    numbers = {"length": 0.1, "width": 0.06, "m": 0.023} | {name: value}
    with pytest.raises(InputError, match=rf"^block: {name} must be a positive number, got {value!r}$"):
        Block(**numbers)
