"""The grip as a MuJoCo model: its forces and its cone, and that a rig without an arm does what the mechanics say."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from paper_cases import BLOCK, LINEAR, ROTATIONAL, linear_finger, rotational_finger

from slidepipe.errors import InputError
from slidepipe.lab.grip_model import ContactSettings, FreeBlock, closing_forces, finger_names
from slidepipe.lab.planar_rig import planar_rig, roll, run_rig, step_times
from slidepipe.mechanics.hand_motion import HandMotion
from slidepipe.mechanics.limit_surface import SoftFinger
from slidepipe.mechanics.stepping import PlacedFinger, step_through
from slidepipe.planning.three_phase import Regrasp, ThreePhaseMotion

COARSE = ContactSettings(timestep_s=1e-4, solref_s=4e-4, impratio=1000.0)
FINE = ContactSettings(timestep_s=5e-5, solref_s=2e-4, impratio=1000.0)


def lone(finger: SoftFinger) -> tuple[PlacedFinger, ...]:
    return (PlacedFinger(finger, np.zeros(2)),)


def spread(finger: SoftFinger, places: list[tuple[float, float]]) -> tuple[PlacedFinger, ...]:
    share = replace(finger, f_N=finger.f_N / len(places))
    return tuple(PlacedFinger(share, np.array(place)) for place in places)


def hand_of(regrasp: Regrasp, finger: SoftFinger) -> HandMotion:
    return ThreePhaseMotion(regrasp, BLOCK, finger).hand_motion()


def still(end_s: float) -> HandMotion:
    return HandMotion(np.array([0.0, end_s]), np.zeros((1, 2, 3)), np.array([True, True]))


def test_each_finger_is_a_pair_with_the_papers_ellipsoid() -> None:
    fingers = spread(linear_finger(), [(0.01, 0.0), (-0.01, 0.005)])
    model = planar_rig(BLOCK, fingers, FINE).model
    assert (model.npair, model.nu, model.neq) == (4, 4, 2)
    mu, rho = 0.38, 0.0174 * 0.6
    np.testing.assert_allclose(model.pair_friction[:, :3], np.tile([mu, mu, mu * rho], (4, 1)))
    assert np.all(model.pair_dim == 4)
    assert model.opt.cone == mujoco.mjtCone.mjCONE_ELLIPTIC
    for number, placed in enumerate(fingers):
        for name in finger_names(number):
            np.testing.assert_allclose(model.body(name).pos[:2], placed.place)


def test_the_block_has_the_planar_mass_and_inertia() -> None:
    model = planar_rig(BLOCK, lone(linear_finger()), FINE).model
    assert model.body("block").mass[0] == pytest.approx(BLOCK.m)
    assert model.body("block").inertia[2] == pytest.approx(BLOCK.inertia)


def test_a_pair_presses_with_its_fingers_normal_force() -> None:
    fingers = spread(linear_finger(), [(0.01, 0.0), (-0.01, 0.005), (0.0, -0.01)])
    np.testing.assert_allclose(closing_forces(fingers), 1.25 / 6)
    rig = planar_rig(BLOCK, fingers, FINE)
    data = mujoco.MjData(rig.model)
    data.ctrl[:] = rig.forces_n
    mujoco.mj_step(rig.model, data, nstep=400)
    wrench = np.empty(6)
    for contact in range(6):
        mujoco.mj_contactForce(rig.model, data, contact, wrench)
        assert wrench[0] == pytest.approx(1.25 / 6, rel=1e-3)


def test_the_hand_goes_where_it_is_told() -> None:
    hand = hand_of(LINEAR, linear_finger())
    rig = planar_rig(BLOCK, lone(linear_finger()), COARSE)
    q_f = hand.at(step_times(rig, hand))
    states = roll(rig, q_f, LINEAR.r_start)
    np.testing.assert_allclose(states[:, 1:4], q_f[1:], atol=5e-6)


@pytest.mark.parametrize(
    ("regrasp", "finger", "within"),
    [(LINEAR, linear_finger(), [5e-5, 5e-5, 5e-4]), (ROTATIONAL, rotational_finger(), [1e-4, 1e-4, 1.5e-3])],
    ids=["linear", "rotational"],
)
def test_a_rig_ends_where_the_plan_says(regrasp: Regrasp, finger: SoftFinger, within: list[float]) -> None:
    motion = run_rig(planar_rig(BLOCK, lone(finger), FINE), hand_of(regrasp, finger), regrasp.r_start)
    assert np.all(np.abs(motion.r_f_b[-1] - regrasp.r_goal) < within)
    before = motion.r_f_b[np.searchsorted(motion.time_s, 0.0)]
    np.testing.assert_allclose(before, regrasp.r_start, atol=5e-6)


def test_fingers_apart_agree_with_stepping() -> None:
    fingers = spread(linear_finger(), [(0.008, 0.0), (-0.008, 0.004), (0.0, -0.006)])
    hand = hand_of(LINEAR, linear_finger())
    time_s = 5e-5 * np.arange(round((hand.breaks[-1] + 0.1) / 5e-5) + 1)
    stepped = step_through(time_s, hand.at(time_s), BLOCK, fingers, LINEAR.r_start).r_f_b[-1]
    rolled = run_rig(planar_rig(BLOCK, fingers, FINE), hand, LINEAR.r_start).r_f_b[-1]
    assert np.linalg.norm(stepped[:2] - LINEAR.r_start[:2]) > 5e-3
    assert np.all(np.abs(rolled - stepped) < [1e-4, 1e-4, 2e-3])


def test_a_resting_block_creeps_by_nothing_that_counts() -> None:
    motion = run_rig(planar_rig(BLOCK, lone(linear_finger()), COARSE), still(0.5), LINEAR.r_start)
    crept = np.abs(motion.r_f_b[-1] - LINEAR.r_start)
    assert np.all(crept < [2e-6, 2e-6, 2e-4])


def test_bad_values_are_told() -> None:
    with pytest.raises(InputError, match="a grip needs at least one finger"):
        planar_rig(BLOCK, (), FINE)
    with pytest.raises(InputError, match="mass_kg must be a positive number, got -1"):
        FreeBlock(np.ones(3), -1.0)
    with pytest.raises(InputError, match="size_m must be three positive numbers"):
        FreeBlock(np.array([1.0, 0.0, 1.0]), 1.0)
    with pytest.raises(InputError, match="r_f_b must be three finite numbers"):
        run_rig(planar_rig(BLOCK, lone(linear_finger()), COARSE), still(0.1), np.array([0.0, np.nan, 0.0]))
