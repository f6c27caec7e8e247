"""The streamer: the loop, alone in a process of its own.

It connects, tells what it found, waits for leave, and streams. It ignores Ctrl-C, which the watching process turns into
a wish to stop; where that process is gone, it stops as well. Nothing is cut: the arm slows down on its path.
"""

import signal
from collections.abc import Mapping
from contextlib import closing
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np

from slidepipe.errors import LabError, SlidepipeError
from slidepipe.lab.approach import there_and_back
from slidepipe.lab.clock import SPIN_NS, TICK_NS, Beat, RealClock
from slidepipe.lab.course import Course
from slidepipe.lab.desk import StreamDesk
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
LOOK_S = 0.1
LONGEST_S = 600.0
"""Ticks of so long a stream have their lateness kept."""


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


def main(job: StreamJob, words: Any, pipe: Connection, parent: int) -> None:
    """Be the streamer."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        pipe.send(_stream(job, StreamDesk(words, parent), pipe))
    except SlidepipeError as error:
        pipe.send(error)
    except (BrokenPipeError, EOFError, ConnectionResetError):
        return  # nobody is left to tell


def _stream(job: StreamJob, desk: StreamDesk, pipe: Connection) -> StreamOutcome:
    lab, clock = job.lab, RealClock(SPIN_NS)
    codec = CODECS[lab.dialect]
    with closing(UdpTransport(lab.local, lab.remote)) as transport, NatNetClient(lab.cameras, clock) as cameras:
        beat = Beat(clock, LONGEST_S)
        arm = LinkedArm(transport, codec, clock, link_wait_s=lab.link_wait_s, gripper_n=lab.gripper_n, beat=beat)
        measured = arm.connect(lab.connect_s)
        await_bodies(cameras, clock, lab)
        course = there_and_back(measured.position_rad, job.reference, lab.home_rad, limits=lab.moves, pauses=lab.pauses)
        _refuse_leaving_limits(course, lab)
        approach = sum(phase.value == "approach" for phase in course.phases)
        pipe.send(Readiness(measured.position_rad, len(course) * TICK_S, approach * TICK_S, codec.tells_linked))
        _await_leave(pipe, arm, cameras, desk)
        return _run(job, course, _Streams(arm, cameras, beat, clock), desk)


@dataclass(frozen=True, slots=True)
class _Streams:
    arm: LinkedArm
    cameras: NatNetClient
    beat: Beat
    clock: RealClock


def _run(job: StreamJob, course: Course, streams: _Streams, desk: StreamDesk) -> StreamOutcome:
    lab, arm, cameras, beat = job.lab, streams.arm, streams.cameras, streams.beat
    arm.prepare(course.commands)
    recording = RecordingSetup(job.recording, job.provenance, job.attachments, cameras.ticks_per_s)
    with RecordingProcess(recording) as recorder:
        guard = Guard(lab.safety)
        there = Lab(arm, cameras, recorder.recorder, beat, guard, desk, lab.loop)
        with realtime() as refused:
            while cameras.take():  # it takes a few frames at a time, and what came while the recorder began is old
                pass
            arm.listen_anew()
            execution = run(course, there)
        now_ns, invalid = streams.clock.now_ns(), _why_invalid(execution, lab, recorder.lost)
        for line in (*refused, *cameras.take_notices(), *(() if invalid is None else (f"{INVALID}{invalid}",))):
            recorder.recorder.event(now_ns, line)
        recorder.recorder.statistics(_statistics(now_ns, streams, lost=recorder.lost, swaps=guard.swaps))
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
        if desk.wish is not None:
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


def _statistics(now_ns: int, streams: _Streams, *, lost: int, swaps: int) -> StreamStatistics:
    arm, cameras = streams.arm.counts, streams.cameras.counts
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
        states_lost=arm.lost,
        states_disordered=arm.disordered,
        bodies_swapped=swaps,
    )
