"""``slidepipe execute`` on a lab is killed at random moments, as a whole and in parts: what was recorded is kept.

The ordinary suite shoots a few times; more often with ``SLIDEPIPE_KILLS=20 python -m pytest -s
tests/stages/test_killed_executions.py``, which prints what each shot cost.
"""

import json
import os
import random
import signal
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import pytest
from click.testing import CliRunner, Result
from loopback import COARSE, PATIENCE_S, SLIDEPIPE, lab_file, serving, until

from slidepipe.artifacts import topics
from slidepipe.artifacts.manifest import RunState
from slidepipe.artifacts.recording import read_recording
from slidepipe.artifacts.run import Run
from slidepipe.artifacts.store import Store
from slidepipe.cli.main import cli
from slidepipe.lab.loop import MOTION_STARTS
from slidepipe.stages import plan

pytestmark = pytest.mark.realtime

KILLS = int(os.environ.get("SLIDEPIPE_KILLS", "2"))
LASTS_S = 4.0
"""About how long the arm is streamed to."""
LOST_NS = 300_000_000
"""A killed recorder may lose this much of the end, and no more."""


@dataclass(frozen=True)
class Scene:
    """A plan in a store of its own, and a directory in which everything temporary is made."""

    store: Store
    plan: str
    experiment: Path
    temporary: Path

    @property
    def drafts(self) -> list[Path]:
        """Recordings that are being made, or were."""
        return list(self.store.root.glob("runs/*/.tmp-*/trial.mcap"))


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory, experiments: Path) -> Scene:
    room = tmp_path_factory.mktemp("killed")
    (room / "tmp").mkdir()
    store, experiment = Store(room / "data"), experiments / "regrasp.yaml"
    return Scene(store, plan.run(plan.PlanRequest(experiment, store)).run.id, experiment, room / "tmp")


@dataclass(frozen=True)
class Shot:
    """An execution in a session of its own, that streams to a lab and can be shot at."""

    process: subprocess.Popen[str]

    @property
    def members(self) -> dict[int, str]:
        """Processes of the session by their number, each with its command line; those that are dead do not count."""
        found = {}
        for entry in Path("/proc").iterdir():
            try:
                fields = (entry / "stat").read_text().rpartition(")")[2].split()
                if int(fields[3]) == self.process.pid and fields[0] not in "ZX":
                    found[int(entry.name)] = (entry / "cmdline").read_text().replace("\0", " ")
            except (OSError, ValueError, IndexError):
                continue
        return found

    @property
    def recorder(self) -> int:
        """The recorder's process."""
        return next(pid for pid, line in self.members.items() if "recording_process" in line)

    @property
    def streamer(self) -> int:
        """The streamer's process."""
        return next(pid for pid, line in self.members.items() if "multiprocessing.spawn" in line)


@contextmanager
def executing(scene: Scene, lab: Path) -> Iterator[Shot]:
    """Execute on a lab; nothing may stay behind."""
    shared = shared_memory()
    process = subprocess.Popen(  # noqa: S603  # ourselves
        [*SLIDEPIPE, "--data", str(scene.store.root), "execute", scene.plan, "--lab", str(lab), "--yes"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        env=os.environ | {"OMP_NUM_THREADS": "1", "TMPDIR": str(scene.temporary)},
    )
    shot = Shot(process)
    try:
        yield shot
        until(lambda: not shot.members)
    finally:
        for pid in shot.members:
            os.kill(pid, signal.SIGKILL)
        process.communicate(timeout=PATIENCE_S)
    assert list(scene.temporary.iterdir()) == []
    assert {name for name in shared_memory() - shared if str(process.pid) in name} == set()


@contextmanager
def streaming(scene: Scene, directory: Path) -> Iterator[Shot]:
    """Execute on a lab that is played beside it, from the first tick that is recorded on."""
    lab = patient_lab(directory)
    with executing(scene, lab) as shot, serving(scene.experiment, lab, *COARSE):
        until(lambda: any(scene.drafts))
        (path,) = scene.drafts
        empty = path.stat().st_size
        until(lambda: path.stat().st_size > empty)
        yield shot
        until(lambda: not shot.members)


def patient_lab(directory: Path) -> Path:
    """A lab that is waited for as long as it takes to start it."""
    return lab_file(directory, **{"connect_s__5.0": "connect_s: 60.0"})


def shared_memory() -> set[str]:
    """Names of what processes of this machine share."""
    return {path.name for path in Path("/dev/shm").glob("*")}  # noqa: S108


def call(scene: Scene, *words: str) -> Result:
    """Call slidepipe as a person would."""
    return CliRunner().invoke(cli, ["--data", str(scene.store.root), *words], catch_exceptions=False)


def recovered(scene: Scene, last_ns: int) -> Run:
    """The run that ``ls`` tells of, after ``recover``: with all but the last moments before ``last_ns``."""
    (before,) = scene.store.abandoned()
    listed = json.loads(call(scene, "ls", "--json").stdout)["runs"]
    assert [one["state"] for one in listed if one["run"] == before.run_id] == ["interrupted"]
    result = call(scene, "recover")
    assert (result.exit_code, before.run_id in result.stdout) == (0, True), result.output
    run = scene.store.get(before.run_id)
    assert run.manifest.state is RunState.INTERRUPTED
    assert run.manifest.error is not None
    assert run.manifest.error.message == "its process was killed"
    assert [one.run for one in run.manifest.inputs] == [scene.plan] * 3
    recording = read_recording(run.file("recording"))
    assert recording.metadata["slidepipe.run"]["plan"] == scene.plan
    assert {"plan.yaml", "experiment.yaml", "lab.yaml"} <= set(recording.attachments)
    kept_ns = recording.log_ns(topics.COMMANDED)
    lost_ms = 1e-6 * max(0, last_ns - int(kept_ns[-1]))
    print(f"lost the last {lost_ms:.0f} ms of {len(kept_ns)} ticks")  # noqa: T201
    assert lost_ms <= 1e-6 * LOST_NS
    assert "interrupted" in call(scene, "show", run.id).stdout
    assert call(scene, "verify", run.id).exit_code == 0
    assert not list(scene.store.root.glob("runs/*/.*"))
    assert not list(run.directory.glob(".*"))
    return run


def at_some_time(shot: Shot, number: int, aim: Callable[[Shot], object]) -> int:
    """Shoot at a random moment, the same one every time; returns the time at which that was."""
    time.sleep(random.Random(number).uniform(0.0, LASTS_S))
    now_ns = time.time_ns()
    aim(shot)
    return now_ns


def test_what_is_killed_before_anything_is_recorded_is_told_all_the_same(scene: Scene, tmp_path: Path) -> None:
    with executing(scene, patient_lab(tmp_path)) as shot:
        until(lambda: any(scene.store.root.glob("runs/*/.tmp-*/.owner.yaml")))
        os.killpg(shot.process.pid, signal.SIGKILL)
    (before,) = scene.store.abandoned()
    assert call(scene, "recover").exit_code == 0
    run = scene.store.get(before.run_id)
    assert run.manifest.state is RunState.INTERRUPTED
    assert "recording" not in {output.role for output in run.manifest.outputs}
    assert call(scene, "verify", run.id).exit_code == 0
    assert not list(run.directory.glob(".*"))


@pytest.mark.parametrize("number", range(KILLS))
def test_the_whole_run_is_killed(scene: Scene, tmp_path: Path, number: int) -> None:
    with streaming(scene, tmp_path) as shot:
        last_ns = at_some_time(shot, number, lambda all_of: os.killpg(all_of.process.pid, signal.SIGKILL))
    recovered(scene, last_ns)


@pytest.mark.parametrize("number", range(max(1, KILLS // 4)))
def test_the_watching_process_is_killed_and_the_arm_stops_on_its_path(
    scene: Scene, tmp_path: Path, number: int
) -> None:
    with streaming(scene, tmp_path) as shot:
        last_ns = at_some_time(shot, number + 1, lambda one: one.process.kill())
    run = recovered(scene, last_ns)
    recording = read_recording(run.file("recording"))
    assert recording.metadata["slidepipe.end"]["state"] == "complete"
    assert "stopped: left alone: the process that watched is gone" in [one.message for one in recording.events()]


@pytest.mark.parametrize("number", range(max(1, KILLS // 4)))
def test_the_recorder_is_killed_and_the_trial_is_told_as_interrupted(scene: Scene, tmp_path: Path, number: int) -> None:
    with streaming(scene, tmp_path) as shot:
        at_some_time(shot, number, lambda one: os.kill(one.recorder, signal.SIGKILL))
        _, said = shot.process.communicate(timeout=PATIENCE_S)
    assert "invalid: the recorder has died (signal 9): this trial cannot be estimated" in said
    assert shot.process.returncode == 7
    assert scene.store.abandoned() == ()
    run = last_trial(scene)
    assert run.manifest.state is RunState.INTERRUPTED
    recording = read_recording(run.file("recording"))
    said_in_it = [one.message for one in recording.events()]
    assert {"the recorder has died (signal 9)", MOTION_STARTS} <= set(said_in_it)
    gaps_ns = recording.log_ns(topics.MEASURED)[1:] - recording.log_ns(topics.MEASURED)[:-1]
    print(f"lost at most {1e-6 * gaps_ns.max():.0f} ms in the middle")  # noqa: T201
    assert gaps_ns.max() <= LOST_NS


def test_the_streamer_is_killed_and_everything_that_it_said_is_kept(scene: Scene, tmp_path: Path) -> None:
    with streaming(scene, tmp_path) as shot:
        last_ns = at_some_time(shot, 3, lambda one: os.kill(one.streamer, signal.SIGKILL))
        _, said = shot.process.communicate(timeout=PATIENCE_S)
    assert (shot.process.returncode, "error: streamer: it has died" in said) == (7, True), said
    run = last_trial(scene)
    assert run.manifest.state is RunState.FAILED
    recording = read_recording(run.file("recording"))
    assert recording.metadata["slidepipe.end"]["state"] == "interrupted: the loop's process is gone"
    assert last_ns - recording.log_ns(topics.MEASURED)[-1] <= LOST_NS
    assert call(scene, "verify", run.id).exit_code == 0


def last_trial(scene: Scene) -> Run:
    return [run for run in scene.store.runs() if run.manifest.stage == "execute"][-1]
