"""Execution in real time over loopback, against the laboratory in another process.

What only a machine that keeps time can show is tried again where it did not, and then skipped with the reason: it never
passes without having been shown.
"""

import re
import signal
import subprocess
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from loopback import PATIENCE_S, PATIENT, SLIDEPIPE, kept_time, lab_file, serving, until

from slidepipe.artifacts.manifest import RunState
from slidepipe.artifacts.recording import read_recording
from slidepipe.artifacts.run import Run
from slidepipe.artifacts.schema import parse
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.strict_yaml import load
from slidepipe.artifacts.trial import TrialDocument
from slidepipe.artifacts.values import Pose
from slidepipe.errors import EstimationError, InfeasibleError, LabError, RefusedError
from slidepipe.lab.course import Phase
from slidepipe.lab.desk import Progress
from slidepipe.lab.loop import MOTION_ENDS, MOTION_STARTS
from slidepipe.stages import estimate, execute, lab_check, plan
from slidepipe.stages.on_lab import RealLab

pytestmark = pytest.mark.realtime

ATTEMPTS = 3
STREAMING_BYTES = 100_000
"""A recording is so large after some tenths of a second of streaming."""


@dataclass
class Scene:
    """A plan in a store, and its experiment."""

    store: Store
    plan: plan.PlanResult
    experiment: Path


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory, experiments: Path) -> Scene:
    store = Store(tmp_path_factory.mktemp("loopback") / "data")
    experiment = experiments / "regrasp.yaml"
    return Scene(store, plan.run(plan.PlanRequest(experiment, store)), experiment)


def real(lab: Path, *, yes: bool = True) -> RealLab:
    return RealLab(str(lab), lambda _: yes, None, lambda _: None)


def test_the_demonstration_lands_as_in_virtual_time(scene: Scene, tmp_path: Path) -> None:
    virtual = execute.run(execute.ExecuteRequest(scene.plan.run.id, scene.store))
    assert virtual.truth is not None
    for left in reversed(range(ATTEMPTS)):
        lab = lab_file(tmp_path)
        with serving(scene.experiment, lab) as served:
            done = execute.run(execute.ExecuteRequest(scene.plan.run.id, scene.store, lab=real(lab)))
            excuse = kept_time(done.document, float(served.end()["late_max_s"]))
        try:
            landed_alike(scene, done, virtual.truth.final_relative_pose)
        except (AssertionError, EstimationError):
            if excuse is None:
                raise
            if not left:
                pytest.skip(f"this machine did not keep time in {ATTEMPTS} attempts: {excuse}")
        else:
            break
    recording = read_recording(done.run.file("recording"))
    assert [event.message for event in recording.events()][:2] == [MOTION_STARTS, MOTION_ENDS]
    assert recording.metadata["slidepipe.end"]["state"] == "complete"
    ticks = recording.ticks()
    assert done.document.stream is not None
    assert len(ticks.stamp_ns) == done.document.stream.ticks
    assert done.document.stream.records_lost == done.document.stream.frames_missing == 0


def landed_alike(scene: Scene, done: execute.ExecuteResult, wanted: Pose) -> None:
    """It ended within 2 mm of where it ended in virtual time."""
    assert done.document.stopped is None
    assert done.run.manifest.state is RunState.COMPLETE
    reached = estimate.run(estimate.EstimateRequest(done.run.id, scene.store)).document.final_relative_pose
    assert reached is not None
    apart_m = np.hypot(reached.x_m - wanted.x_m, reached.y_m - wanted.y_m)
    print(f"over loopback {1e3 * apart_m:.2f} mm from the virtual run")  # noqa: T201
    assert apart_m < 2e-3
    assert abs(reached.theta_rad - wanted.theta_rad) < 0.05


def test_ctrl_c_stops_along_the_path_and_keeps_the_trial(scene: Scene, tmp_path: Path) -> None:
    lab = lab_file(tmp_path, **PATIENT)
    command = [*SLIDEPIPE, "--data", str(scene.store.root), "execute", scene.plan.run.id, "--lab", str(lab), "--yes"]
    with serving(scene.experiment, lab):
        process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)  # noqa: S603  # ourselves
        until(lambda: recorded_bytes(scene) > STREAMING_BYTES)
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 130, said
    assert "stopped: Ctrl-C: a person asked for it" in said
    run = last_trial(scene)
    assert run.manifest.state is RunState.INTERRUPTED
    trial = parse(TrialDocument, load(run.file("trial")))
    assert trial.stopped == "Ctrl-C: a person asked for it"
    recording = read_recording(run.file("recording"))
    assert recording.metadata["slidepipe.end"]["state"] == "complete"
    if MOTION_ENDS not in [event.message for event in recording.events()]:
        with pytest.raises(EstimationError, match=r"the trial was stopped: Ctrl-C"):
            estimate.run(estimate.EstimateRequest(run.id, scene.store))


def test_a_laboratory_that_dies_ends_the_trial_in_time(scene: Scene, tmp_path: Path) -> None:
    lab = lab_file(tmp_path)
    with serving(scene.experiment, lab) as served:

        def die(progress: Progress) -> None:
            if progress.phase is Phase.APPROACH:
                served.process.kill()

        told = RealLab(str(lab), lambda _: True, None, die)
        done = execute.run(execute.ExecuteRequest(scene.plan.run.id, scene.store, lab=told))
    assert done.document.stopped is not None
    assert done.document.stopped.startswith("link lost: nothing heard of the arm for ")
    assert done.run.manifest.state is RunState.STOPPED
    recording = read_recording(done.run.file("recording"))
    assert recording.metadata["slidepipe.end"]["state"] == "complete"
    said = [event.message for event in recording.events()]
    assert f"stopped: {done.document.stopped}" in said
    stamps = recording.ticks().stamp_ns
    assert 1e-9 * (stamps[-1] - stamps[0]) < 10.0 + 0.9 + 0.8 + 5.0, "link, approach, stop, and a busy machine"


def last_trial(scene: Scene) -> Run:
    return [run for run in scene.store.runs() if run.manifest.stage == "execute"][-1]


def recorded_bytes(scene: Scene) -> int:
    """Size of a recording that is being made."""
    return max((path.stat().st_size for path in scene.store.root.glob("runs/*/.tmp-*/trial.mcap")), default=0)


def test_nobody_there_is_told_in_time_and_nothing_is_kept_waiting(scene: Scene, tmp_path: Path) -> None:
    lab = lab_file(tmp_path, **{"connect_s__5.0": "connect_s: 0.5"})
    begun = time.monotonic()
    with pytest.raises(LabError, match=r"^cameras at 127\.0\.0\.1:\d+: no answer|^arm: nothing heard of it for 0.5 s"):
        execute.run(execute.ExecuteRequest(scene.plan.run.id, scene.store, lab=real(lab)))
    assert time.monotonic() - begun < PATIENCE_S


def test_without_leave_nothing_moves_and_a_check_says_what_is_there(scene: Scene, tmp_path: Path) -> None:
    lab = lab_file(tmp_path)
    with serving(scene.experiment, lab) as served:
        with pytest.raises(RefusedError, match="nobody wanted the arm to move, and it did not"):
            execute.run(execute.ExecuteRequest(scene.plan.run.id, scene.store, lab=real(lab, yes=False)))
        found = lab_check.run(str(lab), 0.5)
        report = served.end()
    assert report["links"] == 0
    facts = {(fact.about, fact.name): fact.value for fact in found.facts}
    assert facts["arm", "link"] == "does not follow commands yet"
    assert facts["arm", "dialect"] == "bridge, 200 bytes a state"
    assert facts["cameras", "server"] == "slidepipe 1.0.0.0, NatNet 4.1"
    assert re.match(r"tracked in (9\d\.\d|100\.0) % of the frames", facts["cameras", "hand"])
    assert facts["cameras", "apart"].startswith("22.")


def test_a_check_of_nothing_tells_both(tmp_path: Path) -> None:
    found = lab_check.run(str(lab_file(tmp_path, **{"connect_s__5.0": "connect_s: 0.3"})), 0.1)
    assert not found.sound
    assert [(fact.about, fact.name) for fact in found.facts] == [("arm", "error"), ("cameras", "error")]


def test_a_plan_beyond_the_transports_clip_is_refused_before_anything_moves(scene: Scene, tmp_path: Path) -> None:
    clip = "torque_beyond_gravity_n_m: [25.0, 20.0, 15.0, 15.0, 5.0, 5.0, 5.0]  #"
    lab = lab_file(tmp_path, **{"torque_beyond_gravity_n_m__[77.3, 160.6, 95.6, 29.4, 11.6, 11.6, 2.7]": clip})
    with pytest.raises(
        InfeasibleError,
        match=r"^lab loopback: joint 2 torque beyond gravity \(clip of the bridge transport\): 53\.\d+ N m at "
        r"t = 0\.\d+ s, beyond 20 N m$",
    ):
        execute.run(execute.ExecuteRequest(scene.plan.run.id, scene.store, lab=real(lab)))
