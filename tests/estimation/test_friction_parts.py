import numpy as np
import pytest
from scipy.integrate import solve_ivp
from synthetic import BLOCK, CASE_B, GRAVITY, Cameras, request, simulate

from slidepipe.estimation import joint_fit as joint_fit_module
from slidepipe.estimation.estimate import estimate
from slidepipe.estimation.forward import SlidingBlocks
from slidepipe.estimation.friction import sliding_window
from slidepipe.estimation.joint_fit import JointStart, _covariance, _Problem, joint_fit
from slidepipe.estimation.slide import Slide
from slidepipe.estimation.weak_form import SlideWindow, bump_functions, quadrature_weights, weak_fit


def window_of(found, slide=None):
    inside = sliding_window(found.tracks.time_s, found.relative, slide or found.slide, 0.01)
    tracks = found.tracks
    return SlideWindow(tracks.time_s, tracks.hand, tracks.object, found.hand, found.object, found.relative, inside)


def test_bump_functions_vanish_with_their_slopes_and_differentiate():
    span, time = (0.3, 0.5), np.linspace(0.3, 0.5, 2001)
    values, curved = (bump_functions(time, span, derivative=order) for order in (0, 2))
    ends = [0, -1]
    assert np.abs(values[:, ends]).max() < 1e-12
    assert np.abs(bump_functions(time, span, derivative=1)[:, ends]).max() < 1e-9
    numeric = np.gradient(np.gradient(values, time, axis=1), time, axis=1)
    np.testing.assert_allclose(numeric[:, 5:-5], curved[:, 5:-5], atol=0.01 * np.abs(curved).max())


def test_quadrature_weights_integrate_on_uneven_stamps():
    time = np.sort(np.random.default_rng(0).uniform(0.0, 1.0, 400))
    weights = quadrature_weights(time, (0.0, 1.0))
    assert weights.sum() == pytest.approx(1.0)
    assert weights @ time**2 == pytest.approx(1.0 / 3.0, abs=1e-3)


def test_blocks_slide_as_an_adaptive_integrator_says():
    h, steps, kappa, rho = 5e-4, 200, 21.0, 0.02
    half = np.arange(2 * steps + 1) * h / 2.0

    def hand(t):
        return np.stack([0.02 + 0.3 * t, 0.01 + 0.2 * t - t**2, 2.0 * t], axis=-1)

    def hand_rate(t):
        return np.stack([0.3 + 0.0 * t, 0.2 - 2.0 * t, 2.0 + 0.0 * t], axis=-1)

    def rate(t, y):
        d, dq = hand(t)[:2] - y[:2], hand_rate(t)
        v = np.array([dq[0] - y[3] + y[5] * d[1], dq[1] - y[4] - y[5] * d[0], rho * (dq[2] - y[5])])
        u = v / np.linalg.norm(v)
        turn = BLOCK.m / BLOCK.inertia * kappa * (rho * u[2] + d[0] * u[1] - d[1] * u[0])
        return [*y[3:], kappa * u[0], kappa * u[1] - GRAVITY, turn]

    start = np.array([0.0, 0.0, 0.0, -2.2, -1.1, 0.0])
    blocks = SlidingBlocks(
        step_s=h,
        hand=hand(half)[:, None],
        hand_velocity=hand_rate(half)[:, None],
        kappa=np.array([kappa]),
        rho_m=np.array([rho]),
        mass_per_inertia=BLOCK.m / BLOCK.inertia,
        soft_m_s=1e-3,
    )
    end = blocks.run(start[:, None])[-1, :, 0]
    expected = solve_ivp(rate, (0.0, steps * h), start, "DOP853", rtol=1e-10, atol=1e-12).y[:, -1]
    np.testing.assert_allclose(end, expected, rtol=1e-5, atol=1e-7)


def test_the_weak_form_is_close_in_the_linear_example(trial_a):
    world, _, found = trial_a
    weak = weak_fit(window_of(found), BLOCK, 0.6 * world.case.a)
    assert weak.kappa == pytest.approx(world.kappa, rel=0.01)
    assert 0.0005 < weak.sd / weak.kappa < 0.01
    assert found.friction.weak_kappa_m_s2 == pytest.approx(world.kappa, rel=0.01)


def test_the_joint_fit_forgets_a_bad_start(trial_a):
    world, asked, found = trial_a
    slowest = 0.2 * found.slide.peak_speed_m_s
    for factor in (0.7, 1.3):
        fit = joint_fit(window_of(found), BLOCK, JointStart(factor * world.kappa, asked.rho_m, slowest))
        assert fit.converged
        assert fit.kappa == pytest.approx(found.friction.kappa_m_s2, rel=0.002)


@pytest.mark.parametrize("seed", [7001, 7003])
def test_noisy_trials_converge_with_steps_to_spare(seed, monkeypatch):
    monkeypatch.setattr(joint_fit_module, "MOST_STEPS", 12)
    world = simulate(CASE_B, 0.38 * (0.97 + 0.013 * (seed - 7000)), seed)
    cameras = Cameras(seed=seed, position_noise_m=0.0005, angle_noise_rad=0.005)
    found = estimate(request(world, cameras))
    assert found.friction is not None, found.friction_reason
    assert abs(np.log(found.friction.kappa_m_s2 / world.kappa)) < 3.5 * found.friction.kappa_relative_sd


def test_the_bound_on_the_first_velocity_is_no_knowledge_of_friction(trial_b, monkeypatch):
    world, asked, found = trial_b
    start = JointStart(world.kappa, asked.rho_m, 0.2 * found.slide.peak_speed_m_s)
    fits = []
    for sds in (10.0, 20.0):
        monkeypatch.setattr(joint_fit_module, "FIRST_SPEED_SDS", sds)
        fits.append(joint_fit(window_of(found), BLOCK, start))
    assert fits[0].kappa_log_sd == pytest.approx(fits[1].kappa_log_sd, rel=0.03)
    assert abs(np.log(fits[0].kappa / fits[1].kappa)) < 0.1 * fits[0].kappa_log_sd


def test_a_parameter_that_the_poses_do_not_tell_has_a_huge_variance():
    covariance = _covariance(np.array([[2.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.0, 0.0, 3.0]]))
    assert covariance[1, 1] > 1e20
    np.testing.assert_allclose(covariance[np.ix_([0, 2], [0, 2])], np.linalg.inv([[4.0, 2.0], [2.0, 11.0]]), rtol=1e-9)


def test_derivatives_agree_along_a_line(trial_b):
    world, asked, found = trial_b
    slowest = 0.2 * found.slide.peak_speed_m_s
    problem = _Problem(window_of(found), BLOCK, JointStart(world.kappa, asked.rho_m, slowest))
    direction = np.random.default_rng(1).normal(size=len(problem.first)) * 3e-6
    ahead, behind = (problem.residuals(problem.first + sign * direction) for sign in (1.0, -1.0))
    slope = problem.jacobian(problem.first) @ direction
    np.testing.assert_allclose((ahead - behind) / 2.0, slope, atol=2e-4 * np.abs(slope).max())


def test_the_window_is_one_stretch_inside_the_slide(trial_a):
    found = trial_a[2]
    rows = np.flatnonzero(window_of(found).inside)
    time_s = found.tracks.time_s[rows]
    assert np.all(np.diff(rows) == 1)
    assert found.slide.start_s < time_s[0] < time_s[-1] < found.slide.stop_s


def test_a_long_slide_gives_a_window_of_a_quarter_of_a_second(trial_a):
    found = trial_a[2]
    time_s = found.tracks.time_s
    inside = sliding_window(time_s, found.relative, Slide(0.0, 9.0, 0.0, 0.0, 1e-9, 1.0, 1), 0.01)
    assert np.ptp(time_s[inside]) <= 0.25
