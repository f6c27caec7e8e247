"""The recorder as a process: it finishes, survives the loop, and dies without hurting it.

The ordinary suite kills it a few times; more often with ``SLIDEPIPE_KILLS=20 python -m pytest
tests/stages/test_recording_process.py``.
"""

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import recording_by_hand
from recording_by_hand import ATTACHMENTS

from slidepipe.artifacts import topics
from slidepipe.artifacts.manifest import RunState
from slidepipe.artifacts.mcap_scan import scan
from slidepipe.artifacts.recording import read_recording
from slidepipe.artifacts.store import Store
from slidepipe.errors import BusyError, InputError, LabError
from slidepipe.lab.protocols import JointCommand, JointState
from slidepipe.series import StreamStatistics
from slidepipe.stages import recover
from slidepipe.stages.recording_process import RecordingProcess, RecordingSetup

pytestmark = pytest.mark.realtime

KILLS = int(os.environ.get("SLIDEPIPE_KILLS", "5"))
LOST_NS = 300_000_000
"""A killed recorder may lose this much of the end, and no more."""


def setup(path: Path) -> RecordingSetup:
    return RecordingSetup(path, {"run": "a"}, ATTACHMENTS, 1e7)


def test_everything_that_was_said_is_in_the_file(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    with RecordingProcess(setup(path)) as process:
        begun = read_without_end(path)
        assert begun == {"plan.yaml", "experiment.yaml"}, "provenance is there before the first record"
        for number in range(300):
            recording_by_hand.say(process, number, 10**18 + number * 2_000_000)
        process.recorder.event(10**18, "motion starts")
        process.recorder.statistics(StreamStatistics(10**18, 300, 2))
        assert process.fault is None
    report = process.close()
    assert (report.lost, report.fault) == ({}, None)
    recording = read_recording(path)
    assert recording.metadata["slidepipe.run"] == {"run": "a"}
    assert recording.metadata["slidepipe.end"]["state"] == "complete"
    assert recording.attachment("plan.yaml") == ATTACHMENTS["plan.yaml"]
    expected = np.array([np.random.default_rng(number).normal(size=(6, 7)) for number in range(300)])
    np.testing.assert_array_equal(recording.joints(topics.COMMANDED).position_rad, expected[:, 0])
    np.testing.assert_array_equal(recording.joints(topics.MEASURED).effort_n_m, expected[:, 5])
    assert recording.mocap().frames.frame.tolist() == list(range(300))
    assert len(recording.mocap().clock.ticks) == 6
    assert [event.message for event in recording.events()] == ["motion starts"]
    assert recording.ticks().late_ns.tolist() == [1000] * 300
    assert recording.statistics() == [StreamStatistics(10**18, 300, 2)]


def read_without_end(path: Path) -> set[str]:
    return set(scan(path.read_bytes()).attachments)


def test_overflow_is_told_in_the_report_and_in_the_file(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    with RecordingProcess(setup(path), slots=16) as process:
        os.kill(process.pid, signal.SIGSTOP)
        for number in range(30):
            process.recorder.tick(number, 0)
        assert process.lost == 14
        assert process.fault == "14 records were lost: the recorder is too slow"
        os.kill(process.pid, signal.SIGCONT)
    assert process.close().lost == {"tick": 14}
    recording = read_recording(path)
    assert len(recording.ticks().late_ns) == 16
    (event,) = recording.events()
    assert (event.level, event.message) == ("error", "14 records were lost: the ring was full")


def test_a_record_that_is_not_finite_is_told_and_hurts_no_other(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    numbers = np.zeros((6, 7))
    numbers[5, 2] = np.nan
    with RecordingProcess(setup(path)) as process:
        recording_by_hand.say(process, 0, 10**9)
        process.recorder.joints(JointCommand(*numbers[:3]), JointState(2 * 10**9, *numbers[3:]))
        recording_by_hand.say(process, 1, 3 * 10**9)
    assert process.close().fault is None
    recording = read_recording(path)
    assert recording.joints(topics.MEASURED).stamp_ns.tolist() == [10**9, 3 * 10**9]
    (event,) = recording.events()
    assert event.level == "error"
    assert event.message.startswith(f"not recorded: {path}: /joints/measured: numbers must be finite")


def test_a_recorder_that_cannot_begin_says_why(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    path.touch()
    with pytest.raises(LabError, match=rf"^recorder: {path}: cannot be recorded to: File exists$"):
        RecordingProcess(setup(path)).__enter__()


def test_the_loop_survives_the_recorder_and_writes_the_rest_itself(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    with RecordingProcess(setup(path)) as process:
        for number in range(500):
            recording_by_hand.say(process, number, 10**18 + number * 2_000_000)
        while process.waiting:
            time.sleep(0.001)
        os.kill(process.pid, signal.SIGKILL)
        while process.fault is None:
            time.sleep(0.001)
        assert process.fault == "the recorder has died (signal 9)"
        for number in range(500, 900):
            recording_by_hand.say(process, number, 10**18 + number * 2_000_000)
    report = process.close()
    assert (report.lost, report.fault) == ({}, "the recorder has died (signal 9)")
    recording = read_recording(path)
    assert recording.metadata["slidepipe.end"]["state"].startswith("recovered: byte ")
    frames = recording.mocap().frames.frame
    assert frames[-400:].tolist() == list(range(500, 900))
    assert len(frames) >= 900 - 0.3 * 500
    assert "the recorder has died (signal 9)" in [event.message for event in recording.events()]


def test_what_a_dead_recorder_left_no_room_for_is_counted(tmp_path: Path) -> None:
    with RecordingProcess(setup(tmp_path / "a.mcap"), slots=64) as process:
        os.kill(process.pid, signal.SIGKILL)
        for number in range(100):
            process.recorder.tick(number, 0)
    assert process.close().lost == {"tick": 36}


def test_ctrl_c_does_not_end_the_recorder(tmp_path: Path) -> None:
    with RecordingProcess(setup(tmp_path / "a.mcap")) as process:
        for one in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            os.kill(process.pid, one)
        recording_by_hand.say(process, 0, 1)
    assert process.close().fault is None
    assert read_recording(tmp_path / "a.mcap").metadata["slidepipe.end"]["state"] == "complete"


class Trial:
    """A loop in a process of its own, with its recorder, at which a test can shoot."""

    def __init__(self, store: Store, lasts_s: float = 30.0) -> None:
        command = [sys.executable, recording_by_hand.__file__, str(store.root), str(lasts_s)]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)  # noqa: S603
        self.recorder = int(self.process.stdout.readline())

    def last_ns(self) -> int:
        """Stop reading when the loop is gone; returns when it last recorded something."""
        out, _ = self.process.communicate()
        return int([line for line in out.splitlines() if len(line) > 15][-1])

    def gone(self) -> None:
        """Wait until the recorder is gone as well."""
        deadline = time.monotonic() + 20
        while (
            Path(f"/proc/{self.recorder}/stat").exists()
            and " Z " not in Path(f"/proc/{self.recorder}/stat").read_text()
        ):
            assert time.monotonic() < deadline
            time.sleep(0.005)


def recovered(store: Store, last_ns: int) -> None:
    """What every recording must be after ``recover``."""
    (before,) = store.abandoned()
    assert before.as_run().manifest.state is RunState.INTERRUPTED
    (found,) = recover.run(recover.RecoverRequest(None, store))
    assert store.abandoned() == ()
    run = store.get(found.run.id)
    assert run.manifest.state is RunState.INTERRUPTED
    assert run.manifest.seed == 7
    assert run.manifest.parameters == {"a": 1}
    assert run.manifest.error.message == "its process was killed"
    recording = read_recording(run.file("recording"))
    assert recording.metadata["slidepipe.run"] == {"run": run.id, "experiment": "a"}
    assert {name: recording.attachment(name) for name in ATTACHMENTS} == ATTACHMENTS
    kept_ns = int(recording.log_ns(topics.MEASURED)[-1])
    lost_ns = last_ns - kept_ns
    print(f"lost the last {1e-6 * lost_ns:.0f} ms")  # noqa: T201
    assert lost_ns <= LOST_NS
    ticks = recording.joints(topics.MEASURED).stamp_ns
    assert len(recording.mocap().frames.frame) in range(len(ticks) - 1, len(ticks) + 2)


@pytest.mark.parametrize("number", range(KILLS))
def test_everything_is_killed_at_a_random_moment(store: Store, number: int) -> None:
    chance = random.Random(number)  # the same moments every time
    trial = Trial(store)
    time.sleep(chance.uniform(0.02, 1.5))
    os.kill(trial.recorder, signal.SIGKILL)
    trial.process.kill()
    recovered(store, trial.last_ns())


@pytest.mark.parametrize("number", range(max(1, KILLS // 3)))
def test_the_recorder_alone_is_killed_at_a_random_moment(store: Store, number: int) -> None:
    """The loop goes on, ends by itself and publishes; what is missing is less than the last moment before the shot."""
    trial = Trial(store, lasts_s=1.5)
    time.sleep(random.Random(number).uniform(0.02, 1.0))  # as above
    os.kill(trial.recorder, signal.SIGKILL)
    out, err = trial.process.communicate()
    assert err == "the recorder has died (signal 9)\n"
    said = [int(line) for line in out.splitlines()]
    (run,) = store.runs()
    assert run.manifest.state is RunState.INTERRUPTED
    assert run.manifest.error.message == "the recorder has died (signal 9)"
    kept = read_recording(run.file("recording")).joints(topics.MEASURED).stamp_ns
    assert kept[-1] == said[-1]
    missing = sorted(set(said) - set(kept.tolist()))
    assert not missing or missing[-1] - missing[0] <= LOST_NS


@pytest.mark.parametrize("number", range(max(1, KILLS // 3)))
def test_the_loop_is_killed_and_the_recorder_finishes_the_file(store: Store, number: int) -> None:
    trial = Trial(store)
    time.sleep(0.3 + 0.1 * number)
    trial.process.kill()
    last_ns = trial.last_ns()
    trial.gone()
    (abandoned,) = store.abandoned()
    recording = read_recording(abandoned.staging / "trial.mcap")
    assert recording.metadata["slidepipe.end"]["state"] == "interrupted: the loop's process is gone"
    assert recording.log_ns(topics.MEASURED)[-1] >= last_ns, "nothing at all is lost"
    recovered(store, last_ns)


def test_a_trial_that_goes_on_is_not_recovered(store: Store) -> None:
    trial = Trial(store)
    assert store.abandoned() == ()
    assert recover.run(recover.RecoverRequest(None, store)) == ()
    (path,) = store.root.glob("runs/*/.tmp-*/trial.mcap")
    with pytest.raises(BusyError, match=r"trial\.mcap: is still being written$"):
        recover.run(recover.RecoverRequest(str(path), store))
    trial.process.kill()
    trial.process.communicate()
    trial.gone()


def test_a_file_without_provenance_cannot_be_recovered(tmp_path: Path, store: Store) -> None:
    path = tmp_path / "a.mcap"
    path.write_bytes(b"\x89MCAP0\r\n")
    with pytest.raises(InputError, match=r"it does not say where it comes from, and cannot be recovered$"):
        recover.run(recover.RecoverRequest(str(path), store))
