from dataclasses import replace

import numpy as np
import pytest
from synthetic import BLOCK, CASE_A, CASE_B, CORRECTION, REST, Cameras, World, request, simulate

from slidepipe.errors import EstimationError, InputError
from slidepipe.estimation.estimate import estimate
from slidepipe.mechanics.planar import object_pose, relative_pose

HOST_ZERO_S = 0.7 + REST


def relative(world):
    return relative_pose(world.object, world.hand)


def fitted(case, mu, seed, cameras=None):
    world = simulate(case, mu, seed)
    found = estimate(request(world, cameras or Cameras(seed=seed)))
    return world, found


def test_rest_poses_agree_with_the_truth(trial_a, trial_b):
    for world, _, found in (trial_a, trial_b):
        for rest, row in ((found.initial, 0), (found.final, -1)):
            error = rest.pose - relative(world)[row]
            assert np.all(np.abs(error) < 4.0 * rest.sd)
            assert np.all(rest.sd < [1e-4, 1e-4, 6e-4])
        assert found.lost is None


def test_smoothed_series_agree_with_the_truth(trial_a):
    world, _, found = trial_a
    at = found.tracks.stamp_ns * 1e-9 - HOST_ZERO_S
    for smooth, truth in ((found.hand, world.hand), (found.object, world.object), (found.relative, relative(world))):
        true = np.stack([np.interp(at, world.time, column) for column in truth.T], axis=1)
        error = np.sqrt(np.mean((smooth.pose - true) ** 2, axis=0))
        assert np.all(error < 0.7 * smooth.noise)
        for series in (smooth.pose, smooth.velocity, smooth.acceleration, smooth.pose_sd, smooth.acceleration_sd):
            assert np.isfinite(series).all()


def test_slide_ends_are_where_it_slid(trial_a, trial_b):
    for world, _, found in (trial_a, trial_b):
        start, stop = (found.host_ns(s) * 1e-9 - HOST_ZERO_S for s in (found.slide.start_s, found.slide.stop_s))
        assert abs(start - world.slide[0]) < min(0.012, 3 * found.slide.start_sd_s)
        assert abs(stop - world.slide[1]) < min(0.012, 3 * found.slide.stop_sd_s)
        assert found.slide.travel_m == pytest.approx(world.slide[2], rel=0.1)
        assert found.slide.pieces == 1


def test_friction_of_the_linear_example():
    log_errors, sds = [], []
    for seed, factor in enumerate((0.9, 1.0, 1.0, 1.05, 1.12, 1.15)):
        world, found = fitted(CASE_A, 0.38 * factor, seed)
        log_errors.append(np.log(found.friction.kappa_m_s2 / world.kappa))
        sds.append(found.friction.kappa_relative_sd)
    assert abs(np.mean(log_errors)) < 0.006
    assert np.std(log_errors) < 0.01
    assert np.all(np.abs(log_errors) < 3.5 * np.array(sds))
    assert max(sds) < 0.02


def test_friction_of_the_rotational_example():
    log_errors, sds = [], []
    for seed, factor in enumerate((0.95, 1.0, 1.0, 1.05)):
        world, found = fitted(CASE_B, 0.38 * factor, seed)
        log_errors.append(np.log(found.friction.kappa_m_s2 / world.kappa))
        sds.append(found.friction.kappa_relative_sd)
        assert found.friction.rho_m == pytest.approx(0.03, rel=0.03)
    assert abs(np.mean(log_errors)) < 0.015
    assert np.std(log_errors) < 0.015
    assert np.all(np.abs(log_errors) < 4.0 * np.array(sds))


def test_mu_is_kappa_with_the_assumed_force(trial_a):
    _, asked, found = trial_a
    friction = found.friction
    assert friction.mu == pytest.approx(friction.kappa_m_s2 * BLOCK.m / asked.normal_force_n)
    assert friction.mu_interval.low < friction.mu < friction.mu_interval.high
    assert any("mu is with the assumed normal force 1.25 N" in note for note in found.not_told)
    assert any("tells nothing of the torsion" in note for note in found.not_told)


def test_the_rotational_example_tells_rho(trial_b):
    found = trial_b[2]
    assert found.friction.rho_relative_sd < 0.02
    assert any("only their product" in note for note in found.not_told)


def test_a_small_correction_is_given_widely_or_refused():
    for seed in (0, 1, 2):
        world, found = fitted(CORRECTION, 0.38, seed)
        if found.friction is None:
            assert "refused" in found.friction_reason
            continue
        error = np.log(found.friction.kappa_m_s2 / world.kappa)
        assert 0.002 < found.friction.kappa_relative_sd < 0.1
        assert abs(error) < 3.0 * found.friction.kappa_relative_sd


def test_a_block_that_never_slides():
    world, found = fitted(CASE_A, 0.6, 3)
    assert world.slide is None
    assert found.slide is None
    assert found.friction is None
    assert "no slide" in found.slide_reason
    assert 0.004 < found.slide_threshold_m_s < 0.05
    assert found.final is not None


def test_a_gap_in_the_slide_and_many_dropouts_do_little_harm():
    world, found = fitted(CASE_A, 0.38, 4, Cameras(seed=4, dropout_share=0.2, gap_s=(0.38, 0.405)))
    assert found.friction.kappa_m_s2 == pytest.approx(world.kappa, rel=0.015)


@pytest.mark.parametrize(("case", "mu"), [(CASE_A, 0.43), (CASE_B, 0.39)])
def test_without_noise_and_tracking_error_friction_is_nearly_exact(case, mu):
    clean = Cameras(seed=5, position_noise_m=0.0, angle_noise_rad=0.0, dropout_share=0.0, latency_jitter_s=0.0)
    world = simulate(case, mu, 5, error_m=0.0, blur_s=0.0)
    found = estimate(request(world, clean))
    assert found.friction.kappa_m_s2 == pytest.approx(world.kappa, rel=0.001)
    assert found.final.pose == pytest.approx(relative(world)[-1], abs=1e-6)


def test_gross_outliers_at_rest_are_left_out(trial_a):
    world, asked, _ = trial_a
    body = asked.mocap.object
    position = body.position_m.copy()
    position[-100::20] += 0.08
    mocap = replace(asked.mocap, object=replace(body, position_m=position))
    found = estimate(replace(asked, mocap=mocap))
    assert np.all(np.abs(found.final.pose - relative(world)[-1]) < 4.0 * found.final.sd)
    assert any("poses far from their neighbours were left out" in note for note in found.notes)


def thrown(world):
    """The object leaves the hand at 0.5 s into the motion and falls."""
    t = np.maximum(world.time - 0.5, 0.0)
    fall = np.stack([0.3 * t, -4.905 * t**2, 2.0 * t], axis=1)
    return World(world.time, world.hand, world.object + fall, world.slide, world.kappa, world.case)


def test_a_thrown_object_is_told_and_its_slide_still_tells_friction():
    world = thrown(simulate(CASE_A, 0.38, 6))
    found = estimate(request(world, Cameras(seed=6)))
    assert found.final is None
    assert "the object is lost" in found.lost
    assert found.initial is not None
    assert found.slide is not None


def test_an_object_that_is_not_tracked_at_the_end(trial_a):
    _, asked, _ = trial_a
    frames, body = asked.mocap.frames, asked.mocap.object
    early = body.sequence < frames.frame[-200]
    gone = replace(
        body, **{name: getattr(body, name)[early] for name in ("stamp_ns", "position_m", "quaternion_xyzw", "sequence")}
    )
    mocap = replace(
        asked.mocap,
        object=gone,
        frames=replace(frames, object_valid=frames.object_valid & (frames.frame < gone.sequence[-1])),
    )
    found = estimate(replace(asked, mocap=mocap))
    assert found.final is None
    assert "the object is lost: it was tracked in 0 of" in found.lost
    assert found.friction is not None


def test_an_object_that_still_slips_at_the_end():
    world = simulate(CASE_A, 0.6, 7)
    creep = np.zeros((len(world.time), 3))
    creep[:, 0] = 0.02 * np.maximum(world.time - 1.0, 0.0)
    body = object_pose(world.hand, relative(world) + creep)
    moving = World(world.time, world.hand, body, world.slide, world.kappa, world.case)
    found = estimate(request(moving, Cameras(seed=7)))
    assert found.final is None
    assert "still moves in the hand after the motion: 0.0" in found.lost
    assert found.friction is None


def test_degenerate_recordings(trial_a):
    _, asked, _ = trial_a
    mocap = asked.mocap
    none = np.zeros(len(mocap.frames.frame), dtype=bool)
    body = mocap.object
    empty = replace(
        body, **{name: getattr(body, name)[:0] for name in ("stamp_ns", "position_m", "quaternion_xyzw", "sequence")}
    )
    blind = replace(mocap, object=empty, frames=replace(mocap.frames, object_valid=none))
    unseen = replace(mocap, frames=replace(mocap.frames, object_valid=none, hand_valid=none))
    back = replace(mocap, frames=replace(mocap.frames, ticks=mocap.frames.ticks[::-1]))
    for bad, error, message in (
        (blind, EstimationError, "object tracked in 0 of"),
        (unseen, EstimationError, "hand tracked in 0 of"),
        (back, InputError, "ticks goes back"),
    ):
        with pytest.raises(error, match=message) as caught:
            estimate(replace(asked, mocap=bad))
        assert len(caught.value.lines) == 1


def test_one_frame(trial_a):
    _, asked, _ = trial_a
    frames = asked.mocap.frames
    names = ("frame", "ticks", "received_ns", "hand_valid", "object_valid")
    one = replace(frames, **{name: getattr(frames, name)[:1] for name in names})
    poses = {}
    for body in ("hand", "object"):
        series = getattr(asked.mocap, body)
        fields = ("stamp_ns", "position_m", "quaternion_xyzw", "sequence")
        poses[body] = replace(series, **{name: getattr(series, name)[:1] for name in fields})
    with pytest.raises(EstimationError, match="1 camera frames were recorded"):
        estimate(replace(asked, mocap=replace(asked.mocap, frames=one, **poses)))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"normal_force_n": 0.0}, "normal_force_n must be a positive number"),
        ({"rho_m": float("nan")}, "rho_m must be a positive number"),
        ({"relative_angle_rad": float("inf")}, "relative_angle_rad must be a finite angle"),
        ({"motion_stop_ns": 0}, "the motion must stop after it starts"),
    ],
)
def test_requests_that_cannot_be(trial_a, change, message):
    with pytest.raises(InputError, match=message):
        replace(trial_a[1], **change)


def test_a_recording_without_rest(trial_a):
    _, asked, found = trial_a
    with pytest.raises(EstimationError, match="at rest before the motion"):
        estimate(replace(asked, motion_start_ns=int(found.tracks.stamp_ns[0])))
