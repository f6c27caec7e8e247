"""The soft finger's ellipsoid against Section V: eqs. (10) to (14) and what they must imply."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from mechanics_draws import ANGLES, FINGERS, SLIDES

from slidepipe.errors import InputError
from slidepipe.mechanics.limit_surface import SoftFinger
from slidepipe.mechanics.planar import rotation

FINGER = SoftFinger(mu=0.38, f_N=1.25, a=0.0174, c=0.6)
WRENCHES = arrays(float, 3, elements=st.floats(-1, 1))


def matrix_a(finger: SoftFinger) -> np.ndarray:
    """A of eq. (10), from the paper's words."""
    force = finger.mu * finger.f_N
    return np.diag([force**-2, force**-2, (finger.a * finger.c * force) ** -2])


def test_the_semi_axes_of_the_papers_linear_example() -> None:
    np.testing.assert_allclose(FINGER.semi_axes, [0.475, 0.475, 0.004959], rtol=1e-12)


@given(FINGERS, SLIDES)
def test_friction_lies_on_the_surface(finger: SoftFinger, dv: np.ndarray) -> None:
    f = finger.friction(dv)
    assert f @ matrix_a(finger) @ f == pytest.approx(1.0, rel=1e-12)
    assert finger.load(f) == pytest.approx(1.0, rel=1e-12)


@given(FINGERS, SLIDES)
def test_friction_points_where_the_slide_is_normal_to_the_surface(finger: SoftFinger, dv: np.ndarray) -> None:
    normal = 2.0 * matrix_a(finger) @ finger.friction(dv)
    lam = 0.5 * np.sqrt(dv @ np.linalg.inv(matrix_a(finger)) @ dv)
    np.testing.assert_allclose(lam * normal, dv, atol=1e-9 * np.linalg.norm(dv))


@given(FINGERS, SLIDES, arrays(float, (40, 3), elements=st.floats(-1, 1)))
def test_no_wrench_that_the_contact_can_bear_dissipates_more(
    finger: SoftFinger, dv: np.ndarray, inside: np.ndarray
) -> None:
    others = inside / np.maximum(1.0, np.linalg.norm(inside, axis=1))[:, None] * finger.semi_axes
    power = finger.friction(dv) @ dv
    assert np.all(others @ dv <= power * (1 + 1e-12))
    assert power > 0.0


@given(FINGERS, SLIDES)
def test_the_power_is_the_ellipsoids_support(finger: SoftFinger, dv: np.ndarray) -> None:
    assert finger.friction(dv) @ dv == pytest.approx(np.linalg.norm(finger.semi_axes * dv), rel=1e-12)


@given(FINGERS, SLIDES, ANGLES)
def test_friction_is_the_same_in_every_rotated_frame(finger: SoftFinger, dv: np.ndarray, angle: float) -> None:
    turned = finger.friction(rotation(angle) @ dv)
    np.testing.assert_allclose(turned, rotation(angle) @ finger.friction(dv), atol=1e-12 * finger.mu * finger.f_N)


@given(FINGERS, SLIDES, st.floats(1e-9, 1e6))
def test_how_fast_it_slides_does_not_matter_only_where_to(finger: SoftFinger, dv: np.ndarray, factor: float) -> None:
    np.testing.assert_allclose(finger.friction(factor * dv), finger.friction(dv), rtol=1e-9, atol=1e-300)
    np.testing.assert_array_equal(finger.friction(-dv), -finger.friction(dv))


@given(FINGERS, ANGLES)
def test_sliding_straight_meets_coulombs_force_and_no_moment(finger: SoftFinger, angle: float) -> None:
    f = finger.friction(0.3 * np.array([np.cos(angle), np.sin(angle), 0.0]))
    assert np.hypot(f[0], f[1]) == pytest.approx(finger.mu * finger.f_N, rel=1e-12)
    assert f[2] == 0.0


@given(FINGERS, st.sampled_from([-1.0, 1.0]))
def test_turning_on_the_spot_meets_the_largest_moment_and_no_force(finger: SoftFinger, way: float) -> None:
    f = finger.friction(np.array([0.0, 0.0, 3.0 * way]))
    np.testing.assert_allclose(f, [0.0, 0.0, way * finger.a * finger.c * finger.mu * finger.f_N], rtol=1e-12)


@given(FINGERS)
def test_force_and_moment_share_equally_where_the_slide_is_as_fast_as_the_turn(finger: SoftFinger) -> None:
    f = finger.friction(np.array([finger.a * finger.c, 0.0, 1.0]))
    np.testing.assert_allclose(f / finger.semi_axes, [np.sqrt(0.5), 0.0, np.sqrt(0.5)], rtol=1e-12)


@given(FINGERS, SLIDES)
def test_friction_in_millimetres_is_friction_in_metres(finger: SoftFinger, dv: np.ndarray) -> None:
    in_mm = SoftFinger(finger.mu, finger.f_N, 1e3 * finger.a, finger.c).friction(dv * [1e3, 1e3, 1.0])
    in_m = finger.friction(dv)
    np.testing.assert_allclose(in_mm, in_m * [1.0, 1.0, 1e3], rtol=1e-9, atol=1e-300)


@given(FINGERS, WRENCHES, st.floats(0, 5))
def test_the_load_grows_with_the_wrench(finger: SoftFinger, share: np.ndarray, factor: float) -> None:
    f = share * finger.semi_axes
    assert finger.load(factor * f) == pytest.approx(factor * finger.load(f), abs=1e-12)
    assert finger.load(f) == pytest.approx(np.sqrt(f @ matrix_a(finger) @ f), abs=1e-12)


def test_many_slides_at_once_are_each_for_itself() -> None:
    slides = np.random.default_rng(0).normal(size=(4, 6, 3))
    np.testing.assert_array_equal(FINGER.friction(slides)[2, 5], FINGER.friction(slides[2, 5]))
    np.testing.assert_array_equal(FINGER.load(slides)[2, 5], FINGER.load(slides[2, 5]))


@pytest.mark.parametrize("dv", [np.zeros(3), np.array([[1.0, 0, 0], [0, 0, 0]]), np.array([np.nan, 1.0, 0.0])])
def test_a_contact_at_rest_has_no_friction_of_its_own(dv: np.ndarray) -> None:
    with pytest.raises(InputError, match=r"soft finger: the friction of a contact that does not slide is not given"):
        FINGER.friction(dv)


@pytest.mark.parametrize("name", ["mu", "f_N", "a", "c"])
@pytest.mark.parametrize("value", [0.0, -0.1, np.nan, np.inf])
def test_a_soft_finger_is_made_of_positive_numbers(name: str, value: float) -> None:
    numbers = {"mu": 0.38, "f_N": 1.25, "a": 0.0174, "c": 0.6} | {name: value}
    with pytest.raises(InputError, match=rf"^soft finger: {name} must be a positive number, got {value!r}$"):
        SoftFinger(**numbers)
