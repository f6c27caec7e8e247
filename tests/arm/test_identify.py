"""An arm whose masses and friction are wrong, driven by MuJoCo's inverse dynamics, and found again."""

import numpy as np
import pytest

from slidepipe.arm import wam
from slidepipe.arm.dynamics import arm_load
from slidepipe.arm.identify import ArmCorrection, correct, identify
from slidepipe.arm.inverse_kinematics import JointPath
from slidepipe.arm.model import FLANGE, Tool, arm_spec, nominal_model
from slidepipe.errors import InputError
from slidepipe.series import JointSeries

TOOL = Tool(0.1, 0.3)
HEAVIER, STICKIER = 0.06, 0.25
POSTURE = np.array([1.38, -1.06, -1.18, 1.98, 0.9, -0.37, -0.09])


def path(seconds: float = 1.0, phase: float = 0.0) -> JointPath:
    """Rest, a sway of every joint, rest; smooth to the second derivative."""
    t = np.arange(round(500 * seconds) + 1) / 500
    share = np.clip((t - 0.1) / (seconds - 0.2), 0.0, 1.0)
    window = (share * (1.0 - share) * 4.0) ** 3
    sway = 0.25 * np.sin(2 * np.pi * t[:, None] * np.linspace(1.5, 2.5, 7) + phase + np.arange(7))
    q = POSTURE + window[:, None] * sway
    dq = np.gradient(q, t, axis=0)
    return JointPath(t, q, dq, np.gradient(dq, t, axis=0))


def real_arm():
    spec = arm_spec(TOOL, 1.0 + HEAVIER)
    load = spec.body(FLANGE).add_body(name="load", pos=[0.0, 0.0, TOOL.length_m / 2])
    load.mass, load.ipos, load.inertia = wam.GRIPPER_MASS_KG, [0.0] * 3, [wam.GRIPPER_MASS_KG * 0.03**2] * 3
    load.explicitinertial = True
    return spec.compile()


def friction(dq: np.ndarray) -> np.ndarray:
    return np.array(wam.COULOMB_FRICTION) * np.tanh(dq / 0.02) + np.array(wam.VISCOUS_FRICTION) * dq


def driven(way: JointPath, noise_n_m: float = 0.0) -> JointSeries:
    """What a trial would record of an arm that follows exactly."""
    torque = arm_load(real_arm(), way).torque_n_m + STICKIER * friction(way.velocity_rad_s)
    held = 0.5 * (torque + np.concatenate([torque[1:], torque[-1:]]))
    held += noise_n_m * np.random.default_rng(1).standard_normal(held.shape)
    encoders = np.round(way.position_rad * 2**15) / 2**15
    return JointSeries((2_000_000 * np.arange(len(held))).astype(np.int64), encoders, way.velocity_rad_s, held)


def test_masses_and_friction_are_found() -> None:
    found = identify(nominal_model(TOOL), [driven(path()), driven(path(1.4, 1.0))])
    assert found.moving_mass[:4] == pytest.approx(np.full(4, HEAVIER), abs=0.015)
    assert found.resting_mass[[1, 3]] == pytest.approx(np.full(2, HEAVIER), abs=0.01)
    assert found.coulomb == pytest.approx(np.full(7, STICKIER), abs=0.08)
    assert found.coulomb + found.viscous == pytest.approx(np.full(7, 2 * STICKIER), abs=0.2)
    assert np.all(found.left_rms_n_m < 0.25 * found.torque_rms_n_m)


def test_more_trials_are_more_certain() -> None:
    model, trials = nominal_model(TOOL), [driven(path(phase=phase), 0.1) for phase in range(3)]
    one, three = identify(model, trials[:1]), identify(model, trials)
    assert np.all(three.std[:4, :2] <= one.std[:4, :2] + 1e-12)
    assert np.mean(three.std) < 0.8 * np.mean(one.std)


def test_arm_that_is_as_its_table_says_needs_no_correction() -> None:
    way = path()
    torque = arm_load(nominal_model(TOOL), way).torque_n_m
    held = 0.5 * (torque + np.concatenate([torque[1:], torque[-1:]]))
    stamps = (2_000_000 * np.arange(len(held))).astype(np.int64)
    found = identify(nominal_model(TOOL), [JointSeries(stamps, way.position_rad, way.velocity_rad_s, held)])
    for shares in (found.moving_mass, found.resting_mass, found.coulomb):
        assert np.max(np.abs(shares)) < 0.04


def test_joint_that_rests_teaches_nothing() -> None:
    way = path()
    still = JointPath(way.time_s, np.tile(POSTURE, (len(way.time_s), 1)), *np.zeros((2, len(way.time_s), 7)))
    found = identify(nominal_model(TOOL), [driven(still)])
    assert np.all(found.coulomb == 0.0)
    assert np.allclose(found.std[:, 2], 0.5)


def test_corrected_torques_are_the_real_arms_beyond_its_weight() -> None:
    way, seven = path(), np.ones(7)
    nominal = arm_load(nominal_model(TOOL), way)
    known = ArmCorrection(
        HEAVIER * seven, HEAVIER * seven, STICKIER * seven, STICKIER * seven, np.zeros((7, 4)), seven, seven
    )
    extra = correct(nominal, nominal_model(TOOL), way, known).feedforward_n_m - nominal.feedforward_n_m
    real = arm_load(real_arm(), way).feedforward_n_m - nominal.feedforward_n_m
    real += STICKIER * friction(way.velocity_rad_s + 0.001 * way.acceleration_rad_s2)
    left = (extra - real)[100:-100]
    assert np.all(np.sqrt(np.mean(left**2, axis=0)) < 0.05 * np.sqrt(np.mean(real[100:-100] ** 2, axis=0)) + 0.02)


@pytest.mark.parametrize(("trials", "message"), [([], "one recorded trial or more"), ([3], "50 samples")])
def test_nothing_to_learn_from(trials: list[int], message: str) -> None:
    short = [JointSeries(np.arange(n), *np.zeros((3, n, 7))) for n in trials]
    with pytest.raises(InputError, match=message):
        identify(nominal_model(TOOL), short)
