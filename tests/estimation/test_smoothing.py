import numpy as np
import pytest
from filterpy.kalman import KalmanFilter

from slidepipe.estimation.likelihood import AxisModel, best_process_noise, log_likelihood
from slidepipe.estimation.reference import jerk_covariance, reference_smooth_axis, transition
from slidepipe.estimation.smoothing import rest_noise, smooth, smooth_axis
from slidepipe.estimation.track import Track

MODEL = AxisModel(noise=3e-4, speed=0.1, acceleration=1.0, lowest=-3.0, highest=6.0)


def uneven(count, rng):
    return np.cumsum(rng.choice([1, 1, 1, 2, 9], size=count)) / 360.0


def random_walk(time, density, rng):
    """A trajectory of the model itself: white jerk of the given density."""
    state, states = np.zeros(3), []
    steps = np.diff(time, prepend=time[0])
    for F, Q in zip(transition(steps), jerk_covariance(steps) * density, strict=True):
        state = F @ state + rng.multivariate_normal(np.zeros(3), Q)
        states.append(state)
    return np.array(states)


def test_the_scalar_likelihood_is_filterpys():
    rng = np.random.default_rng(1)
    time = uneven(60, rng)
    value = np.sin(8 * time) * 0.05 + rng.normal(size=60) * 3e-4
    steps = np.diff(time, prepend=time[0])
    kf = KalmanFilter(dim_x=3, dim_z=1)
    kf.P = np.diag([MODEL.noise**2, MODEL.speed**2, MODEL.acceleration**2])
    kf.H, kf.R = np.array([[1.0, 0.0, 0.0]]), np.array([[MODEL.noise**2]])
    total = 0.0
    for F, Q, z in zip(transition(steps), 40.0 * jerk_covariance(steps), value - value[0], strict=True):
        kf.predict(F=F, Q=Q)
        kf.update(np.array([[z]]))
        total += float(kf.log_likelihood)
    ours = log_likelihood(steps, value - value[0], MODEL, 40.0)
    assert ours == pytest.approx(total, rel=1e-9)


def test_process_noise_is_recovered():
    rng = np.random.default_rng(2)
    found = []
    for _ in range(12):
        time = np.arange(400) / 360.0
        value = random_walk(time, 100.0, rng)[:, 0] + rng.normal(size=400) * MODEL.noise
        found.append(best_process_noise(time, value, rng.uniform(size=400) > 0.05, MODEL))
    assert np.exp(np.mean(np.log(found))) == pytest.approx(100.0, rel=0.3)


def test_stated_deviations_are_true_on_uneven_stamps_with_gaps():
    rng = np.random.default_rng(3)
    squares = []
    for _ in range(12):
        time = uneven(150, rng)
        truth = random_walk(time, 50.0, rng)
        valid = rng.uniform(size=150) > 0.1
        valid[60:70] = False
        value = np.where(valid, truth[:, 0] + rng.normal(size=150) * MODEL.noise, 0.0)
        axis = smooth_axis(time, value, valid, MODEL, 50.0)
        squares.append(((axis.state - truth) / axis.sd)[10:] ** 2)
    mean = np.mean(squares, axis=(0, 1))
    np.testing.assert_allclose(mean, 1.0, atol=0.3)


def test_velocity_and_acceleration_are_not_far_off():
    rng = np.random.default_rng(4)
    time = np.arange(500) / 360.0
    pose = np.stack([0.1 * np.sin(6 * time), 0.05 * np.cos(9 * time), 1.0 + np.sin(5 * time)], axis=1)
    speed = np.stack([0.6 * np.cos(6 * time), -0.45 * np.sin(9 * time), 5 * np.cos(5 * time)], axis=1)
    noise = np.array([3e-4, 3e-4, 3e-3])
    track = Track(pose + rng.normal(size=pose.shape) * noise, np.ones(500, bool))
    smoothed = smooth(time, track, noise, np.ones(500, bool))
    inner = slice(20, -20)
    assert np.all(np.sqrt(np.mean((smoothed.pose - pose)[inner] ** 2, axis=0)) < 0.6 * noise)
    assert np.all(np.sqrt(np.mean((smoothed.velocity - speed)[inner] ** 2, axis=0)) < [0.01, 0.01, 0.1])
    assert np.all(smoothed.velocity_sd > 0)


def test_rest_noise_ignores_creep_and_outliers():
    rng = np.random.default_rng(5)
    pose = rng.normal(size=(400, 3)) * [3e-4, 3e-4, 3e-3] + np.linspace(0, 0.002, 400)[:, None]
    pose[::100] += 0.3
    noise = rest_noise(Track(pose, np.ones(400, bool)), np.arange(400) < 390)
    np.testing.assert_allclose(noise, [3e-4, 3e-4, 3e-3], rtol=0.15)


def test_rest_noise_has_a_floor():
    still = Track(np.zeros((50, 3)), np.ones(50, bool))
    np.testing.assert_allclose(rest_noise(still, np.ones(50, bool)), [2e-5, 2e-5, 2e-4])


@pytest.mark.parametrize("density", [1e-1, 50.0, 1e4])
def test_the_compiled_smoother_is_filterpys(density):
    rng = np.random.default_rng(6)
    time = uneven(400, rng)
    valid = rng.uniform(size=400) > 0.15
    valid[100:110] = False
    value = np.where(valid, 2.0 + 0.3 * np.sin(5 * time) + rng.normal(size=400) * 3e-4, np.nan)
    ours, filterpys = (one(time, value, valid, MODEL, density) for one in (smooth_axis, reference_smooth_axis))
    np.testing.assert_allclose(ours.state, filterpys.state, rtol=0, atol=1e-8)
    np.testing.assert_allclose(ours.sd, filterpys.sd, rtol=0, atol=1e-8)
    np.testing.assert_allclose(ours.nis, filterpys.nis, rtol=1e-6)
    assert np.isnan(ours.nis[~valid]).all()


def test_a_wrapped_angle_is_smoothed_as_its_unwrapped_one():
    rng = np.random.default_rng(7)
    time = np.arange(300) / 360.0
    angle = 25.0 * time + rng.normal(size=300) * 3e-3
    model = AxisModel(noise=3e-3, speed=30.0, acceleration=10.0, lowest=-1.0, highest=8.0)
    valid = rng.uniform(size=300) > 0.1
    wrapped = smooth_axis(time, np.angle(np.exp(1j * angle)), valid, model, 1e3, period=2 * np.pi)
    plain = smooth_axis(time, angle, valid, model, 1e3)
    turns = (wrapped.state[:, 0] - plain.state[:, 0]) / (2 * np.pi)
    np.testing.assert_allclose(turns, np.round(turns[0]), atol=1e-9)
    np.testing.assert_allclose(wrapped.state[:, 1:], plain.state[:, 1:], atol=1e-6)


def test_innovations_are_consistent_with_the_model():
    rng = np.random.default_rng(8)
    time = np.arange(600) / 360.0
    path = np.stack([random_walk(time, density, rng)[:, 0] for density in (100.0, 100.0, 1e4)], axis=1)
    noise = np.array([3e-4, 3e-4, 3e-3])
    track = Track(path + rng.normal(size=path.shape) * noise, np.ones(600, bool))
    smoothed = smooth(time, track, noise, np.ones(600, bool))
    np.testing.assert_allclose(smoothed.consistency, 1.0, atol=0.2)
