"""The streamer: the loop, alone in a process of its own, and the talk with it from the process that a person watches.

The streamer connects, tells what it found, waits for leave, and streams. It ignores Ctrl-C, which the watching process
turns into a wish to stop; where that process is gone, it stops as well. Nothing is cut: the arm slows down on its path.
"""

import os
import signal
from collections.abc import Callable, Mapping
from contextlib import closing
from dataclasses import dataclass
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np

from slidepipe.errors import LabError, RefusedError, SlidepipeError
from slidepipe.lab.approach import there_and_back
from slidepipe.lab.clock import TICK_NS, Beat, RealClock
from slidepipe.lab.course import Course
from slidepipe.lab.desk import Progress, StreamDesk, WatchDesk, shared_words
from slidepipe.lab.link import LinkCounts, LinkedArm
from slidepipe.lab.loop import INVALID, Execution, Lab, run
from slidepipe.lab.natnet.client import ClientCounts, NatNetClient
from slidepipe.lab.protocols import MocapFrame
from slidepipe.lab.realtime import realtime
from slidepipe.lab.safety import Guard
from slidepipe.lab.transport import UdpTransport
from slidepipe.lab.wam_codec import CODECS
from slidepipe.series import FloatArray, IntArray, JointSeries, StreamStatistics
from slidepipe.stages.labs import LabSettings
from slidepipe.stages.recording_process import RecordingProcess, RecordingReport, RecordingSetup
from slidepipe.tick import TICK_S

GAP_SHARE = 0.8
"""A gap of more than this share of the driver's time-out makes a trial invalid."""
MARGIN_S = 30.0
"""How much longer than its course a streamer may take before it is given up."""
LOOK_S = 0.1


@dataclass(frozen=True, slots=True)
class StreamJob:
    """What to stream, to which lab, and what the recording begins with."""

    lab: LabSettings
    reference: JointSeries
    recording: Path
    provenance: Mapping[str, str]
    attachments: Mapping[str, bytes]


@dataclass(frozen=True, slots=True)
class Readiness:
    """What the streamer found before anything moves.

    Attributes
    ----------
    measured_rad : (7,)
        Where the arm is.
    course_s, approach_s : float
        How long everything takes, and the way to the start alone.
    tells_linked : bool
        Whether the arm's program says by itself that it follows.
    """

    measured_rad: FloatArray
    course_s: float
    approach_s: float
    tells_linked: bool


@dataclass(frozen=True, slots=True)
class StreamOutcome:
    """What became of it.

    Attributes
    ----------
    execution : Execution
    late_ns : (T,)
        Lateness of every tick.
    arm : LinkCounts
    cameras : ClientCounts
    recording : RecordingReport
    refused : tuple of str
        What the machine did not permit the streamer to keep time with.
    invalid : str, optional
        Why the trial must not be estimated.
    """

    execution: Execution
    late_ns: IntArray
    arm: LinkCounts
    cameras: ClientCounts
    recording: RecordingReport
    refused: tuple[str, ...]
    invalid: str | None


@dataclass(frozen=True, slots=True)
class Watch:
    """Who is asked before the arm moves, and told meanwhile.

    Attributes
    ----------
    confirm : Callable
        Whether the arm may move, given what was found.
    linked : Callable
        Returns when a person has linked the arm; called where its program does not tell, and nothing moves until then.
    progress : Callable
        Told ten times a second.
    """

    confirm: Callable[[Readiness], bool]
    linked: Callable[[Readiness], None]
    progress: Callable[[Progress], None]


def stream(job: StreamJob, watch: Watch) -> StreamOutcome:
    """Stream in a process of its own, and watch it.

    Raises
    ------
    LabError
        The arm or the cameras do not answer, do not see what they should, or the streamer failed.
    RefusedError
        A person did not want the arm to move.
    """
    context = get_context("spawn")
    words, (ours, theirs) = shared_words(context), context.Pipe()
    process = context.Process(target=_main, args=(job, words, theirs, os.getpid()), name="slidepipe-streamer")
    process.start()
    theirs.close()
    try:
        return _attend(ours, WatchDesk(words), watch)
    finally:
        WatchDesk(words).ask_to_stop()
        ours.close()
        process.join(job.lab.loop.stop_s + job.lab.loop.hold_s + MARGIN_S)
        if process.is_alive():
            process.kill()
            process.join()


def _attend(pipe: Connection, desk: WatchDesk, watch: Watch) -> StreamOutcome:
    found = _hear(pipe, MARGIN_S, lambda: None)
    if not isinstance(found, Readiness):
        raise LabError(f"streamer: unexpected word {found!r}")
    if not watch.confirm(found):
        raise RefusedError("execute: nobody wanted the arm to move, and it did not")
    pipe.send(True)
    patience_s = found.course_s + MARGIN_S
    try:
        if not found.tells_linked:
            watch.linked(found)
        desk.let_go()
    except KeyboardInterrupt:
        desk.ask_to_stop()

    def look() -> None:
        progress = desk.look()
        if progress is not None:
            watch.progress(progress)

    outcome = _hear(pipe, patience_s + 60.0, look, desk.ask_to_stop)
    if not isinstance(outcome, StreamOutcome):
        raise LabError(f"streamer: unexpected word {outcome!r}")
    return outcome


def _hear(
    pipe: Connection, patience_s: float, look: Callable[[], None], interrupted: Callable[[], None] | None = None
) -> object:
    """Wait for the streamer's next word, looking after things meanwhile."""
    left = round(patience_s / LOOK_S)
    while left > 0:
        try:
            left -= 1
            if pipe.poll(LOOK_S):
                word = pipe.recv()
                if isinstance(word, BaseException):
                    raise word
                return word
            look()
        except EOFError:
            raise LabError("streamer: it has died") from None
        except KeyboardInterrupt:
            if interrupted is None:
                raise
            interrupted()
    raise LabError(f"streamer: not heard of for {patience_s:.0f} s")


def _main(job: StreamJob, words: Any, pipe: Connection, parent: int) -> None:
    """Be the streamer."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        pipe.send(_stream(job, StreamDesk(words, parent), pipe))
    except SlidepipeError as error:
        pipe.send(error)
    except (BrokenPipeError, EOFError, ConnectionResetError):
        return  # nobody is left to tell


def _stream(job: StreamJob, desk: StreamDesk, pipe: Connection) -> StreamOutcome:
    lab, clock = job.lab, RealClock()
    codec = CODECS[lab.dialect]
    with closing(UdpTransport(lab.local, lab.remote)) as transport, NatNetClient(lab.cameras, clock) as cameras:
        arm = LinkedArm(transport, codec, clock, link_wait_s=lab.link_wait_s, gripper_n=lab.gripper_n)
        measured = arm.connect(lab.connect_s)
        await_bodies(cameras, clock, lab)
        course = there_and_back(
            measured.position_rad, job.reference, lab.home_rad, limits=lab.moves, pauses=lab.pauses
        )
        _refuse_leaving_limits(course, lab)
        approach = sum(phase.value == "approach" for phase in course.phases)
        pipe.send(Readiness(measured.position_rad, len(course) * TICK_S, approach * TICK_S, codec.tells_linked))
        _await_leave(pipe, arm, cameras, desk)
        return _run(job, course, arm, cameras, desk=desk, clock=clock)


def _run(
    job: StreamJob, course: Course, arm: LinkedArm, cameras: NatNetClient, *, desk: StreamDesk, clock: RealClock
) -> StreamOutcome:
    lab = job.lab
    arm.prepare(course.commands)
    beat = Beat(clock, len(course) * TICK_S + lab.loop.link_timeout_s + lab.loop.stop_s + lab.loop.hold_s)
    recording = RecordingSetup(job.recording, job.provenance, job.attachments, cameras.ticks_per_s)
    with RecordingProcess(recording) as recorder:
        there = Lab(arm, cameras, recorder.recorder, beat, Guard(lab.safety), desk, lab.loop)
        cameras.take()
        arm.listen_anew()
        with realtime() as refused:
            execution = run(course, there)
        invalid = _why_invalid(execution, lab, recorder.lost)
        now_ns = clock.now_ns()
        if invalid is not None:
            recorder.recorder.event(now_ns, f"{INVALID}{invalid}")
        for line in (*refused, *cameras.take_notices()):
            recorder.recorder.event(now_ns, line)
        recorder.recorder.statistics(_statistics(now_ns, cameras.counts, recorder.lost))
        report = recorder.close()
    return StreamOutcome(execution, beat.lateness_ns.copy(), arm.counts, cameras.counts, report, refused, invalid)


def await_bodies(cameras: NatNetClient, clock: RealClock, lab: LabSettings) -> MocapFrame:
    """Wait for a frame in which both bodies are tracked, the object within reach of the hand.

    Raises
    ------
    LabError
        There is none in time: tells what was missing.
    """
    deadline_ns, wrong = clock.now_ns() + round(1e9 * lab.connect_s), "no frame came"
    while clock.now_ns() < deadline_ns:
        for frame in cameras.take():
            wrong = _missing(frame, lab.safety.object_reach_m)
            if not wrong:
                return frame
        clock.wait_until(clock.now_ns() + TICK_NS)
    raise LabError(f"cameras: within {lab.connect_s:g} s, {wrong}")


def _missing(frame: MocapFrame, reach_m: float) -> str:
    if frame.hand is None or frame.object is None:
        return f"the {'hand' if frame.hand is None else 'object'} was not seen"
    apart_m = float(np.linalg.norm(frame.hand.position_m - frame.object.position_m))
    if apart_m > reach_m:
        return f"the object was {1e3 * apart_m:.0f} mm from the hand, which can hold it within {1e3 * reach_m:.0f}"
    return ""


def _await_leave(pipe: Connection, arm: LinkedArm, cameras: NatNetClient, desk: StreamDesk) -> None:
    """Wait for a person's leave, and keep up with both streams meanwhile."""
    while not pipe.poll(LOOK_S):
        cameras.take()
        arm.listen_anew()
        if desk.stop_asked:
            raise LabError("arm: nobody gave leave to move it")
    pipe.recv()


def _refuse_leaving_limits(course: Course, lab: LabSettings) -> None:
    """The measured pose, the start and the way between them must be within the joints' limits."""
    q, safe = course.position_rad, lab.safety
    outside = np.maximum(safe.lower_rad - q, q - safe.upper_rad)
    row, joint = np.unravel_index(int(np.argmax(outside)), outside.shape)
    if outside[row, joint] > 0.0:
        raise LabError(
            f"arm: on its {course.phases[row].value}, joint {joint + 1} would be at {q[row, joint]:.3f} rad, "
            f"allowed {safe.lower_rad[joint]:.3f} to {safe.upper_rad[joint]:.3f}"
        )


def _why_invalid(execution: Execution, lab: LabSettings, lost: int) -> str | None:
    bound_s = GAP_SHARE * lab.driver_timeout_s
    if execution.longest_gap_s > bound_s:
        return (
            f"the arm was without a command for {1e3 * execution.longest_gap_s:.1f} ms, "
            f"its driver's time-out is {1e3 * lab.driver_timeout_s:.0f} ms"
        )
    return f"{lost} records were lost" if lost else None


def _statistics(now_ns: int, cameras: ClientCounts, lost: int) -> StreamStatistics:
    frames = cameras.frames
    return StreamStatistics(
        stamp_ns=now_ns,
        frames_taken=frames.taken,
        frames_missing=frames.missing,
        frames_repeated=frames.repeated,
        frames_late=frames.late,
        frames_frozen=frames.frozen,
        datagrams_malformed=cameras.malformed,
        datagrams_foreign=cameras.foreign,
        echoes_lost=cameras.echoes_lost,
        records_lost=lost,
    )
