"""Calibration on made motions whose frames are known."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from slidepipe.errors import EstimationError, InputError
from slidepipe.estimation.calibration import CalibrationRequest, calibrate, calibrated
from slidepipe.mechanics.planar import MotionPlane
from slidepipe.series import ClockSync, FloatArray, FrameSeries, MocapSeries, PoseSeries

PLANE = MotionPlane(np.array([0.4, -0.4, 0.5]), 0.7)
CAMERAS = (np.array([1.2, -0.3, 0.4]), Rotation.from_rotvec([1.2, -0.7, 2.0]))
MARKERS = (np.array([0.012, -0.021, 0.018]), Rotation.from_rotvec([0.3, -0.2, 0.8]))
TILT = Rotation.from_rotvec([0.02, -0.01, 0.0])
DELAY_S = 0.004
NOISE_M, NOISE_RAD = 0.0003, 0.003
TICKS_PER_S = 1e7


def path(time_s: FloatArray, turn_rad: float) -> FloatArray:
    """Planar poses of {f}: a swing, and a turn of so much."""
    swing = np.sin(2.0 * np.pi * time_s / 1.2)
    return np.column_stack([0.2 * swing, 0.15 * (1.0 - np.cos(2.0 * np.pi * time_s / 1.2)), turn_rad * (1 + swing) / 2])


def lifted(poses: FloatArray) -> tuple[FloatArray, Rotation]:
    position, matrix = PLANE.lift(poses)
    return position, Rotation.from_matrix(matrix)


def request(turn_rad: float = 2.0, seed: int = 0, *, dirty: bool = True) -> CalibrationRequest:
    random = np.random.default_rng(seed)
    frames_s = np.arange(0.1, 1.5, 1 / 360)
    joints_s = np.arange(0.0, 1.6, 0.002)
    place, turn = lifted(path(frames_s + DELAY_S, turn_rad))
    hand_m, hand_turn = place + turn.apply(MARKERS[0]), turn * MARKERS[1]
    count = len(frames_s)
    body = _seen(random, place, turn * TILT.inv())
    seen = np.sort(random.choice(count, count - 30, replace=False))
    hand = _seen(random, hand_m, hand_turn)
    if dirty:
        wrong = random.choice(count, count // 100, replace=False)
        hand.position_m[wrong] += random.normal(scale=0.05, size=(len(wrong), 3))
    valid = np.isin(np.arange(count), seen)
    ticks = np.round(frames_s * TICKS_PER_S).astype(np.int64)
    echoes = np.arange(0.0, 1.6, 0.02)
    sent = np.round(1e9 * echoes).astype(np.int64)
    clock = ClockSync(sent, np.round((echoes + 5e-4) * TICKS_PER_S).astype(np.int64), sent + 1_000_000, TICKS_PER_S)
    hand = PoseSeries(hand.stamp_ns[seen], hand.position_m[seen], hand.quaternion_xyzw[seen], hand.sequence[seen])
    received = np.round(1e9 * frames_s).astype(np.int64)
    mocap = MocapSeries(
        FrameSeries(np.arange(count), ticks, received, valid, np.ones(count, dtype=bool)), hand, body, clock
    )
    finger_m, finger_turn = lifted(path(joints_s, turn_rad))
    stamps = np.round(1e9 * joints_s).astype(np.int64)
    finger = PoseSeries(stamps, finger_m, finger_turn.as_quat(), np.arange(len(stamps)))
    return CalibrationRequest(mocap, finger, PLANE)


def _seen(random: np.random.Generator, place: FloatArray, turn: Rotation) -> PoseSeries:
    """What the cameras make of poses in the base frame."""
    noise = random.normal(size=(2, len(place), 3))
    back = CAMERAS[1].inv()
    turned = Rotation.from_rotvec(NOISE_RAD * noise[1]) * back * turn
    index = np.arange(len(place))
    return PoseSeries(index, back.apply(place - CAMERAS[0]) + NOISE_M * noise[0], turned.as_quat(), index)


def test_everything_is_found_within_its_standard_deviations() -> None:
    scores = []
    for seed in range(3):
        told = calibrate(request(seed=seed))
        base, hand = told.cameras_in_base, told.hand_markers
        away = (Rotation.from_rotvec(base.rotation_rad) * CAMERAS[1].inv()).as_rotvec()
        scores.append(
            [
                (base.position_m[2] - CAMERAS[0][2]) / base.position_std_m[2],
                *((hand.position_m - MARKERS[0]) / hand.position_std_m)[:2],
                (told.delay_s - DELAY_S) / told.delay_std_s,
            ]
        )
        assert np.linalg.norm(away) < 1e-3
        assert abs(hand.position_m[2] - MARKERS[0][2]) < 4.0 * hand.position_std_m[2]
        assert (Rotation.from_rotvec(hand.rotation_rad) * MARKERS[1].inv()).magnitude() < 1e-3
        assert hand.position_std_m[:2].max() < 5e-5
        assert 1e-3 < hand.position_std_m[2] < 5.1e-3
        assert told.down_in_cameras == pytest.approx(CAMERAS[1].inv().apply([0.0, 0.0, -1.0]), abs=1e-3)
        assert told.object_tilt_rad == pytest.approx(TILT.as_rotvec(), abs=1.5e-3)
        assert told.heading_rad == pytest.approx(PLANE.heading_rad, abs=4 * told.plane_std_rad)
        assert told.lean_rad == pytest.approx(0.0, abs=4 * told.plane_std_rad)
        assert told.plane_std_rad < 1e-3
        assert 2 <= told.outliers <= 12
        assert told.rms_m == pytest.approx(NOISE_M, rel=0.1)
        assert told.rms_rad == pytest.approx(NOISE_RAD, rel=0.1)
    assert np.abs(scores).max() < 3.5
    assert 0.6 < np.sqrt(np.mean(np.square(scores))) < 1.5


def test_a_hand_that_does_not_turn_is_refused() -> None:
    with pytest.raises(
        EstimationError,
        match=r"turned by 0.0 degrees only, which tells the finger's place on it to \d+.* mm, at most 0.5 mm are",
    ):
        calibrate(request(0.0))


def test_the_more_it_turns_the_better_it_tells() -> None:
    few, many = (calibrate(request(turn)).hand_markers.position_std_m[:2].max() for turn in (0.5, 2.5))
    assert 2.0 < few / many < 20.0


def test_calibrated_poses_are_the_finger_and_the_object_in_the_base() -> None:
    asked = request(dirty=False)
    seen = calibrated(asked.mocap, calibrate(asked))
    place, turn = lifted(path(np.arange(0.1, 1.5, 1 / 360) + DELAY_S, 2.0))
    for body, rows in ((seen.hand, seen.hand.sequence), (seen.object, seen.object.sequence)):
        off = np.abs((body.position_m - place[rows]) @ PLANE.axes)
        assert np.median(off[:, :2]) < 4e-4
        assert (Rotation.from_quat(body.quaternion_xyzw) * turn[rows].inv()).magnitude().mean() < 0.008


def test_an_object_that_is_not_there_has_no_tilt() -> None:
    asked = request()
    none = PoseSeries(np.zeros(0, int), np.zeros((0, 3)), np.zeros((0, 4)), np.zeros(0, int))
    told = calibrate(replace(asked, mocap=replace(asked.mocap, object=none)))
    assert told.object_tilt_rad is None
    assert told.hand_markers.position_m[:2] == pytest.approx(MARKERS[0][:2], abs=2e-4)


def test_joints_of_another_motion_are_refused() -> None:
    asked, other = request(), request()
    shifted = replace(other.finger, position_m=other.finger.position_m[::-1])
    with pytest.raises(EstimationError, match="joints and cameras do not fit"):
        calibrate(replace(asked, finger=shifted))


def test_what_is_missing_is_said() -> None:
    asked = request()
    short = PoseSeries(*(getattr(asked.finger, name)[:20] for name in
                         ("stamp_ns", "position_m", "quaternion_xyzw", "sequence")))  # fmt: skip
    with pytest.raises(InputError, match="joints' stamps must increase and be 50 at least, got 20"):
        calibrate(replace(asked, finger=short))
    late = replace(asked.finger, stamp_ns=asked.finger.stamp_ns + 10**10)
    with pytest.raises(EstimationError, match="tracked in 0 frames while the joints were recorded, at least 50"):
        calibrate(replace(asked, finger=late))
