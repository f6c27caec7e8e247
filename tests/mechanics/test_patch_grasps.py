"""Exact pressure patches as contacts of grasps and of simulations, against their quadrature and other integrations."""

from dataclasses import replace

import numpy as np
import pytest
from hand_draws import CASES, HANDS, STARTS, energy, samples, stopped
from hypothesis import given, settings
from hypothesis import strategies as st
from paper_cases import BLOCK
from scipy.integrate import solve_ivp

from slidepipe.mechanics.dynamics import Block, about_com
from slidepipe.mechanics.grasp import Contact, Grasp, carried
from slidepipe.mechanics.grasp_dynamics import forward_dynamics, inverse_dynamics
from slidepipe.mechanics.grasp_surface import GraspSurface
from slidepipe.mechanics.hand_motion import HandMotion
from slidepipe.mechanics.limit_surface import PointContact, SoftFinger
from slidepipe.mechanics.parameters import ParameterSets
from slidepipe.mechanics.pressure_patch import PressurePatch
from slidepipe.mechanics.simulate import Ended, simulate, simulate_many
from slidepipe.mechanics.slip import friction_step, onset
from slidepipe.mechanics.stepping import PlacedFinger, step_many, step_through
from slidepipe.mechanics.sticking import sticking_loads, sticking_margin

KS = (1.0, 2.2645, 4.0, np.inf)
PATCH = PressurePatch(mu=0.4, f_N=1.5, a=0.03, k=np.inf)
MIXED = Grasp(
    [
        Contact(PATCH, [0.02, 0.01, 0.3]),
        Contact(replace(PATCH, k=1.0, f_N=0.7), [-0.02, 0.0, 0.0]),
        Contact(SoftFinger(0.3, 1.0, 0.02, 0.6), [0.0, -0.03, 0.0]),
        Contact(PointContact(0.5, 0.4), [-0.01, 0.03, 0.0]),
    ]
)
SLIPS = st.builds(lambda x, y, w: np.array([x, y, w]), st.floats(-1, 1), st.floats(-1, 1), st.floats(-50, 50)).filter(
    lambda v: np.linalg.norm(v) > 1e-3
)


def alone(patch: PressurePatch, r_f_b: list[float] | np.ndarray = (0.0, 0.0, 0.0)) -> Grasp:
    return Grasp([Contact(patch, r_f_b)])


@given(SLIPS, st.sampled_from(KS))
@settings(max_examples=60, deadline=None)
def test_the_tabulated_friction_is_that_of_the_quadrature(dv: np.ndarray, k: float) -> None:
    patch = replace(PATCH, k=k)
    found = forward_dynamics(BLOCK, alone(patch), theta=0.0, dq_o=np.zeros(3), dq_f=[dv], ddq_f=[dv])
    share = (found.f[0] - patch.friction(dv)) / patch.semi_axes
    assert np.max(np.abs(share)) < 1e-6
    assert alone(patch).support(dv) == pytest.approx(float(patch.support(dv)), rel=1e-8)


@given(SLIPS, st.floats(0.3, 3.0), st.sampled_from(KS))
@settings(max_examples=40, deadline=None)
def test_one_patchs_load_is_its_own(dv: np.ndarray, size: float, k: float) -> None:
    patch = replace(PATCH, k=k)
    w = size * patch.friction(dv)
    found = sticking_margin(alone(patch), w)
    assert found.load == pytest.approx(size, rel=1e-6)
    assert 0.0 <= found.gap + 1e-12 < 1e-7
    assert found.sticks is (found.load < 1.0)


@pytest.mark.parametrize("seed", range(8))
def test_a_mixed_grasps_certificate_holds_with_the_exact_surfaces(seed: int) -> None:
    w = np.random.default_rng(seed).normal(size=3) * [1.0, 1.0, 0.02]
    found = sticking_margin(MIXED, w)
    np.testing.assert_allclose(MIXED.wrench(found.forces), w, atol=1e-9)
    for contact, f in zip(MIXED.contacts, found.forces, strict=True):
        assert float(contact.finger.load(f)) <= found.load * (1.0 + 1e-6)
    surface = GraspSurface([c.finger for c in MIXED.contacts], MIXED.r_f_b)
    assert w @ found.direction / float(surface.support(found.direction)) == pytest.approx(found.load, rel=1e-6)
    many = sticking_loads(MIXED, np.array([w, 2.0 * w]), f_N=np.array([[1.5, 0.7, 1.0, 0.4]] * 2))
    np.testing.assert_allclose(many, [found.load, 2.0 * found.load], rtol=1e-8)


def test_forward_undoes_inverse_in_a_mixed_grasp_whose_forces_vary() -> None:
    rng, still = np.random.default_rng(0), {"theta": np.array([0.3, 0.7]), "dq_o": np.array([[0.1, -0.3, 4.0]] * 2)}
    f_N = np.array([[1.5, 0.7, 1.0, 0.4], [3.0, 0.1, 2.0, 0.2]])
    dr, ddr = rng.normal(size=(2, 2, 4, 3))
    wanted = inverse_dynamics(BLOCK, MIXED, **still, dr_f_b=dr, ddr_f_b=ddr, f_N=f_N)
    found = forward_dynamics(BLOCK, MIXED, **still, dq_f=wanted.dq_f, ddq_f=wanted.ddq_f, f_N=f_N)
    np.testing.assert_allclose(found.ddr_f_b, ddr, atol=1e-9 * np.max(np.abs(wanted.ddq_f)))
    exact = np.stack([c.finger.friction(v) for c, v in zip(MIXED.contacts, found.dv[0], strict=True)])
    np.testing.assert_allclose(found.f[0], exact, atol=1e-6)


@pytest.mark.parametrize("seed", range(8))
def test_the_onset_of_a_mixed_grasp_obeys_the_exact_friction(seed: int) -> None:
    """Newton and Euler with the quadrature's friction at the slip that was found."""
    ddq_h = np.random.default_rng(seed).uniform(-1, 1, 3) * [300.0, 300.0, 4000.0]
    found = onset(BLOCK, MIXED, 0.0, ddq_h)
    assert not found.sticks
    assert found.residual < 1e-6
    f = found.f.copy()
    for i, (contact, v) in enumerate(zip(MIXED.contacts, found.ddv, strict=True)):
        f[i] = contact.finger.friction(v) if not found.stuck[i] else f[i]
        assert float(contact.finger.load(f[i])) <= 1.0 + 1e-6
    np.testing.assert_allclose(BLOCK.M * found.ddq_o, MIXED.wrench(f) + BLOCK.g, rtol=1e-5, atol=2e-6)
    np.testing.assert_allclose(found.ddv, carried(ddq_h - found.ddq_o, MIXED.r_f_b), atol=1e-6 * np.max(np.abs(ddq_h)))


def test_a_patch_needs_more_than_its_ellipsoid_says() -> None:
    """A wrench between the two surfaces: the ellipsoid would hold it, the patch slides."""
    w = 0.5 * (1.0 + 1.0 / 1.0704) * PATCH.ellipsoid().friction(np.array([1.0, 0.0, 0.9 / PATCH.a]))
    patch, ellipsoid = (
        sticking_margin(alone(PATCH), w),
        sticking_margin(Grasp([Contact(PATCH.ellipsoid(), [0, 0, 0])]), w),
    )
    assert (patch.sticks, ellipsoid.sticks) == (False, True)


@given(SLIPS, STARTS, st.floats(-7, 0), st.sampled_from(KS))
@settings(max_examples=60, deadline=None)
def test_one_implicit_step_is_the_grasps(dq_f: np.ndarray, r_f_b: np.ndarray, log_h: float, k: float) -> None:
    """The lone contact's own solver against the convex problem, from nearly stuck to fast."""
    h, patch, start = 10.0**log_h, replace(PATCH, k=k), np.zeros(3)
    fall = carried(np.array([0.0, -h * 9.81, 0.0]), np.zeros(3))
    step = friction_step(BLOCK, alone(patch, r_f_b), -r_f_b[2], start, dq_f=dq_f[None], h=h)
    ran = step_through(
        np.array([0.0, h]), np.stack([np.zeros(3), h * dq_f]), BLOCK, (PlacedFinger(patch, np.zeros(2)),), r_f_b
    )
    moved = ran.r_f_b[1] - r_f_b
    c, s = np.cos(r_f_b[2]), np.sin(r_f_b[2])
    expected = h * np.array(
        [c * step.dv[0, 0] - s * step.dv[0, 1], s * step.dv[0, 0] + c * step.dv[0, 1], step.dv[0, 2]]
    )
    size = h * (np.abs(dq_f) + np.abs(fall)).max()
    np.testing.assert_allclose(moved, expected, atol=1e-7 * size + 1e-15)
    assert (ran.sliding_steps == 0) is bool(step.stuck[0])


def _flung(v: float, w: float) -> HandMotion:
    """A hand that is flung to -v and -w in a tenth of a millisecond and then falls freely: no weight is left."""
    sudden, free = 1e-4, 2.0
    start = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], np.array([v, 0.0, w]) / (2 * sudden)])
    q, dq = start[2] * sudden**2, 2 * start[2] * sudden
    return HandMotion(
        np.array([0.0, sudden, free]), np.array([start, [q, dq, [0.0, -9.81 / 2, 0.0]]]), np.ones(3, dtype=bool)
    )


@pytest.mark.parametrize("ratio", [0.6, 1.0])
def test_a_free_uniform_disc_stops_sliding_and_spinning_together(ratio: float) -> None:
    """By the event-driven simulation: v / (w R) tends to 0.653, from below and above; the ellipsoid's does not."""
    side = np.sqrt(3.0) * PATCH.a  # a square of a disc's moment of inertia
    disc = Block(side, side, 1.5 * 0.4 / 9.0)
    speed = 0.04

    def end(finger: SoftFinger | PressurePatch) -> float:
        outcome = simulate(_flung(speed * ratio, speed / PATCH.a), disc, finger, np.zeros(3), tolerance=1e-11)
        dr = outcome.knots[outcome.knots[:, 0] < 1.0, 4:7]
        late = dr[np.hypot(*dr[:, :2].T) > 1e-5 * speed][-1]
        return float(np.hypot(*late[:2]) / (late[2] * PATCH.a))

    assert end(PATCH) == pytest.approx(0.653, abs=0.02)
    assert abs(end(PATCH.ellipsoid()) - 0.653) > 0.05


@pytest.mark.parametrize("name", CASES)
def test_a_simulated_patch_agrees_with_scipy_and_with_small_steps(name: str) -> None:
    """scipy's integration of eqs. (18) to (21) with the quadrature's friction, from a moving start to a moving end."""
    regrasp, finger = CASES[name]
    patch, hand = PressurePatch(finger.mu, finger.f_N, finger.a, 2.2645), HANDS[name]
    ours = simulate(hand, BLOCK, patch, regrasp.r_start, tolerance=1e-10)
    assert ours.ended == Ended.STUCK
    first, last = ours.knots[1], ours.knots[len(ours.knots) // 2]

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        q_f, dq_f = hand.at(np.array([t]))[0], hand.at(np.array([t]), 1)[0]
        c, s = np.cos(q_f[2] - y[2]), np.sin(q_f[2] - y[2])
        turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        r_f = turn @ [y[0], y[1], 0.0]
        dv = dq_f - carried(y[3:], r_f)
        return np.concatenate([turn.T @ dv, (about_com(patch.friction(dv), r_f) + BLOCK.g) / BLOCK.M])

    q_f, dq_f = hand.at(first[:1])[0], hand.at(first[:1], 1)[0]
    theta = q_f[2] - first[3]
    c, s = np.cos(theta), np.sin(theta)
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    dq_o = carried(dq_f - turn @ first[4:7], -(turn @ [first[1], first[2], 0.0]))
    answer = solve_ivp(
        rate, (first[0], last[0]), [*first[1:4], *dq_o], method="DOP853", rtol=1e-9, atol=1e-11, max_step=0.01
    )
    np.testing.assert_allclose(answer.y[:3, -1], last[1:4], atol=2e-7)
    errors = []
    for step_s in (2e-4, 1e-4):
        time_s, q = samples(hand, step_s)
        stepped = step_through(time_s, q, BLOCK, (PlacedFinger(patch, np.zeros(2)),), regrasp.r_start)
        errors.append(float(np.linalg.norm((stepped.r_f_b[-1] - ours.r_f_b)[:2])))
    assert errors[1] < 0.6 * errors[0] < 1e-3


def test_a_batch_of_patches_is_its_trials() -> None:
    regrasp, finger = CASES["linear"]
    patch, hand = PressurePatch(finger.mu, finger.f_N, finger.a, np.inf), HANDS["linear"]
    frictions = patch.mu * np.array([0.97, 1.0, 1.05])
    sets = ParameterSets.of(BLOCK, patch, regrasp.r_start, mu=frictions)
    single = [simulate(hand, BLOCK, replace(patch, mu=mu), regrasp.r_start).r_f_b for mu in frictions]
    np.testing.assert_array_equal(simulate_many(hand, sets).r_f_b, single)
    time_s, q_f = samples(hand, 1e-3)
    stepped = step_many(time_s, q_f, sets)
    for mu, row in zip(frictions, stepped, strict=True):
        one = (PlacedFinger(replace(patch, mu=mu), np.zeros(2)),)
        np.testing.assert_array_equal(step_through(time_s, q_f, BLOCK, one, regrasp.r_start).r_f_b[-1], row)


@pytest.mark.parametrize("apart", [False, True])
def test_patches_in_a_resting_hand_only_lose_energy_and_then_stick_to_the_last_bit(apart: bool) -> None:
    hand = stopped(np.array([0.7, -0.4, 6.0]))
    places = ([0.01, 0.0], [-0.012, 0.004]) if apart else ([0.0, 0.0],)
    fingers = tuple(PlacedFinger(replace(PATCH, f_N=1.5 / len(places)), np.array(place)) for place in places)
    time_s, q_f = samples(hand, 1e-3, rest_s=0.6)
    path = step_through(time_s, q_f, BLOCK, fingers, np.zeros(3)).r_f_b
    resting = path[time_s >= hand.breaks[-1]]
    dr = np.diff(resting, axis=0) / 1e-3
    left, lost = energy(BLOCK, q_f[-1], resting[1:], dr), 0.4 * 1.5 * np.linalg.norm(dr[:, :2], axis=1) * 1e-3
    assert np.all(np.diff(left) < 1e-9 + 0.05 * lost[1:])
    assert np.max(np.abs(dr[0])) > 0.0
    np.testing.assert_array_equal(path[-200:], np.broadcast_to(path[-1], (200, 3)))
