"""Section VI-B for n fingers: eqs. (15) to (22) against one finger's, finite differences and Newton and Euler."""

import numpy as np
import pytest
from grasp_draws import SOFT, SOFT_GRASPS, copies
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from mechanics_draws import BLOCKS, OFFSETS, POSES, SLIDES
from paper_cases import BLOCK

from slidepipe.errors import InputError
from slidepipe.mechanics.dynamics import Block, finger_acceleration, sliding_acceleration
from slidepipe.mechanics.grasp import Contact, Grasp
from slidepipe.mechanics.grasp_dynamics import forward_dynamics, inverse_dynamics
from slidepipe.mechanics.limit_surface import SoftFinger
from slidepipe.mechanics.planar import finger_pose, relative_pose

FINGER = SoftFinger(mu=0.4, f_N=2.0, a=0.02, c=0.6)
PAIR = Grasp([Contact(FINGER, [0.02, 0.0, 0.0]), Contact(FINGER, [-0.02, 0.01, 1.0])])


@given(BLOCKS, SOFT, POSES, OFFSETS, SLIDES, SLIDES)
def test_one_finger_slides_as_the_closed_forms_say(  # noqa: PLR0917
    block: Block, finger: SoftFinger, q_o: np.ndarray, r_f_b: np.ndarray, dr_b: np.ndarray, ddr_b: np.ndarray
) -> None:
    found = inverse_dynamics(block, Grasp([Contact(finger, r_f_b)]), theta=q_o[2], dq_o=q_o, dr_f_b=dr_b, ddr_f_b=ddr_b)
    ddq_o = sliding_acceleration(block, finger, q_o[2], r_f_b, dr_b)
    ddq_f = finger_acceleration(q_o[2], q_o[2], ddq_o, r_f_b=r_f_b, dr_f_b=dr_b, ddr_f_b=ddr_b)
    np.testing.assert_allclose(found.ddq_o, ddq_o, rtol=1e-9, atol=1e-9 * np.max(np.abs(ddq_o)))
    np.testing.assert_allclose(found.ddq_f[0], ddq_f, rtol=1e-9, atol=1e-9 * np.max(np.abs(ddq_f)))


@given(BLOCKS, SOFT, POSES, OFFSETS, SLIDES, st.integers(2, 4))
def test_coincident_fingers_slide_as_one(  # noqa: PLR0917
    block: Block, finger: SoftFinger, q_o: np.ndarray, r_f_b: np.ndarray, dr_b: np.ndarray, n: int
) -> None:
    found = inverse_dynamics(block, copies(finger, r_f_b, n), theta=q_o[2], dq_o=q_o, dr_f_b=dr_b, ddr_f_b=np.ones(3))
    one = sliding_acceleration(block, finger, q_o[2], r_f_b, dr_b)
    np.testing.assert_allclose(found.ddq_o, one, rtol=1e-9, atol=1e-9 * np.max(np.abs(one)))


@given(BLOCKS, SOFT_GRASPS, POSES, POSES, st.data())
def test_forward_undoes_inverse_with_every_finger_on_its_own(
    block: Block, grasp: Grasp, q_o: np.ndarray, dq_o: np.ndarray, data: st.DataObject
) -> None:
    drawn = arrays(float, (3, len(grasp), 3), elements=st.floats(0.1, 5.0))
    dr_b, ddr_b, _ = data.draw(drawn)
    wanted = inverse_dynamics(block, grasp, theta=q_o[2], dq_o=dq_o, dr_f_b=dr_b, ddr_f_b=ddr_b)
    found = forward_dynamics(block, grasp, theta=q_o[2], dq_o=dq_o, dq_f=wanted.dq_f, ddq_f=wanted.ddq_f)
    size = np.max(np.abs(wanted.ddq_f))
    for name in ("dv", "f", "ddq_o", "ddr_f", "dr_f_b", "ddr_f_b"):
        got, asked = getattr(found, name), getattr(wanted, name)
        np.testing.assert_allclose(got, asked, rtol=1e-9, atol=1e-9 * max(1.0, size), err_msg=name)
    assert np.all(np.sum(found.f * found.dv, axis=-1) > 0.0), "every finger's friction dissipates"


def test_the_object_obeys_newton_and_euler() -> None:
    """Force and moment about the centre of mass, in complex numbers."""
    theta, dq_o = 0.7, np.array([0.1, -0.3, 4.0])
    dq_f, ddq_f = np.array([[1.0, 0.5, 3.0], [-0.5, 0.2, -6.0]]), np.ones((2, 3))
    force, moment = -1j * BLOCK.m * 9.81, 0.0
    for i, contact in enumerate(PAIR.contacts):
        arm = np.exp(1j * theta) * complex(*contact.r_f_b[:2])
        dv = complex(*dq_f[i, :2]) - complex(*dq_o[:2]) - 1j * dq_o[2] * arm
        spin, rho, most = dq_f[i, 2] - dq_o[2], 0.02 * 0.6, 0.4 * 2.0
        speed = np.sqrt(abs(dv) ** 2 + (rho * spin) ** 2)
        f = most * dv / speed
        force, moment = force + f, moment + (np.conj(arm) * f).imag + most * rho**2 * spin / speed
    found = forward_dynamics(BLOCK, PAIR, theta=theta, dq_o=dq_o, dq_f=dq_f, ddq_f=ddq_f)
    expected = [force.real / BLOCK.m, force.imag / BLOCK.m, moment / BLOCK.inertia]
    np.testing.assert_allclose(found.ddq_o, expected, rtol=1e-12)
    np.testing.assert_allclose(found.ddr_f, ddq_f - found.ddq_o, rtol=1e-12)


def test_the_relative_acceleration_in_the_body_is_the_second_derivative_of_the_relative_pose() -> None:
    theta, dq_o, h = 0.7, np.array([0.1, -0.3, 4.0]), 1e-4
    q_o = np.array([0.2, 0.1, theta])
    dq_f, ddq_f = np.array([[1.0, 0.5, 3.0], [-0.5, 0.2, -6.0]]), np.array([[5.0, 3.0, 20.0], [-9.0, 2.0, 70.0]])
    found = forward_dynamics(BLOCK, PAIR, theta=theta, dq_o=dq_o, dq_f=dq_f, ddq_f=ddq_f)
    t = np.array([-h, 0.0, h])[:, None, None]
    objects = q_o + t[:, 0] * dq_o + 0.5 * t[:, 0] ** 2 * found.ddq_o
    fingers = finger_pose(q_o, PAIR.r_f_b) + t * dq_f + 0.5 * t**2 * ddq_f
    r = relative_pose(objects[:, None, :].repeat(2, axis=1), fingers)
    np.testing.assert_allclose((r[2] - r[0]) / (2 * h), found.dr_f_b, rtol=1e-5, atol=1e-5)
    np.testing.assert_allclose((r[2] + r[0] - 2 * r[1]) / h**2, found.ddr_f_b, rtol=1e-4, atol=1e-3)


def test_normal_forces_may_vary_in_time() -> None:
    f_N = np.array([[2.0, 2.0], [1.0, 3.0], [0.5, 0.1]])
    moving = {"theta": np.zeros(3), "dq_o": np.zeros((3, 3)), "dr_f_b": np.ones(3), "ddr_f_b": np.ones(3)}
    found = inverse_dynamics(BLOCK, PAIR, **moving, f_N=f_N)
    for row, forces in enumerate(f_N):
        one = inverse_dynamics(
            BLOCK, PAIR.with_normal_forces(forces), theta=0.0, dq_o=np.zeros(3), dr_f_b=np.ones(3), ddr_f_b=np.ones(3)
        )
        np.testing.assert_allclose(found.f[row], one.f, rtol=1e-12)
        np.testing.assert_allclose(found.ddq_f[row], one.ddq_f, rtol=1e-12)


@given(SOFT_GRASPS, SLIDES, st.integers(0, 2**32 - 1))
def test_no_friction_takes_more_power_than_the_support_function_says(grasp: Grasp, dv_b: np.ndarray, seed: int) -> None:
    directions = np.random.default_rng(seed).normal(size=(50, len(grasp), 3))
    f = grasp.semi_axes * directions / np.linalg.norm(directions, axis=-1, keepdims=True)
    most = grasp.support(dv_b)
    assert np.all(grasp.wrench(f) @ dv_b <= most * (1 + 1e-12))
    own = np.stack([c.finger.friction(v) for c, v in zip(grasp.contacts, grasp.slip(dv_b), strict=True)])
    assert grasp.wrench(own) @ dv_b == pytest.approx(float(most), rel=1e-12)


def test_a_finger_that_does_not_slide_is_named() -> None:
    dq_f = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    with pytest.raises(InputError, match=r"^sliding: finger 1 does not slide: eq\. \(21\) needs .*"):
        forward_dynamics(BLOCK, PAIR, theta=0.0, dq_o=np.zeros(3), dq_f=dq_f, ddq_f=dq_f)


def test_bad_grasps_are_told() -> None:
    with pytest.raises(InputError, match=r"^grasp: contacts must be one or more, got none$"):
        Grasp([])
    with pytest.raises(InputError, match=r"^contact: r_f_b must be three finite numbers"):
        Contact(FINGER, [np.nan, 0.0, 0.0])
    with pytest.raises(InputError, match=r"^contact: finger must have semi_axes"):
        Contact("finger", [0.0, 0.0, 0.0])
    with pytest.raises(InputError, match=r"^grasp: contacts must be Contact, got"):
        Grasp([FINGER])
    with pytest.raises(InputError, match=r"^soft finger: mu must be a positive number, got 0.0$"):
        Contact(SoftFinger(mu=0.0, f_N=1.0, a=0.1, c=0.6), [0.0, 0.0, 0.0])
    with pytest.raises(InputError, match=r"^grasp: f_N must be 2 normal forces, one a contact, got shape \(3,\)$"):
        PAIR.with_normal_forces([1.0, 1.0, 1.0])
    with pytest.raises(InputError, match=r"^soft finger: f_N must be a positive number, got -1.0$"):
        PAIR.with_normal_forces([1.0, -1.0])


@pytest.mark.parametrize("name", ["theta", "dq_o", "dq_f", "ddq_f"])
def test_a_motion_with_nan_is_told(name: str) -> None:
    values = {"theta": 0.0, "dq_o": np.zeros(3), "dq_f": np.ones((2, 3)), "ddq_f": np.ones((2, 3))}
    values[name] = values[name] * np.nan
    with pytest.raises(InputError, match=rf"^sliding: {name} must be finite numbers, got nan$"):
        forward_dynamics(BLOCK, PAIR, **values)


def test_relative_motions_that_do_not_fit_the_fingers_are_told() -> None:
    still = {"theta": 0.0, "dq_o": np.zeros(3), "ddr_f_b": np.ones(3)}
    with pytest.raises(InputError, match=r"^sliding: dr_f_b and ddr_f_b must be one or 2 rows of three"):
        inverse_dynamics(BLOCK, PAIR, **still, dr_f_b=np.ones((3, 3)))
    with pytest.raises(InputError, match=r"^sliding: dr_f_b and ddr_f_b must be one or 2 rows of three"):
        inverse_dynamics(BLOCK, PAIR, **{**still, "theta": np.zeros(2), "dq_o": np.zeros((3, 3))}, dr_f_b=np.ones(3))
