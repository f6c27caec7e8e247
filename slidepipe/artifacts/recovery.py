"""Makes a sound recording of one that was cut off or damaged."""

import fcntl
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from operator import itemgetter
from pathlib import Path

from slidepipe.artifacts.mcap_scan import MAGIC, Scan, scan
from slidepipe.artifacts.messages import StoredKind
from slidepipe.artifacts.recording_reader import bytes_of
from slidepipe.artifacts.recording_writer import PROVENANCE, RecordingWriter
from slidepipe.errors import BusyError, InputError

LOOK_S = 0.02
RECOVERED = "recovered"
"""How the state of a recording begins that was recovered."""


@dataclass(frozen=True, slots=True)
class Recovery:
    """What became of a recording.

    Attributes
    ----------
    path : Path
    fault : str, optional
        What was wrong with it; None where it was sound and is as it was.
    messages : int
        Messages that are in it now.
    """

    path: Path
    fault: str | None
    messages: int


def recover_recording(path: Path, more: Callable[[RecordingWriter], None] | None = None) -> Recovery:
    """Write a recording anew from all that can be read of it, and put that in its place; a sound one is left alone.

    Parameters
    ----------
    path : Path
    more : Callable, optional
        Adds what is known otherwise to one that was not sound.

    Raises
    ------
    NotFoundError
        There is no such file.
    InputError
        It is no recording of ours, or nothing of it can be read.
    BusyError
        It is still being written.
    """
    data = bytes_of(path)
    if not data.startswith(MAGIC):
        raise InputError(f"{path}: is not an MCAP recording, it begins with {data[:8]!r}")
    _check_idle(path)
    found = scan(data)
    if found.fault is None:
        return Recovery(path, None, found.messages)
    if PROVENANCE not in found.metadata:
        raise InputError(f"{path}: {found.fault}; it does not say where it comes from, and cannot be recovered")
    made = path.with_name(f".{path.name}.recovered")
    made.unlink(missing_ok=True)
    with_more = _rewrite(found, made, more)
    made.replace(path)
    return Recovery(path, found.fault, with_more)


def await_written(path: Path, patience_s: float) -> None:
    """Return when nobody writes a recording any more, or it is not there, or it took too long."""
    deadline_s = time.monotonic() + patience_s
    while time.monotonic() < deadline_s:
        with suppress(BusyError):
            if path.exists():
                _check_idle(path)
            return
        time.sleep(LOOK_S)


def _check_idle(path: Path) -> None:
    with path.open("rb") as stream:
        try:
            fcntl.flock(stream, fcntl.LOCK_SH | fcntl.LOCK_NB)
        except BlockingIOError:
            raise BusyError(f"{path}: is still being written") from None
        except OSError:  # the file system knows no locks
            return


def _rewrite(found: Scan, path: Path, more: Callable[[RecordingWriter], None] | None) -> int:
    """Write what was found, and more; returns the number of messages."""
    writer = RecordingWriter(path, found.metadata[PROVENANCE], found.attachments)
    entries = []
    for topic, column in found.topics.items():
        kind = StoredKind(column.schema, column.definition)
        writer.announce(topic, kind)
        rows = zip(column.log_ns, column.publish_ns, column.sequence, column.payload, strict=True)
        entries += [(log_ns, topic, kind, stamp_ns, number, payload) for log_ns, stamp_ns, number, payload in rows]
    for log_ns, topic, kind, stamp_ns, number, payload in sorted(entries, key=itemgetter(0)):
        writer.add(topic, kind, payload, stamp_ns=stamp_ns, log_ns=log_ns, sequence=number)
    if more is not None:
        more(writer)
    writer.close(f"{RECOVERED}: {found.fault}")
    return writer.count
