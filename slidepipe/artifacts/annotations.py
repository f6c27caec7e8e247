"""What people note on runs: ``annotations.jsonl``, a line each, never changed and only added to."""

import getpass
import json
import os
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path

from slidepipe.errors import StoreError

ATTEMPTS = 20


@dataclass(frozen=True, slots=True)
class Annotation:
    """A note on a run: when it was written, by whom, a verdict in a word, and any text."""

    run: str
    time: str
    author: str
    verdict: str | None
    note: str


@dataclass(frozen=True, slots=True)
class Annotations:
    """The notes of a store; the file comes to be with the first of them."""

    path: Path

    def add(self, annotation: Annotation) -> None:
        """Add a note, and wait until it is on the disk.

        Where machines share a file system without locks, one may write over the end of another's line: so it is looked
        for afterwards, and added again where it is not there.

        Raises
        ------
        StoreError
            The file cannot be written.
        """
        line = json.dumps(asdict(annotation), ensure_ascii=False).encode()
        for _ in range(ATTEMPTS):
            try:
                self._append(line)
            except OSError as error:
                raise StoreError(f"{self.path}: cannot be written: {error.strerror}") from None
            if line in self._lines():
                return
        raise StoreError(f"{self.path}: a note was written {ATTEMPTS} times and is not there")

    def of(self, run: str) -> tuple[Annotation, ...]:
        """Notes on a run, in the order in which they were written."""
        return tuple(one for one in self.all() if one.run == run)

    def all(self) -> tuple[Annotation, ...]:
        """Every note once; a line that cannot be read is passed over, :meth:`faults` tells it."""
        return tuple(dict.fromkeys(one for one in map(_parsed, self._lines()) if one is not None))

    def faults(self) -> tuple[str, ...]:
        """Lines that cannot be read."""
        return tuple(
            f"{self.path}:{number}: is not a note"
            for number, line in enumerate(self._lines(), start=1)
            if line and _parsed(line) is None
        )

    def _append(self, line: bytes) -> None:
        """Add a line by one write, on a line of its own even behind one that was cut off."""
        handle = os.open(self.path, os.O_RDWR | os.O_APPEND | os.O_CREAT, 0o666)
        try:
            end = os.fstat(handle).st_size
            whole = end == 0 or os.pread(handle, 1, end - 1) == b"\n"
            os.write(handle, (b"" if whole else b"\n") + line + b"\n")
            os.fsync(handle)
        finally:
            os.close(handle)

    def _lines(self) -> list[bytes]:
        try:
            return self.path.read_bytes().split(b"\n")
        except FileNotFoundError:
            return []
        except OSError as error:
            raise StoreError(f"{self.path}: cannot be read: {error.strerror}") from None


def annotation_of(run: str, *, author: str | None, verdict: str | None, note: str) -> Annotation:
    """Note of this moment, by default by the user of this process."""
    return Annotation(
        run=run,
        time=f"{datetime.now(UTC):%Y-%m-%dT%H:%M:%S.%fZ}",
        author=author or _user(),
        verdict=verdict,
        note=note,
    )


def _user() -> str:
    try:
        return getpass.getuser()
    except (KeyError, OSError):  # a container without names
        return str(os.getuid())


def _parsed(line: bytes) -> Annotation | None:
    try:
        return Annotation(**json.loads(line))
    except (ValueError, TypeError):
        return None
