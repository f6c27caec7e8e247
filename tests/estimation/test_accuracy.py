"""A small version of benchmarks/accuracy.py, and what friction does that the plain law does not know."""

from dataclasses import replace

import numpy as np
import pytest
from synthetic import CASE_A, CASE_B, Cameras, request, simulate

from slidepipe.estimation.estimate import estimate

DIRTY = {"dropout_share": 0.05, "outlier_share": 0.01, "joints_late_s": 0.03}


@pytest.mark.parametrize(("case", "rmse"), [(CASE_A, 0.002), (CASE_B, 0.004)])
def test_friction_is_near_the_information_bound_on_dirty_data(case, rmse):
    errors, sds, rhos = [], [], []
    for seed in range(500, 506):
        world = simulate(case, 0.38 * np.random.default_rng(seed).uniform(0.95, 1.05), seed)
        asked = request(world, Cameras(seed=seed, **DIRTY))
        told = estimate(asked).friction
        errors.append(np.log(told.kappa_m_s2 / world.kappa))
        sds.append(told.kappa_relative_sd)
        rhos.append(np.log(told.rho_m / asked.rho_m))
    assert np.sqrt(np.mean(np.square(errors))) < rmse
    assert np.count_nonzero(np.abs(errors) < 1.96 * np.array(sds)) >= 4
    assert np.max(np.abs(errors)) < 4.0 * rmse
    if case is CASE_B:
        assert np.sqrt(np.mean(np.square(rhos))) < 0.007


def test_friction_that_grows_with_speed_is_off_where_it_is_not_asked_for():
    world = simulate(CASE_B, 0.38, 31, growth=0.3)
    plain = estimate(request(world, Cameras(seed=31))).friction
    assert plain is None or abs(np.log(plain.kappa_m_s2 / world.kappa)) > 0.02


def test_what_growth_would_do_is_told_beforehand():
    world = simulate(CASE_B, 0.38, 32, growth=0.1)
    told = estimate(request(world, Cameras(seed=32))).friction
    change = np.log(told.kappa_m_s2 / world.kappa)
    assert change == pytest.approx(-0.1 * told.per_growth, abs=0.006)


@pytest.mark.parametrize("case", [CASE_A, CASE_B])
def test_a_block_that_sticks_more_firmly_than_it_slides_tells_its_sliding_friction(case):
    world = simulate(case, 0.36, 33, static=1.15)
    told = estimate(request(world, Cameras(seed=33))).friction
    assert abs(np.log(told.kappa_m_s2 / world.kappa)) < 3.5 * told.kappa_relative_sd


def test_a_torsion_that_was_assumed_wrongly_is_found_where_the_slide_turns():
    world = simulate(CASE_B, 0.38, 34)
    asked = request(world, Cameras(seed=34))
    told = estimate(request(world, Cameras(seed=34), rho_m=1.3 * asked.rho_m)).friction
    assert told.rho_m == pytest.approx(asked.rho_m, rel=0.03)
    assert told.kappa_m_s2 == pytest.approx(world.kappa, rel=0.01)
    assert told.rho_told


@pytest.mark.parametrize(("case", "first_s"), [(CASE_A, 0.36), (CASE_B, 0.40)])
def test_ten_frames_of_swapped_markers_in_the_slide_do_no_harm(case, first_s):
    world = simulate(case, 0.39, 35)
    asked = request(world, Cameras(seed=35))
    body, frames = asked.mocap.object, asked.mocap.frames
    first = frames.frame[int(360 * (first_s + 0.4))]
    wrong = (body.sequence >= first) & (body.sequence < first + 10)
    position, quaternion = body.position_m.copy(), body.quaternion_xyzw.copy()
    position[wrong] += [0.02, 0.015, 0.01]
    quaternion[wrong] = quaternion[wrong][:, [1, 0, 3, 2]]
    swapped = replace(body, position_m=position, quaternion_xyzw=quaternion)
    found = estimate(replace(asked, mocap=replace(asked.mocap, object=swapped)))
    assert found.tracks.spikes >= 9
    assert found.friction.kappa_m_s2 == pytest.approx(world.kappa, rel=0.01)
