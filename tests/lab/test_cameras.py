"""The simulated cameras do to the truth what their settings say, and no more."""

import dataclasses

import numpy as np
import pytest
from lab_setups import CAMERAS
from scipy.spatial.transform import Rotation

from slidepipe.errors import InputError
from slidepipe.lab.cameras import Cameras, CameraSettings, Offset
from slidepipe.lab.protocols import MocapFrame

FRAMES = 4000
CENTRE = np.array([0.4, -0.4, 0.5])
HAND = (np.array([0.5, -0.3, 0.6]), Rotation.from_rotvec([0.3, -1.0, 2.0]).as_matrix())
BLOCK = (np.array([0.52, -0.31, 0.58]), Rotation.from_rotvec([1.0, 0.5, -0.7]).as_matrix())


def watch(seed: int = 0, count: int = FRAMES, **changes: object) -> list[MocapFrame]:
    """Frames of a hand and a block at rest."""
    settings = dataclasses.replace(CAMERAS, **changes)
    cameras = Cameras(settings, CENTRE, np.random.default_rng(seed))
    return [cameras.expose(number, number / 360.0, HAND, BLOCK) for number in range(count)]


@pytest.fixture(scope="module")
def frames() -> list[MocapFrame]:
    return watch()


@pytest.mark.parametrize(("body", "truth"), [("hand", HAND), ("object", BLOCK)])
def test_the_noise_is_as_strong_as_was_asked_on_every_axis(
    frames: list[MocapFrame], body: str, truth: tuple[np.ndarray, np.ndarray]
) -> None:
    seen = [getattr(frame, body) for frame in frames if getattr(frame, body)]
    off_m = np.array([pose.position_m for pose in seen]) - truth[0]
    turns = Rotation.from_quat([pose.quaternion_xyzw for pose in seen]) * Rotation.from_matrix(truth[1]).inv()
    for off, deviation in ((off_m, 0.0003), (turns.as_rotvec(), 0.003)):
        np.testing.assert_allclose(off.std(axis=0), deviation, rtol=0.06)
        np.testing.assert_allclose(off.mean(axis=0), 0.0, atol=4 * deviation / np.sqrt(FRAMES))
        np.testing.assert_allclose(np.corrcoef(off.T), np.eye(3), atol=0.07)
    assert np.linalg.norm([pose.quaternion_xyzw for pose in seen], axis=1) == pytest.approx(1.0, abs=1e-6)


def test_cameras_without_noise_show_the_truth_in_single_precision() -> None:
    frame = watch(count=1, position_noise_m=0.0, angle_noise_rad=0.0, dropout_share=0.0)[0]
    assert frame.hand is not None
    np.testing.assert_array_equal(frame.hand.position_m, HAND[0].astype(np.float32))
    seen = Rotation.from_quat(frame.hand.quaternion_xyzw).as_matrix()
    np.testing.assert_allclose(seen, HAND[1], atol=3e-7)


def test_cameras_of_another_frame_track_markers_beside_the_bodies() -> None:
    frame = Offset(np.array([1.0, 2.0, 3.0]), np.array([0.4, -0.3, 1.1]))
    markers = Offset(np.array([0.01, -0.02, 0.03]), np.array([0.2, 0.1, -0.5]))
    seen = watch(
        count=1, position_noise_m=0.0, angle_noise_rad=0.0, dropout_share=0.0, frame=frame, hand_markers=markers
    )[0]
    to_base = Rotation.from_rotvec(frame.rotation_rad)
    hand, block = seen.hand, seen.object
    np.testing.assert_allclose(
        to_base.apply(hand.position_m) + frame.position_m, HAND[0] + HAND[1] @ markers.position_m, atol=1e-6
    )
    expected = HAND[1] @ Rotation.from_rotvec(markers.rotation_rad).as_matrix()
    np.testing.assert_allclose((to_base * Rotation.from_quat(hand.quaternion_xyzw)).as_matrix(), expected, atol=1e-6)
    np.testing.assert_allclose(to_base.apply(block.position_m) + frame.position_m, BLOCK[0], atol=1e-6)


@pytest.mark.parametrize("share", [0.02, 0.3])
def test_each_body_is_lost_by_itself_in_the_share_that_was_asked(share: float) -> None:
    lost = np.array([[f.hand is None, f.object is None] for f in watch(dropout_share=share)])
    spread = np.sqrt(share * (1 - share) / FRAMES)
    np.testing.assert_allclose(lost.mean(axis=0), share, atol=4 * spread)
    both = share**2
    assert lost.all(axis=1).mean() == pytest.approx(both, abs=4 * np.sqrt(both / FRAMES))


def test_nothing_is_lost_where_no_dropout_is_asked() -> None:
    assert all(frame.hand and frame.object for frame in watch(dropout_share=0.0))


def test_a_body_out_of_the_captured_volume_is_not_seen() -> None:
    cameras = Cameras(dataclasses.replace(CAMERAS, dropout_share=0.0), CENTRE, np.random.default_rng(0))
    for distance, seen in ((1.49, True), (1.51, False), (100.0, False)):
        frame = cameras.expose(0, 0.0, HAND, (CENTRE + np.array([0.0, 0.0, distance]), np.eye(3)))
        assert (frame.object is not None) is seen
        assert frame.hand is not None


def test_the_cameras_clock_is_set_apart_and_drifts() -> None:
    cameras = Cameras(CAMERAS, CENTRE, np.random.default_rng(0))
    assert cameras.ticks(0.0) == 123_000_000
    assert cameras.ticks(100.0) - cameras.ticks(0.0) == 1_000_000_000 + 20_000
    frames = watch(count=720)
    assert [f.ticks for f in frames[::360]] == [cameras.ticks(0.0), cameras.ticks(1.0)]


def test_frames_are_late_by_at_least_the_latency_and_by_its_jitter_more(frames: list[MocapFrame]) -> None:
    late_s = np.array([frame.received_ns * 1e-9 - frame.frame / 360.0 for frame in frames]) - 0.006
    assert late_s.min() >= -1e-9
    assert late_s.mean() == pytest.approx(0.0004, rel=0.08)
    assert late_s.max() > 0.002, "the jitter has a tail"


def test_frames_come_in_order_however_late_one_is() -> None:
    frames = watch(latency_jitter_s=0.01)
    received = np.array([frame.received_ns for frame in frames])
    assert np.all(np.diff(received) > 0)
    assert [frame.frame for frame in frames] == list(range(FRAMES))
    unordered = np.array([frame.received_ns * 1e-9 - frame.frame / 360.0 for frame in frames])
    assert unordered.mean() > 0.016, "a late frame holds up those behind it"


def test_an_echo_takes_its_time_and_its_two_ways_differ() -> None:
    cameras = Cameras(CAMERAS, CENTRE, np.random.default_rng(0))
    sent_s = np.arange(2000) * 0.1
    echoes = [cameras.echo(t) for t in sent_s]
    np.testing.assert_array_equal([echo.sent_ns for echo in echoes], np.round(1e9 * sent_s))
    answered_s = (np.array([echo.ticks for echo in echoes]) / 1e7 - 12.3) / (1 + 20e-6)
    there = answered_s - sent_s
    back = np.array([echo.received_ns for echo in echoes]) * 1e-9 - answered_s
    for way in (there, back):
        assert way.min() > 0.00045 - 2e-7
        assert way.min() < 0.00045 + 2e-6
        assert way.mean() == pytest.approx(0.0005, rel=0.02)
    assert abs(np.corrcoef(there, back)[0, 1]) < 0.1
    asymmetry = (there - back) / 2
    assert asymmetry.std() == pytest.approx(5e-5 / np.sqrt(2), rel=0.1)


def test_the_same_generator_sees_the_same_and_another_does_not() -> None:
    first, again, other = (watch(seed, count=50) for seed in (1, 1, 2))
    assert [repr(frame) for frame in first] == [repr(frame) for frame in again]
    assert all(a.received_ns != b.received_ns for a, b in zip(first, other, strict=True))


@pytest.mark.parametrize("rate_hz", [0.0, -360.0, np.nan])
def test_cameras_have_a_rate(rate_hz: float) -> None:
    with pytest.raises(InputError, match=r"^cameras: rate_hz must be positive, got "):
        CameraSettings(**(dataclasses.asdict(CAMERAS) | {"rate_hz": rate_hz}))
