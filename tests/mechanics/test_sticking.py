"""The load of a grasp: its certificate checked by itself, and the load against closed forms and scipy."""

import numpy as np
import pytest
from grasp_draws import MIXED_GRASPS, POINT, SOFT, SOFT_GRASPS, WRENCHES, copies, turned
from hypothesis import given, settings
from hypothesis import strategies as st
from mechanics_draws import ANGLES, BLOCKS, OFFSETS, POSES
from paper_cases import BLOCK
from scipy.optimize import minimize

from slidepipe.errors import InputError
from slidepipe.mechanics.dynamics import Block, sticking_load
from slidepipe.mechanics.grasp import Contact, Grasp
from slidepipe.mechanics.limit_surface import PointContact, SoftFinger
from slidepipe.mechanics.planar import rotation
from slidepipe.mechanics.sticking import needed_wrench, sticking_loads, sticking_margin


def matrix(r: np.ndarray) -> np.ndarray:
    """G of eq. (15)."""
    return np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-r[1], r[0], 1.0]])


def shares(grasp: Grasp, forces: np.ndarray) -> np.ndarray:
    """sqrt(f^T A f) of each contact; a point contact's moment must be zero."""
    s = grasp.semi_axes
    assert np.all(forces[s == 0.0] == 0.0)
    return np.linalg.norm(np.divide(forces, s, out=np.zeros_like(s), where=s > 0.0), axis=1)


@settings(deadline=None)
@given(MIXED_GRASPS, WRENCHES)
def test_the_certificate_proves_the_load(grasp: Grasp, w: np.ndarray) -> None:
    found = sticking_margin(grasp, w)
    total = sum(matrix(c.r_f_b) @ f for c, f in zip(grasp.contacts, found.forces, strict=True))
    np.testing.assert_allclose(total, w, rtol=1e-9, atol=1e-10 * np.max(np.abs(w)))
    assert np.max(shares(grasp, found.forces)) <= found.load * (1 + 1e-12)
    support = sum(
        np.linalg.norm(s * (matrix(c.r_f_b).T @ found.direction))
        for c, s in zip(grasp.contacts, grasp.semi_axes, strict=True)
    )
    assert w @ found.direction / support == pytest.approx(found.load - found.gap, rel=1e-12)
    assert -1e-12 * max(1.0, found.load) <= found.gap <= 1e-9 * max(1.0, found.load)


@settings(deadline=None)
@given(BLOCKS, SOFT, POSES, OFFSETS, st.integers(1, 4))
def test_coincident_fingers_need_what_one_needs(
    block: Block, finger: SoftFinger, q_o: np.ndarray, r_f_b: np.ndarray, n: int
) -> None:
    ddq_o = np.array([3.0, -2.0, 40.0])
    found = sticking_margin(copies(finger, r_f_b, n), needed_wrench(block, q_o[2], ddq_o))
    assert found.load == pytest.approx(float(sticking_load(block, finger, q_o[2], ddq_o, r_f_b)), rel=1e-9)
    assert found.sticks is (found.load < 1.0)
    assert found.margin == 1.0 - found.load


@settings(deadline=None)
@given(SOFT_GRASPS, WRENCHES, ANGLES)
def test_the_load_does_not_depend_on_the_frame(grasp: Grasp, w: np.ndarray, angle: float) -> None:
    turn = rotation(angle)
    load = sticking_margin(grasp, w).load
    assert sticking_margin(turned(grasp, turn), turn @ w).load == pytest.approx(load, rel=1e-8)


@settings(deadline=None)
@given(MIXED_GRASPS, WRENCHES, st.floats(0.01, 100.0))
def test_twice_the_wrench_is_twice_the_load(grasp: Grasp, w: np.ndarray, factor: float) -> None:
    load = sticking_margin(grasp, w).load
    assert sticking_margin(grasp, factor * w).load == pytest.approx(factor * load, rel=1e-8)


def random_grasp(rng: np.random.Generator, n: int) -> Grasp:
    contacts = []
    for _ in range(n):
        mu, f_N, a = rng.uniform(0.2, 1.0), rng.uniform(0.5, 5.0), rng.uniform(0.005, 0.05)
        finger = PointContact(mu, f_N) if rng.random() < 0.3 else SoftFinger(mu, f_N, a, 0.6)
        contacts.append(Contact(finger, rng.uniform(-0.05, 0.05, 3)))
    return Grasp(contacts)


@pytest.mark.parametrize("seed", range(12))
def test_scipy_finds_no_smaller_load(seed: int) -> None:
    """SLSQP on the primal, 9 to 12 unknowns in scaled forces; point contacts and soft fingers mixed."""
    rng = np.random.default_rng(seed)
    grasp, w = random_grasp(rng, 2 + seed % 3), rng.normal(size=3) * [2.0, 2.0, 0.05]
    columns = np.hstack([matrix(c.r_f_b) * c.finger.semi_axes for c in grasp.contacts])
    columns, w_scaled = columns * [[1.0], [1.0], [30.0]], w * [1.0, 1.0, 30.0]
    found = sticking_margin(grasp, w)
    start = np.linalg.lstsq(columns, w_scaled, rcond=None)[0]
    first = np.append(start, np.max(np.linalg.norm(start.reshape(-1, 3), axis=1)))
    answer = minimize(
        lambda x: x[-1],
        first,
        method="SLSQP",
        constraints=[
            {"type": "eq", "fun": lambda x: columns @ x[:-1] - w_scaled},
            {"type": "ineq", "fun": lambda x: x[-1] ** 2 - np.sum(x[:-1].reshape(-1, 3) ** 2, axis=1)},
        ],
        options={"ftol": 1e-14, "maxiter": 500},
    )
    assert found.load == pytest.approx(answer.x[-1], rel=1e-6)


def test_no_direction_separates_further_than_the_certificate() -> None:
    rng = np.random.default_rng(7)
    for _ in range(20):
        grasp, w = random_grasp(rng, 3), rng.normal(size=3) * [2.0, 2.0, 0.05]
        found = sticking_margin(grasp, w)
        wide, scale = rng.normal(size=(20000, 3)) * [1.0, 1.0, 30.0], np.linalg.norm(found.direction)
        near = found.direction + rng.normal(size=(20000, 3)) * 10.0 ** rng.uniform(-6, 0, (20000, 1)) * scale
        for directions in (wide, near):
            assert np.max(directions @ w / grasp.support(directions)) <= found.load * (1 + 1e-9)


@settings(deadline=None)
@given(POINT, OFFSETS, st.floats(-3, 3), st.floats(0.1, 3))
def test_a_point_contact_holds_forces_through_it_and_no_others(
    finger: PointContact, r: np.ndarray, f_x: float, f_y: float
) -> None:
    grasp = Grasp([Contact(finger, r)] * 2)
    w = matrix(r) @ [f_x, f_y, 0.0]
    assert sticking_margin(grasp, w).load == pytest.approx(np.hypot(f_x, f_y) / (2 * finger.mu * finger.f_N), rel=1e-9)
    beside = sticking_margin(grasp, w + np.array([0.0, 0.0, 0.01]))
    assert beside.load == np.inf
    assert not beside.sticks
    assert beside.direction @ (w + np.array([0.0, 0.0, 0.01])) > 0.0
    assert grasp.support(beside.direction) == pytest.approx(0.0, abs=1e-12 * finger.f_N)


def test_two_point_contacts_hold_a_moment_by_a_couple() -> None:
    """Closed form: forces +-m / d across; the direction is not unique, the load is."""
    grasp = Grasp([Contact(PointContact(0.5, 4.0), [x, 0.0, 0.0]) for x in (0.03, -0.03)])
    found = sticking_margin(grasp, np.array([0.0, 0.0, 0.03]))
    assert found.load == pytest.approx(0.25, rel=1e-9)
    np.testing.assert_allclose(found.forces, [[0.0, 0.5, 0.0], [0.0, -0.5, 0.0]], atol=1e-9)


def test_a_force_through_one_point_contact_of_two_is_a_kink_and_still_certified() -> None:
    grasp = Grasp([Contact(PointContact(0.5, f_N), [x, 0.0, 0.0]) for x, f_N in ((0.03, 4.0), (-0.03, 1.0))])
    found = sticking_margin(grasp, matrix(np.array([0.03, 0.0, 0.0])) @ [0.0, 1.0, 0.0])
    assert found.load == pytest.approx(0.5, rel=1e-9), "the other finger cannot help: it would turn the object"
    assert abs(found.gap) < 1e-9


def test_no_wrench_needs_no_friction() -> None:
    found = sticking_margin(Grasp([Contact(PointContact(0.5, 4.0), np.zeros(3))]), np.zeros(3))
    assert (found.load, found.gap) == (0.0, 0.0)


def test_loads_along_a_motion_are_those_of_its_instants() -> None:
    rng = np.random.default_rng(3)
    grasp = Grasp([Contact(SoftFinger(0.4, 1.0, 0.02, 0.6), rng.uniform(-0.03, 0.03, 3)) for _ in range(3)])
    theta, ddq_o = rng.uniform(-3, 3, 20), rng.uniform(-20, 20, (20, 3))
    f_N, w = rng.uniform(0.5, 3.0, (20, 3)), needed_wrench(BLOCK, theta, ddq_o)
    loads = sticking_loads(grasp, w, f_N)
    assert loads.shape == (20,)
    for row in range(20):
        one = sticking_margin(grasp.with_normal_forces(f_N[row]), needed_wrench(BLOCK, theta[row], ddq_o[row]))
        assert loads[row] == pytest.approx(one.load, rel=1e-9)


def test_bad_wrenches_are_told() -> None:
    grasp = Grasp([Contact(PointContact(0.5, 4.0), np.zeros(3))])
    with pytest.raises(InputError, match=r"^sticking: w_b must be finite numbers, got nan$"):
        sticking_margin(grasp, np.array([0.0, np.nan, 0.0]))
    with pytest.raises(InputError, match=r"^sticking: w_b must have shape \(3,\), got \(2,\)$"):
        sticking_margin(grasp, np.zeros(2))
    with pytest.raises(InputError, match=r"^sticking: ddq_o must be finite numbers, got inf$"):
        needed_wrench(BLOCK, 0.0, np.array([np.inf, 0.0, 0.0]))
    with pytest.raises(InputError, match=r"^sticking: f_N must have one row for each of 3 wrenches, got 2$"):
        sticking_loads(grasp, np.ones((3, 3)), np.ones((2, 1)))
