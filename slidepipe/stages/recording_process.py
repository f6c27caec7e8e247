"""The recorder as a process of its own: the loop writes to a ring and never waits, this end writes the file.

The file's provenance is on the disk before the loop may begin. The recorder lives as long as the loop's process:
it finishes the file when it is told to, or when that process is gone. It ignores Ctrl-C and its like, which reach it as
well: the loop decides when the trial is over.
"""

import base64
import json
import os
import select
import signal
import subprocess
import sys
import time
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import IO

from slidepipe.artifacts.recording_writer import RecordingWriter
from slidepipe.artifacts.recovery import recover_recording
from slidepipe.errors import LabError, SlidepipeError, StoreError
from slidepipe.lab.ring import SLOTS, Ring, RingReader, RingRecorder
from slidepipe.stages.recorder import TrialRecorder

START_S = 20.0
"""How long the process may take to begin."""
FINISH_S = 20.0
"""How long it may take to write what is left and close the file."""
PERIOD_S, IDLE_S = 0.01, 0.1
READY = "ready"
_TROUBLE = "error: "


@dataclass(frozen=True, slots=True)
class RecordingSetup:
    """What a recording begins with: see :class:`~slidepipe.artifacts.recording_writer.RecordingWriter`."""

    path: Path
    provenance: Mapping[str, str]
    attachments: Mapping[str, bytes]
    ticks_per_s: float


@dataclass(frozen=True, slots=True)
class RecordingReport:
    """How a recording ended.

    Attributes
    ----------
    lost : Mapping[str, int]
        Records that there was no room for, by kind; empty where nothing was lost.
    fault : str, optional
        What became of the recorder where it did not end as it should; the file is sound all the same, with what the
        recorder had written and what it had not yet read.
    """

    lost: Mapping[str, int]
    fault: str | None


class RecordingProcess:
    """Starts the recorder, and ends it; to be used in a ``with`` statement.

    Attributes
    ----------
    recorder : RingRecorder
        For the loop.

    Raises
    ------
    LabError
        On entering: the recorder cannot write there, or does not begin in time.
    """

    def __init__(self, setup: RecordingSetup, slots: int = SLOTS) -> None:
        self._setup, self._ring = setup, Ring.make(slots)
        self.recorder = RingRecorder(self._ring)
        self._process: subprocess.Popen[str] | None = None
        self._report: RecordingReport | None = None

    def __enter__(self) -> "RecordingProcess":
        command = [sys.executable, "-m", __name__, str(self._ring.descriptor), str(os.getpid())]
        self._process = subprocess.Popen(  # noqa: S603  # ourselves
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, pass_fds=[self._ring.descriptor]
        )
        try:
            _write_setup(self._process.stdin, self._setup)
            self._await_ready(self._process)
        except BaseException:
            self._end(self._process)
            raise
        finally:
            os.close(self._ring.descriptor)  # the memory stays mapped
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @property
    def pid(self) -> int:
        """Of the recorder's process."""
        if self._process is None:
            raise LabError("recorder: was not started")
        return self._process.pid

    @property
    def fault(self) -> str | None:
        """What is wrong with the recorder now; it costs a system call, so do not ask in every tick."""
        code = None if self._process is None else self._process.poll()
        if code is not None and self._report is None:
            return f"the recorder has died ({_cause(code)})"
        lost = sum(self._ring.dropped.values())
        return f"{lost} records were lost: the recorder is too slow" if lost else None

    @property
    def waiting(self) -> int:
        """Records that are not written yet."""
        return self._ring.waiting

    @property
    def lost(self) -> int:
        """Records so far that there was no room for."""
        return sum(self._ring.dropped.values())

    def close(self) -> RecordingReport:
        """Have what is left written and the file closed; tells how it went, also when asked again."""
        if self._report is None:
            self._report = self._finish()
        return self._report

    def _finish(self) -> RecordingReport:
        self._ring.close()
        fault = None if self._process is None else self._end(self._process, FINISH_S)
        if fault is not None:
            self._write_the_rest(fault)
        return RecordingReport({kind.name.lower(): count for kind, count in self._ring.dropped.items()}, fault)

    def _write_the_rest(self, fault: str) -> None:
        """Make the file of a dead recorder sound, with what is still in the ring."""

        def rest(writer: RecordingWriter) -> None:
            recorder = TrialRecorder(writer, self._setup.ticks_per_s)
            while self._ring.waiting:
                _replay(RingReader(self._ring), recorder)
            recorder.event(recorder.latest_ns, fault, level="error")

        with suppress(SlidepipeError, OSError):  # it died before it wrote anything: the report tells
            recover_recording(self._setup.path, rest)

    @staticmethod
    def _end(process: subprocess.Popen[str], patience_s: float = 0.0) -> str | None:
        """Wait for the process, and kill it where it takes too long; returns what went wrong."""
        with process:
            try:
                code = process.wait(patience_s)
            except subprocess.TimeoutExpired:
                process.kill()
                return f"the recorder did not finish within {patience_s:g} s"
        return None if code == 0 else f"the recorder has died ({_cause(code)})"

    def _await_ready(self, process: subprocess.Popen[str]) -> None:
        if process.stdout is None or not select.select([process.stdout], [], [], START_S)[0]:
            raise LabError(f"recorder: did not begin within {START_S:g} s")
        said = process.stdout.readline().strip()
        if said != READY:
            raise LabError(f"recorder: {said.removeprefix(_TROUBLE) or 'ended before it began'}")


def _cause(code: int) -> str:
    return f"signal {-code}" if code < 0 else f"exit code {code}"


def _write_setup(pipe: IO[str] | None, setup: RecordingSetup) -> None:
    told = {
        "path": str(setup.path),
        "provenance": dict(setup.provenance),
        "attachments": {name: base64.b64encode(data).decode() for name, data in setup.attachments.items()},
        "ticks_per_s": setup.ticks_per_s,
    }
    with suppress(BrokenPipeError):  # it has died: reading what it said tells more
        print(json.dumps(told), file=pipe, flush=True)  # to the other end


def _read_setup(line: str) -> RecordingSetup:
    told = json.loads(line)
    attachments = {name: base64.b64decode(data) for name, data in told["attachments"].items()}
    return RecordingSetup(Path(told["path"]), told["provenance"], attachments, float(told["ticks_per_s"]))


def main() -> int:
    """Record until the ring is closed or the loop's process is gone."""
    for one in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(one, signal.SIG_IGN)
    _be_ordinary()
    ring, parent, line = Ring(int(sys.argv[1])), int(sys.argv[2]), sys.stdin.readline()
    if not line:  # the loop's process is gone already
        return 1
    setup = _read_setup(line)
    try:
        writer = RecordingWriter(setup.path, setup.provenance, setup.attachments)
    except Exception as error:  # noqa: BLE001  # whatever it is, the loop's process shall hear of it
        print(f"{_TROUBLE}{error}", flush=True)  # noqa: T201  # the other end reads it
        return 1
    print(READY, flush=True)  # noqa: T201  # as above
    writer.close(_record(ring, writer, setup.ticks_per_s, parent))
    return 0


def _be_ordinary() -> None:
    """Give back what the loop's process may have reserved for itself: real-time priority and a core."""
    with suppress(OSError):
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
    with suppress(OSError):
        os.sched_setaffinity(0, range(os.cpu_count() or 1))


def _replay(reader: RingReader, recorder: TrialRecorder) -> int:
    """Write what is there; a record that cannot be written, such as one that is not finite, is told as an event."""
    try:
        return reader.replay(recorder)
    except StoreError as error:
        recorder.event(recorder.latest_ns, f"not recorded: {error}", level="error")
        return 1


def _record(ring: Ring, writer: RecordingWriter, ticks_per_s: float, parent: int) -> str:
    """Write what comes until nothing more will; returns how it ended."""
    reader, recorder = RingReader(ring), TrialRecorder(writer, ticks_per_s)
    told, held_since = 0, None
    while True:
        over, orphaned = ring.closed, os.getppid() != parent
        count = _replay(reader, recorder)
        lost = sum(ring.dropped.values())
        if lost > told:
            recorder.event(recorder.latest_ns, f"{lost - told} records were lost: the ring was full", level="error")
            told = lost
        if (over or orphaned) and not ring.waiting:
            return "complete" if over else "interrupted: the loop's process is gone"
        # The writer lets go by the host's clock, which stands still where nothing comes any more.
        held_since = time.monotonic() if count else held_since
        if held_since is not None and time.monotonic() - held_since > IDLE_S:
            writer.flush()
            held_since = None
        time.sleep(PERIOD_S)


if __name__ == "__main__":
    sys.exit(main())
