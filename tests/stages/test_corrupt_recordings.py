"""Recordings that are spoilt in every way that occurs: each is told in one line, and nothing is written."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

from slidepipe.artifacts import topics
from slidepipe.artifacts.recording import RecordingWriter, Series, read_recording, write_series
from slidepipe.cli.main import cli

RECORDED = Path(__file__).resolve().parents[2] / "data" / "recorded" / "linear-3800-seed103" / "trial.mcap"


@pytest.fixture(scope="module")
def sound() -> tuple[dict, Series]:
    """A recorded trial as plain series, with its provenance and attachments."""
    recording = read_recording(RECORDED)
    names = ("plan.yaml", "experiment.yaml")
    rest = {
        "metadata": recording.metadata["slidepipe.run"],
        "attachments": {name: recording.attachment(name) for name in names},
    }
    joints = {topic: recording.joints(topic) for topic in (topics.COMMANDED, topics.MEASURED)}
    return rest, Series(mocap=recording.mocap(), joints=joints, events=recording.events())


@pytest.fixture
def told(sound: tuple[dict, Series], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Result]:
    """Spoil the recording, and estimate it from the command line."""

    def attempt(spoil: Callable[[Series], Series]) -> Result:
        monkeypatch.chdir(tmp_path)
        rest, series = sound
        # Ours refuses what is not a number; another recorder may not.
        monkeypatch.setattr(RecordingWriter, "_finite", lambda _self, _topic, values: [float(one) for one in values])
        with RecordingWriter(tmp_path / "bad.mcap", rest["metadata"], rest["attachments"]) as writer:
            write_series(writer, spoil(series))
        result = CliRunner().invoke(cli, ["estimate", "bad.mcap"])
        assert sorted(path.name for path in tmp_path.iterdir()) == ["bad.mcap"]
        return result

    return attempt


def with_mocap(**changes: object) -> Callable[[Series], Series]:
    def spoil(series: Series) -> Series:
        made = {name: change(series.mocap) if callable(change) else change for name, change in changes.items()}
        return replace(series, mocap=replace(series.mocap, **made))

    return spoil


def rows(series, keep):
    return replace(series, **{name: getattr(series, name)[keep] for name in series.__slots__})


def none_seen(*bodies: str):
    def frames(mocap):
        blind = np.zeros(len(mocap.frames.frame), dtype=bool)
        return replace(mocap.frames, **{f"{body}_valid": blind for body in bodies})

    nothing = slice(0, 0)
    poses = {body: (lambda mocap, body=body: rows(getattr(mocap, body), nothing)) for body in bodies}
    return with_mocap(frames=frames, **poses)


def one_frame(series: Series) -> Series:
    mocap = series.mocap
    frame = mocap.frames.frame[50]
    kept = {body: rows(getattr(mocap, body), getattr(mocap, body).sequence == frame) for body in ("hand", "object")}
    return replace(series, mocap=replace(mocap, frames=rows(mocap.frames, mocap.frames.frame == frame), **kept))


def not_a_number(series: Series) -> Series:
    position = series.mocap.object.position_m.copy()
    position[100, 1] = np.nan
    return replace(series, mocap=replace(series.mocap, object=replace(series.mocap.object, position_m=position)))


def frozen(series: Series) -> Series:
    """The last pose that was seen, sent over and over as if it were seen."""
    position, turn = series.mocap.object.position_m.copy(), series.mocap.object.quaternion_xyzw.copy()
    position[200:], turn[200:] = position[200], turn[200]
    body = replace(series.mocap.object, position_m=position, quaternion_xyzw=turn)
    return replace(series, mocap=replace(series.mocap, object=body))


def no_turn(series: Series) -> Series:
    turn = series.mocap.object.quaternion_xyzw.copy()
    turn[50] = 0.0
    return replace(series, mocap=replace(series.mocap, object=replace(series.mocap.object, quaternion_xyzw=turn)))


def no_angle(series: Series) -> Series:
    joints = series.joints[topics.MEASURED]
    position = joints.position_rad.copy()
    position[100, 1] = np.nan
    return replace(series, joints=series.joints | {topics.MEASURED: replace(joints, position_rad=position)})


def backwards(mocap):
    ticks = mocap.frames.ticks.copy()
    ticks[200:] -= 10_000_000
    return replace(mocap.frames, ticks=ticks)


def joints_back(series: Series) -> Series:
    joints = series.joints[topics.MEASURED]
    stamps = joints.stamp_ns.copy()
    stamps[600:] -= 500_000_000
    return replace(series, joints=series.joints | {topics.MEASURED: replace(joints, stamp_ns=stamps)})


def other_body(series: Series) -> Series:
    """The hand's markers under the object's name."""
    mocap = series.mocap
    frames = replace(mocap.frames, object_valid=mocap.frames.hand_valid)
    return replace(series, mocap=replace(mocap, object=mocap.hand, frames=frames))


@pytest.mark.parametrize(
    ("spoil", "code", "message"),
    [
        (none_seen("object"), 1, "poses: object tracked in 0 of"),
        (none_seen("hand", "object"), 1, "poses: hand tracked in 0 of"),
        (one_frame, 1, "poses: 1 camera frames were recorded, at least 30 are needed"),
        (not_a_number, 3, "object poses: position_m of frame"),
        (frozen, 3, "frames during the motion repeat the pose before to the last bit"),
        (no_turn, 3, "object poses: quaternion_xyzw of frame 50 has size 0, must be 1"),
        (lambda series: replace(series, events=()), 3, "does not say when the motion starts"),
        (no_angle, 3, "/joints/measured: an angle of state 100 is not finite"),
        (with_mocap(frames=backwards), 3, "camera frames: ticks goes back after frame"),
        (joints_back, 3, "joints: the clock goes back after state"),
        (other_body, 3, "the cameras tracked another body"),
        (lambda series: replace(series, joints={}), 3, "has no topic /joints/measured"),
        (lambda series: replace(series, mocap=None), 3, "has no topic /mocap/frame"),
    ],
    ids=lambda value: getattr(value, "__name__", None),
)
def test_is_told_in_a_line_and_nothing_is_written(told: Callable, spoil: Callable, code: int, message: str) -> None:
    result = told(spoil)
    assert (result.exit_code, result.stdout) == (code, "")
    assert len(result.stderr.splitlines()) == 1
    assert message in result.stderr


def test_the_sound_recording_is_estimated(sound: tuple[dict, Series], tmp_path: Path) -> None:
    rest, series = sound
    with RecordingWriter(tmp_path / "good.mcap", rest["metadata"], rest["attachments"]) as writer:
        write_series(writer, series)
    result = CliRunner().invoke(cli, ["--data", str(tmp_path / "data"), "estimate", str(tmp_path / "good.mcap")])
    assert result.exit_code == 0, result.stderr
