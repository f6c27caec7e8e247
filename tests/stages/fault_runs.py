"""One execution against a played laboratory with a fault, over real sockets, in processes of their own.

A worker that has loaded everything once forks the laboratory and the streamer, so that a trial costs little more than
the seconds that it lasts.
"""

import os
import signal
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path

from fault_evidence import Seen, look_at
from loopback import COARSE, PATIENCE_S, kept_time, lab_file

from slidepipe.artifacts.manifest import RunState
from slidepipe.artifacts.recording import read_recording
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.trial import TrialDocument
from slidepipe.errors import SlidepipeError
from slidepipe.lab import realtime
from slidepipe.lab.faults import Fault
from slidepipe.stages import estimate, execute, serve, watch
from slidepipe.stages.on_lab import RealLab


@dataclass(frozen=True)
class Job:
    """What to execute, with which fault, in which directory, and where the arm rests before."""

    store: Path
    plan: str
    experiment: Path
    directory: Path
    home_rad: tuple[float, ...]
    fault: Fault | None


@dataclass(frozen=True)
class Done:
    """What became of one execution.

    Attributes
    ----------
    trial, state : TrialDocument, RunState
    seen : Seen
        What its recording says.
    landed, told : tuple of three floats
        Where the finger is on the block in truth, and by the estimate; None where that says that it is nowhere.
    refused : str
        Why it cannot be estimated.
    late : str, optional
        Why it shows nothing: the machine did not keep time.
    took_s : float
        From connecting to the end.
    """

    trial: TrialDocument
    state: RunState
    seen: Seen
    landed: tuple[float, ...]
    told: tuple[float, ...] | None
    refused: str
    late: str | None
    took_s: float


def play(job: Job) -> Done:
    """Execute once."""
    watch.get_context = lambda _: get_context("fork")  # type: ignore[assignment]  # everything is loaded already
    realtime._lock_memory = lambda: None  # a fork that locks its memory copies all of it
    store, begun = Store(job.store), time.monotonic()
    lab = lab_file(job.directory, **changes(job.home_rad))
    with served(job, lab) as ended:
        done = execute.run(
            execute.ExecuteRequest(job.plan, store, lab=RealLab(str(lab), lambda _: True, None, lambda _: None))
        )
        report = ended()
    took_s = time.monotonic() - begun
    told, refused = None, ""
    try:
        found = estimate.run(estimate.EstimateRequest(done.run.id, store)).document.final_relative_pose
        told = None if found is None else (found.x_m, found.y_m, found.theta_rad)
    except SlidepipeError as error:
        refused = str(error)
    seen = look_at(read_recording(done.run.file("recording")))
    late = kept_time(done.document, report.late_max_s)
    return Done(done.document, done.run.manifest.state, seen, report.relative_pose, told, refused, late, took_s)


def changes(home_rad: tuple[float, ...]) -> dict[str, str]:
    """The loopback lab with the arm at the motion's start, and brisk on the way back."""
    home = "[1.074, -0.6465, -1.4607, 1.6552, 0.9373, 0.1582, 0.1967]"
    brisk = {"speed_rad_s__[0.5": "speed_rad_s: [2.0", "acceleration_rad_s2__[1.5": "acceleration_rad_s2: [6.0"}
    return brisk | {
        f"home_pose_rad__{home}": f"home_pose_rad: {list(home_rad)}",
        "jerk_rad_s3__[10.0": "jerk_rad_s3: [120.0",
        "connect_s__5.0": "connect_s: 30.0",
        "hold_s__0.5}": "hold_s: 0.2}",
        "hold_s__0.3}": "hold_s: 0.0}",
    }


@contextmanager
def served(job: Job, lab: Path) -> Iterator[Callable[[], serve.ServeResult]]:
    """Play the laboratory; gives a function that ends it and returns its report."""
    context = get_context("fork")
    ours, theirs = context.Pipe()
    process = context.Process(target=_serve, args=(job, lab, theirs))
    process.start()
    theirs.close()
    try:
        assert ours.poll(PATIENCE_S)
        assert ours.recv() == "ready"

        def end() -> serve.ServeResult:
            os.kill(process.pid, signal.SIGTERM)
            assert ours.poll(PATIENCE_S)
            return ours.recv()

        yield end
    finally:
        process.kill()
        process.join()


def _serve(job: Job, lab: Path, pipe: Connection) -> None:
    enough = []
    signal.signal(signal.SIGTERM, lambda *_: enough.append(True))
    request = serve.ServeRequest(
        experiment=job.experiment,
        lab=str(lab),
        stop=lambda: bool(enough),
        ready=lambda _: pipe.send("ready"),
        overrides=tuple(COARSE[1::2]),
        faults=() if job.fault is None else (job.fault,),
    )
    pipe.send(serve.run(request))
