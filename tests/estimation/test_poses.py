from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import uniform_filter1d
from scipy.spatial.transform import Rotation

from slidepipe.errors import EstimationError, InputError
from slidepipe.estimation.gate import without_outliers
from slidepipe.estimation.plane import to_plane
from slidepipe.estimation.poses import align
from slidepipe.estimation.track import Track
from slidepipe.mechanics.planar import MotionPlane, finger_pose
from slidepipe.series import FrameSeries, PoseSeries

PLANE = MotionPlane(np.array([0.5, 0.1, 0.3]), 1.1)
COUNT = 60
TURNING = np.stack([np.zeros(COUNT), np.linspace(0, 0.3, COUNT), np.linspace(2.0, 5.0, COUNT)], axis=1)
RELATIVE = np.array([0.01, 0.02, 3.1])


def series(pose, rows=None):
    rows = np.arange(len(pose)) if rows is None else np.asarray(rows)
    position, matrix = PLANE.lift(pose[rows])
    return PoseSeries(rows * 1000, position, Rotation.from_matrix(matrix).as_quat(), rows)


def frames(hand, body):
    seen = np.zeros((2, COUNT), dtype=bool)
    seen[0, hand], seen[1, body] = True, True
    number = np.arange(COUNT)
    return FrameSeries(number, number * 1000, number * 1000, seen[0], seen[1])


def aligned(hand_rows, body_rows, about=3.1):
    hand = to_plane("hand", series(finger_pose(TURNING, RELATIVE), hand_rows), PLANE)
    body = to_plane("object", series(TURNING, body_rows), PLANE)
    return align(frames(hand_rows, body_rows), np.arange(COUNT) * 2_777_778, hand, body, about)


def test_a_turning_body_is_unwrapped_across_a_gap():
    rows = np.delete(np.arange(COUNT), np.s_[20:28])
    body = to_plane("object", series(TURNING, rows), PLANE)
    np.testing.assert_allclose(body.pose, TURNING[rows], atol=1e-9)
    np.testing.assert_allclose(body.distance_m, 0.0, atol=1e-12)
    np.testing.assert_allclose(body.tilt_rad, 0.0, atol=1e-7)


@pytest.mark.parametrize("about", [3.1, 3.1 - 2 * np.pi, 6.0, -0.02])
def test_the_relative_pose_is_taken_frame_by_frame_near_the_planned_angle(about):
    hand, body = np.delete(np.arange(COUNT), [3, 4, 40]), np.delete(np.arange(COUNT), [4, 5])
    tracks = aligned(hand, body, about)
    expected = RELATIVE + np.array([0, 0, 2 * np.pi * np.round((about - 3.1) / (2 * np.pi))])
    assert set(np.flatnonzero(~tracks.relative.valid)) == {3, 4, 5, 40}
    assert not tracks.relative.pose[~tracks.relative.valid].any()
    np.testing.assert_allclose(
        tracks.relative.pose[tracks.relative.valid], np.tile(expected, (COUNT - 4, 1)), atol=1e-9
    )


@pytest.fixture(scope="module")
def moving():
    """Two seconds of a body that is jerked about: (time, true pose, noise)."""
    time = np.arange(720) / 360
    share = np.clip(time - 0.5, 0.0, 1.0)
    ramp = share**3 * (10 - 15 * share + 6 * share**2)
    pose = np.stack([0.4 * ramp, 0.1 * np.sin(9 * ramp), 2.5 + 2.0 * np.sin(5 * ramp)], axis=1)
    return time, pose, np.random.default_rng(3).normal(size=pose.shape) * [3e-4, 3e-4, 3e-3]


def test_the_gate_leaves_clean_poses_alone(moving):
    time, pose, noise = moving
    valid = np.random.default_rng(4).uniform(size=len(time)) > 0.2
    valid[300:310] = False
    kept = without_outliers(time, Track(pose + noise, valid))
    assert np.array_equal(kept.valid, valid)
    np.testing.assert_allclose(kept.pose[valid], (pose + noise)[valid], atol=1e-12)


def test_the_gate_takes_out_gross_outliers_and_keeps_the_rest(moving):
    time, pose, noise = moving
    rng = np.random.default_rng(5)
    gross = rng.uniform(size=len(time)) < 0.05
    shift = rng.uniform(0.004, 0.1, (len(time), 3)) * [1.0, -1.0, 20.0] * gross[:, None]
    kept = without_outliers(time, Track(pose + noise + shift, np.ones(len(time), bool)))
    assert not (kept.valid & gross).any()
    assert (kept.valid | gross).all()
    np.testing.assert_allclose(kept.pose[kept.valid], (pose + noise)[kept.valid], atol=1e-9)


@pytest.mark.parametrize("length", [1, 10, 20])
def test_swapped_markers_are_taken_out_wherever_they_begin(moving, length):
    time, pose, noise = moving
    for first in range(200, 520, 40):
        swapped = pose + noise
        swapped[first : first + length] += [0.02, -0.015, 1.5]
        wrong = np.zeros(len(time), bool)
        wrong[first : first + length] = True
        kept = without_outliers(time, Track(swapped, np.ones(len(time), bool))).valid
        assert not (kept & wrong).any(), first
        assert np.count_nonzero(~kept & ~wrong) <= 3, first


@pytest.mark.parametrize("reach_m", [0.016, 0.02, 0.024])
def test_a_short_violent_motion_between_rests_is_no_swap(reach_m):
    """Away for a tenth of a second, about, and back, as a hand in a slide of a few millimetres."""
    fine = np.arange(1200) * 1e-3
    share = np.clip(1.0 - np.abs(fine - 0.6) / 0.1, 0.0, 1.0)
    time = np.arange(432) / 360.0
    way = reach_m * np.interp(time, fine, uniform_filter1d(share**2, 10))
    pose = np.stack([-way, 0.6 * way, -17.0 * way], axis=1)
    noise = np.random.default_rng(4).normal(size=pose.shape) * [3e-4, 3e-4, 3e-3]
    kept = without_outliers(time, Track(pose + noise, np.ones(len(time), bool))).valid
    assert np.mean(kept[(time > 0.5) & (time < 0.7)]) > 0.9
    swapped = (time > 0.52) & (time < 0.56)
    away = pose + noise + np.where(swapped[:, None], [0.02, 0.01, 0.3], 0.0)
    assert not np.any(without_outliers(time, Track(away, np.ones(len(time), bool))).valid[swapped])


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            lambda s: replace(s, position_m=np.where(np.arange(COUNT)[:, None] == 7, np.nan, s.position_m)),
            "frame 7 is not",
        ),
        (lambda s: replace(s, quaternion_xyzw=2.0 * s.quaternion_xyzw), "has size 2, must be 1"),
        (lambda s: replace(s, sequence=s.sequence[::-1]), "frame numbers go back after frame 59"),
        (lambda s: replace(s, position_m=s.position_m[:-1]), "hand poses: positions and quaternions must be"),
    ],
)
def test_poses_that_cannot_be(change, message):
    with pytest.raises(InputError, match=message):
        to_plane("hand", change(series(TURNING)), PLANE)


def test_too_few_frames():
    with pytest.raises(EstimationError, match="object tracked in 1 of 60 frames"):
        aligned(np.arange(COUNT), np.array([5]))


def test_poses_of_frames_that_were_not_recorded():
    hand = to_plane("hand", series(TURNING), PLANE)
    recorded = frames(np.arange(COUNT), np.arange(COUNT))
    late = replace(recorded, frame=recorded.frame + 1)
    with pytest.raises(InputError, match="hand poses: frame 0 is not among"):
        align(late, recorded.ticks, hand, hand, 0.0)


def test_camera_ticks_that_go_back():
    hand = to_plane("hand", series(TURNING), PLANE)
    recorded = frames(np.arange(COUNT), np.arange(COUNT))
    with pytest.raises(InputError, match="camera frames: ticks goes back after frame 0"):
        align(replace(recorded, ticks=recorded.ticks[::-1]), recorded.ticks, hand, hand, 0.0)
