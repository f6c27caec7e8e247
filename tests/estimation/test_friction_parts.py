import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from synthetic import BLOCK, CASE_A, CASE_B, Cameras, simulate
from synthetic import request as asked_of

from slidepipe.estimation import joint_fit as joint_fit_module
from slidepipe.estimation.estimate import estimate
from slidepipe.estimation.friction import sliding_window
from slidepipe.estimation.joint_fit import JointStart, joint_fit
from slidepipe.estimation.joint_kernel import STICKS, predict
from slidepipe.estimation.laws import Laws
from slidepipe.estimation.linear_kernel import inverse_of
from slidepipe.estimation.slide import Slide
from slidepipe.estimation.weak_form import SlideWindow, bump_functions, quadrature_weights, weak_fit
from slidepipe.mechanics.patch_curve import patch_curve


def window_of(found, slide=None):
    inside = sliding_window(found.tracks.time_s, found.relative, slide or found.slide, 0.01)
    tracks = found.tracks
    return SlideWindow(
        tracks.time_s, tracks.hand, tracks.object, found.hand, found.object, found.relative, inside, inside
    )


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


class Spline:
    """The true hand of a synthetic trial as the kernel's spline, from before its slide to after it."""

    def __init__(self, case, factor, intervals, seed=1):
        self.world = simulate(case, 0.38 * factor, seed)
        self.opens, self.closes = case.times[0] - 0.06, case.times[0] + case.times[1] + 0.06
        self.count, knot = intervals + 3, (self.closes - self.opens) / intervals
        hand = CubicSpline(self.world.time, self.world.hand)
        at = self.opens + knot * (np.arange(self.count) - 1)
        coefficients = hand(at) - knot**2 / 6 * hand(at, 2)
        law = [np.log(self.world.kappa), np.log(0.6 * case.a), 0.0, 0.0]
        self.z = np.concatenate([coefficients.T.ravel(), case.r_start, np.zeros(3), law])
        self.time, self.knot = np.linspace(self.opens, self.closes, 400), knot

    def block(self, z, step_s, derivatives=False, curve=None):
        steps = int(np.ceil((self.closes - self.opens) / step_s))
        pose, path = np.empty((len(self.time), 3)), np.empty((steps + 1, 7))
        jacobian = np.empty((len(self.time) if derivatives else 0, 3, len(z)))
        clock = np.array([self.opens, self.knot, self.opens, (self.closes - self.opens) / steps, steps, 0])
        predict(z, np.array([STICKS, BLOCK.m / BLOCK.inertia]), clock, curve, self.time, pose, jacobian, path)
        return pose, jacobian, path


@pytest.mark.parametrize(("case", "factor"), [(CASE_A, 1.02), (CASE_B, 0.97)])
def test_the_block_sticks_slides_and_sticks_as_an_event_driven_integrator_says(case, factor):
    spline = Spline(case, factor, 320)
    pose, _, path = spline.block(spline.z, 2e-4)
    true = CubicSpline(spline.world.time, spline.world.object)(spline.time)
    # The integrator lets a slide begin with 0.2 mm/s and end at 0.1: over a quarter of a second that is 0.05 mm.
    assert np.abs(pose - true)[:, :2].max() < 1e-4
    assert np.abs(pose - true)[:, 2].max() < 2e-3
    sliding = np.flatnonzero(path[:, 6] > 0.0) * 2e-4 + spline.opens
    assert sliding[0] == pytest.approx(spline.world.slide[0], abs=1e-3)
    assert sliding[-1] == pytest.approx(spline.world.slide[1], abs=1e-3)


@pytest.mark.parametrize("curve", [None, patch_curve(1.5)], ids=["ellipsoid", "pressure"])
def test_derivatives_of_the_block_are_those_of_differences(curve):
    spline = Spline(CASE_B, 1.03, 40)
    z = spline.z.copy()
    z[-2:] = 0.1, 0.01
    _, jacobian, _ = spline.block(z, 1e-3, derivatives=True, curve=curve)
    rng = np.random.default_rng(1)
    used = np.r_[0 : 3 * spline.count + 3, len(z) - 4 : len(z)]
    for _ in range(4):
        direction = np.zeros(len(z))
        direction[used] = rng.normal(size=len(used)) * 1e-7
        ahead, behind = (spline.block(z + sign * direction, 1e-3, curve=curve)[0] for sign in (1.0, -1.0))
        slope = jacobian @ direction
        np.testing.assert_allclose((ahead - behind) / 2.0, slope, atol=1e-4 * np.abs(slope).max())


def test_the_weak_form_is_close_in_the_linear_example(trial_a):
    world, _, found = trial_a
    weak = weak_fit(window_of(found), BLOCK, 0.6 * world.case.a)
    assert weak.kappa == pytest.approx(world.kappa, rel=0.01)
    assert 0.0005 < weak.sd / weak.kappa < 0.01
    assert found.friction.weak_kappa_m_s2 == pytest.approx(world.kappa, rel=0.01)


@pytest.mark.parametrize("trial", ["trial_a", "trial_b"])
def test_the_joint_fit_forgets_a_bad_start(trial, request):
    world, asked, found = request.getfixturevalue(trial)
    opens, closes = found.slide.start_s - 0.06, found.slide.stop_s + 0.06
    for factor in (0.97, 1.03):
        start = JointStart(factor * world.kappa, asked.rho_m, opens, closes, found.initial.pose)
        fit = joint_fit(window_of(found), BLOCK, start, Laws())
        assert fit.converged
        assert fit.kappa == pytest.approx(found.friction.kappa_m_s2, rel=0.002)


@pytest.mark.parametrize("seed", [7001, 7003])
def test_noisy_trials_converge_with_steps_to_spare(seed, monkeypatch):
    monkeypatch.setattr(joint_fit_module, "MOST_STEPS", 20)
    world = simulate(CASE_B, 0.38 * (0.97 + 0.013 * (seed - 7000)), seed)
    cameras = Cameras(seed=seed, position_noise_m=0.0005, angle_noise_rad=0.005)
    found = estimate(asked_of(world, cameras))
    assert found.friction is not None, found.friction_reason
    assert abs(np.log(found.friction.kappa_m_s2 / world.kappa)) < 3.5 * found.friction.kappa_relative_sd


def test_a_parameter_that_the_poses_do_not_tell_has_a_huge_variance():
    jacobian = np.array([[2.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.0, 0.0, 3.0]])
    covariance = inverse_of(jacobian.T @ jacobian)
    assert covariance[1, 1] > 1e20
    np.testing.assert_allclose(covariance[np.ix_([0, 2], [0, 2])], np.linalg.inv([[4.0, 2.0], [2.0, 11.0]]), rtol=1e-9)


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
