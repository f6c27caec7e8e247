"""Onset of slip and the implicit step of n fingers: optimality checked by itself, and scipy's answer."""

import numpy as np
import pytest
from grasp_draws import ACCELERATIONS, MIXED_GRASPS, SOFT, SOFT_GRASPS, copies, turned
from hypothesis import given, settings
from hypothesis import strategies as st
from mechanics_draws import ANGLES, BLOCKS, OFFSETS, POSES
from paper_cases import BLOCK
from scipy.optimize import minimize, root

from slidepipe.errors import InputError
from slidepipe.mechanics.dynamics import Block, finger_acceleration, sliding_acceleration, sticking_load
from slidepipe.mechanics.grasp import Contact, Grasp, carried, in_world
from slidepipe.mechanics.limit_surface import PointContact, SoftFinger
from slidepipe.mechanics.planar import rotation
from slidepipe.mechanics.slip import friction_step, onset, stuck_acceleration

SEED_TWO = [
    Contact(SoftFinger(0.4, 1.0, 0.02, 0.6), [0.02, 0.01, 0.0]),
    Contact(PointContact(0.3, 2.0), [-0.03, 0.0, 0]),
]


def scaled(grasp: Grasp, f: np.ndarray) -> np.ndarray:
    s = grasp.semi_axes
    return np.divide(f, s, out=np.zeros_like(s), where=s > 0.0)


def obeys(grasp: Grasp, f: np.ndarray, dv: np.ndarray, stuck: np.ndarray) -> None:
    """Eqs. (10), (11), (14): inside and at rest, or on the surface and along the slip; never against it."""
    g, z = scaled(grasp, f), grasp.semi_axes * dv
    size, speed = np.linalg.norm(g, axis=1), np.linalg.norm(z, axis=1)
    assert np.all(size <= 1.0 + 1e-12)
    assert np.all(speed[stuck] == 0.0)
    assert np.all(np.sum(f * dv, axis=1) >= -1e-12 * np.max(speed))
    # |z| - g . z is what friction falls short of the most power.
    assert np.all(speed - np.sum(g * z, axis=1) <= 1e-9 * max(np.max(speed), 1e-30))


@settings(deadline=None)
@given(BLOCKS, MIXED_GRASPS, ANGLES, ACCELERATIONS)
def test_the_onset_is_optimal(block: Block, grasp: Grasp, theta: float, ddq_h: np.ndarray) -> None:
    found = onset(block, grasp, theta, ddq_h)
    obeys(grasp, found.f, found.ddv, found.stuck)
    r_f = in_world(theta, grasp.r_f_b)
    moments = found.f[:, 2] + r_f[:, 0] * found.f[:, 1] - r_f[:, 1] * found.f[:, 0]
    wrench = np.array([*np.sum(found.f[:, :2], axis=0), np.sum(moments)])
    most = np.sum(grasp.semi_axes[:, 0]) * np.array([1.0, 1.0, 0.2])
    assert np.all(np.abs(block.M * found.ddq_o - block.g - wrench) <= 1e-9 * most), "eq. (17)"
    assert found.residual < 1e-8
    assert found.sticks is bool(np.all(found.stuck))


@settings(deadline=None)
@given(BLOCKS, SOFT, ANGLES, OFFSETS, ACCELERATIONS, st.integers(1, 4))
def test_coincident_fingers_slip_as_one_and_where_the_closed_forms_say(  # noqa: PLR0917
    block: Block, finger: SoftFinger, theta: float, r_f_b: np.ndarray, ddq_h: np.ndarray, n: int
) -> None:
    found = onset(block, copies(finger, r_f_b, n), theta, ddq_h)
    load = float(sticking_load(block, finger, theta, ddq_h, r_f_b))
    if load < 1.0 - 1e-9:
        assert found.sticks
        np.testing.assert_array_equal(found.ddr, 0.0)
        return
    if load < 1.0 + 1e-6:
        return
    assert not found.sticks
    along = rotation(-theta) @ found.ddv[0]
    expected = sliding_acceleration(block, finger, theta, r_f_b, along)
    np.testing.assert_allclose(found.ddq_o, expected, rtol=1e-6, atol=1e-6 * np.max(np.abs(expected)))
    one = onset(block, copies(finger, r_f_b, 1), theta, ddq_h)
    np.testing.assert_allclose(found.ddq_o, one.ddq_o, rtol=1e-8, atol=1e-8 * np.max(np.abs(one.ddq_o)))
    np.testing.assert_allclose(np.sum(found.f, axis=0), one.f[0], atol=1e-8 * np.max(finger.semi_axes))


@settings(deadline=None)
@given(BLOCKS, SOFT_GRASPS, ANGLES, ACCELERATIONS, ANGLES)
def test_the_onset_does_not_depend_on_which_way_the_body_frame_points(
    block: Block, grasp: Grasp, theta: float, ddq_h: np.ndarray, angle: float
) -> None:
    found = onset(block, grasp, theta, ddq_h)
    again = onset(block, turned(grasp, rotation(-angle)), theta + angle, ddq_h)
    size = max(np.max(np.abs(found.ddq_o)), np.max(np.abs(ddq_h)), 1.0)
    np.testing.assert_allclose(again.ddq_o, found.ddq_o, atol=1e-7 * size)


@pytest.mark.parametrize("seed", range(10))
def test_scipy_finds_the_same_onset(seed: int) -> None:
    """The optimality conditions as smooth equations in three unknowns, solved by MINPACK from another start."""
    rng = np.random.default_rng(seed)
    grasp = Grasp(
        [Contact(SoftFinger(0.4, f, 0.02, 0.6), rng.uniform(-0.03, 0.03, 3)) for f in rng.uniform(0.2, 1, 1 + seed % 4)]
    )
    ddq_h = rng.choice([-1, 1], 3) * rng.uniform([200, 200, 2000], [300, 300, 5000])
    found = onset(BLOCK, grasp, 0.0, ddq_h)
    assert not found.sticks

    def unmet(ddq_o: np.ndarray) -> np.ndarray:
        slip = grasp.slip(ddq_h - ddq_o)
        f = np.stack([c.finger.friction(v) for c, v in zip(grasp.contacts, slip, strict=True)])
        return np.asarray(ddq_o - (grasp.wrench(f) + BLOCK.g) / BLOCK.M)

    answer = root(unmet, np.zeros(3), tol=1e-14)
    np.testing.assert_allclose(found.ddq_o, answer.x, rtol=1e-9, atol=1e-9 * np.max(np.abs(ddq_h)))


@pytest.mark.parametrize("seed", range(10))
def test_no_other_friction_brings_the_object_nearer(seed: int) -> None:
    """Gauss' principle itself, by a search without derivatives; every other time the point contact may stick."""
    rng = np.random.default_rng(seed)
    grasp, dq_f, dq_o, h = Grasp(SEED_TWO), rng.uniform(-1, 1, (2, 3)), rng.uniform(-1, 1, 3), 0.01
    if seed % 2:
        dq_f[1] = carried(dq_o, SEED_TWO[1].r_f_b)
    found = friction_step(BLOCK, grasp, 0.0, dq_o, dq_f=dq_f, h=h)
    obeys(grasp, found.f, found.dv, found.stuck)

    def energy(x: np.ndarray) -> float:
        v = x / np.sqrt(BLOCK.M)
        slip = dq_f - carried(v, grasp.r_f_b)
        change = v - dq_o - h * BLOCK.g / BLOCK.M
        lost = np.sum(np.linalg.norm(grasp.semi_axes * slip, axis=1))
        return float(0.5 * np.sum(BLOCK.M * change**2) / h + lost)

    mine, other = energy(found.dq_o * np.sqrt(BLOCK.M)), dq_o * np.sqrt(BLOCK.M)
    for _ in range(5):
        other = minimize(energy, other, method="Nelder-Mead", options={"xatol": 1e-10, "fatol": 1e-14}).x
    # A finger that sticks does so to 1e-11 of the sliding, and that is what the energy may be off.
    assert mine <= energy(other) + 1e-11 * abs(energy(other))
    # Any friction within the ellipsoids bounds the energy from below: with the found one there is no room between.
    change = h * grasp.wrench(found.f) / BLOCK.M
    slip = dq_f - carried(dq_o + h * BLOCK.g / BLOCK.M + change, grasp.r_f_b)
    bound = 0.5 * np.sum(BLOCK.M * change**2) / h + np.sum(found.f * slip)
    assert np.max(np.linalg.norm(scaled(grasp, found.f), axis=1)) <= 1.0 + 1e-12
    assert mine == pytest.approx(float(bound), rel=1e-10)


def test_a_finger_sticks_while_the_other_slides() -> None:
    strong = Contact(SoftFinger(0.5, 50.0, 0.02, 0.6), [0.02, 0.0, 0.0])
    weak = Contact(SoftFinger(0.5, 0.1, 0.02, 0.6), [-0.02, 0.0, 0.0])
    dq_f = np.array([[0.1, 0.0, 0.0], [-0.3, 0.0, 0.0]])
    found = friction_step(BLOCK, Grasp([strong, weak]), 0.0, np.array([0.1, 0.0, 0.0]), dq_f=dq_f, h=0.001)
    np.testing.assert_array_equal(found.stuck, [True, False])
    np.testing.assert_allclose(found.dq_o, [0.1, 0.0, 0.0], atol=1e-10)
    np.testing.assert_allclose(found.f[1], [-0.05, 0.0, 0.0], atol=1e-9)


def test_an_object_that_sticks_moves_with_the_hand_to_the_last_bit() -> None:
    grasp = Grasp([Contact(SoftFinger(0.5, 5.0, 0.02, 0.6), [x, 0.01, 0.0]) for x in (0.02, -0.02)])
    dq_o = np.zeros(3)
    for _ in range(1000):
        dq_o = friction_step(BLOCK, grasp, 0.3, dq_o, dq_f=np.zeros((2, 3)), h=0.001).dq_o
    np.testing.assert_array_equal(dq_o, 0.0)


def test_a_step_takes_the_friction_of_one_sliding_finger() -> None:
    """Implicit Euler of eq. (20): the friction of the velocity at the end."""
    finger, r = SoftFinger(0.38, 1.25, 0.0174, 0.6), np.array([0.01, 0.02, 0.0])
    dq_f = np.array([[2.0, -1.0, 15.0]])
    found = friction_step(BLOCK, Grasp([Contact(finger, r)]), 0.0, np.zeros(3), dq_f=dq_f, h=1e-3)
    assert not np.any(found.stuck)
    expected = 1e-3 * sliding_acceleration(BLOCK, finger, 0.0, r, found.dv[0])
    np.testing.assert_allclose(found.dq_o, expected, rtol=1e-9)


@given(POSES, POSES, OFFSETS)
def test_a_stuck_acceleration_undoes_the_fingers(q: np.ndarray, ddq_o: np.ndarray, r_f_b: np.ndarray) -> None:
    zero = np.zeros(3)
    ddq_f = finger_acceleration(q[2], q[0], ddq_o, r_f_b=r_f_b, dr_f_b=zero, ddr_f_b=zero)
    np.testing.assert_allclose(stuck_acceleration(q[2], q[0], ddq_f, r_f_b), ddq_o, atol=1e-11)


def test_bad_values_are_told() -> None:
    grasp = Grasp(SEED_TWO)
    with pytest.raises(InputError, match=r"^onset: ddq_h must be finite numbers, got nan$"):
        onset(BLOCK, grasp, 0.0, np.array([np.nan, 0.0, 0.0]))
    with pytest.raises(InputError, match=r"^friction step: h must be a positive time in s, got 0.0$"):
        friction_step(BLOCK, grasp, 0.0, np.zeros(3), dq_f=np.zeros((2, 3)), h=0.0)
    with pytest.raises(InputError, match=r"^friction step: dq_f must have shape \(2, 3\), got \(3, 3\)$"):
        friction_step(BLOCK, grasp, 0.0, np.zeros(3), dq_f=np.zeros((3, 3)), h=0.01)
    with pytest.raises(InputError, match=r"^block: m must be a positive number, got -1.0$"):
        Block(length=0.1, width=0.1, m=-1.0)
