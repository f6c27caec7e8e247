"""Poses in the plane against complex numbers, and the plane in space against its own definition."""

import numpy as np
import pytest
from hypothesis import given
from mechanics_draws import ANGLES, OFFSETS, POSES

from slidepipe.errors import InputError
from slidepipe.mechanics.planar import MotionPlane, finger_pose, object_pose, relative_pose, rotation


def as_complex(pose: np.ndarray) -> complex:
    return complex(pose[0], pose[1])


@given(POSES, OFFSETS)
def test_the_finger_is_where_complex_numbers_put_it(q_o: np.ndarray, r_f_b: np.ndarray) -> None:
    q_f = finger_pose(q_o, r_f_b)
    assert as_complex(q_f) == pytest.approx(as_complex(q_o) + np.exp(1j * q_o[2]) * as_complex(r_f_b), abs=1e-12)
    assert q_f[2] == pytest.approx(q_o[2] + r_f_b[2], abs=1e-12)


@given(POSES, OFFSETS)
def test_relative_pose_undoes_finger_pose(q_o: np.ndarray, r_f_b: np.ndarray) -> None:
    np.testing.assert_allclose(relative_pose(q_o, finger_pose(q_o, r_f_b)), r_f_b, atol=1e-12)


@given(POSES, OFFSETS)
def test_object_pose_undoes_finger_pose(q_o: np.ndarray, r_f_b: np.ndarray) -> None:
    np.testing.assert_allclose(object_pose(finger_pose(q_o, r_f_b), r_f_b), q_o, atol=1e-12)


@given(POSES, POSES, POSES)
def test_the_relative_pose_does_not_depend_on_the_world_frame(
    moved: np.ndarray, q_o: np.ndarray, q_f: np.ndarray
) -> None:
    elsewhere = relative_pose(finger_pose(moved, q_o), finger_pose(moved, q_f))
    np.testing.assert_allclose(elsewhere, relative_pose(q_o, q_f), atol=1e-11)


@given(ANGLES, ANGLES)
def test_rotations_compose(first: float, second: float) -> None:
    np.testing.assert_allclose(rotation(first) @ rotation(second), rotation(first + second), atol=1e-12)
    np.testing.assert_allclose(rotation(first).T, rotation(-first), atol=1e-15)


def test_many_poses_at_once_are_each_for_itself() -> None:
    random = np.random.default_rng(0)
    q_o, r_f_b = random.normal(size=(2, 5, 4, 3))
    for function, first in ((finger_pose, q_o), (relative_pose, q_o), (object_pose, q_o)):
        one_by_one = [[function(a, b) for a, b in zip(*rows, strict=True)] for rows in zip(first, r_f_b, strict=True)]
        np.testing.assert_array_equal(function(first, r_f_b), one_by_one)
    np.testing.assert_allclose(finger_pose(q_o, r_f_b[0, 0])[2, 3], finger_pose(q_o[2, 3], r_f_b[0, 0]))


@given(ANGLES)
def test_the_planes_axes_are_right_handed_and_y_is_up(heading_rad: float) -> None:
    axes = MotionPlane(np.zeros(3), heading_rad).axes
    np.testing.assert_allclose(axes.T @ axes, np.eye(3), atol=1e-15)
    assert np.linalg.det(axes) == pytest.approx(1.0)
    np.testing.assert_array_equal(axes[:, 1], [0.0, 0.0, 1.0])
    np.testing.assert_allclose(axes[:, 0], [np.cos(heading_rad), np.sin(heading_rad), 0.0])


def test_a_plane_that_heads_left_of_the_arm() -> None:
    plane = MotionPlane(np.array([0.4, -0.3, 0.5]), np.pi / 2)
    position, matrix = plane.lift(np.array([0.1, 0.2, np.pi / 2]))
    np.testing.assert_allclose(position, [0.4, -0.2, 0.7], atol=1e-15)
    np.testing.assert_allclose(matrix, [[0, 0, 1], [0, -1, 0], [1, 0, 0]], atol=1e-15)


@given(POSES, ANGLES)
def test_project_undoes_lift_up_to_whole_turns(pose: np.ndarray, heading_rad: float) -> None:
    plane = MotionPlane(np.array([0.3, -0.2, 0.6]), heading_rad)
    back = plane.project(*plane.lift(pose))
    np.testing.assert_allclose(back[:2], pose[:2], atol=1e-12)
    assert np.exp(1j * back[2]) == pytest.approx(np.exp(1j * pose[2]), abs=1e-12)
    assert -np.pi <= back[2] <= np.pi


def test_project_drops_what_is_across_the_plane() -> None:
    plane = MotionPlane(np.array([0.3, -0.2, 0.6]), 0.7)
    position, matrix = plane.lift(np.array([0.1, 0.2, 0.3]))
    off_the_plane = plane.project(position + 0.05 * plane.axes[:, 2], matrix)
    np.testing.assert_allclose(off_the_plane, [0.1, 0.2, 0.3], atol=1e-15)


@pytest.mark.parametrize("origin", [np.zeros(2), np.array([0.0, np.nan, 0.0]), np.array([np.inf, 0.0, 0.0])])
def test_an_origin_is_three_finite_numbers(origin: np.ndarray) -> None:
    with pytest.raises(InputError, match=r"motion plane: origin_m must be three finite numbers, got "):
        MotionPlane(origin, 0.0)


@pytest.mark.parametrize("heading", [np.nan, np.inf])
def test_a_heading_is_a_finite_number(heading: float) -> None:
    with pytest.raises(InputError, match=r"motion plane: heading_rad must be a finite number, got "):
        MotionPlane(np.zeros(3), heading)
