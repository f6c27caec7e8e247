"""What became of the frames of a stream: none is lost, repeated or out of order without being counted."""

from collections import deque
from dataclasses import dataclass
from enum import Enum

RESTART = 1000
"""A number that lies so far back is no late frame: the server began to count anew."""
REMEMBERED = 128


class Verdict(Enum):
    """What a frame is to the stream."""

    NEW = "new"
    REPEATED = "repeated"
    """It came before: twice over the wire, or over two sockets."""
    LATE = "late"
    """A newer one came before it; it counts as missing."""
    FROZEN = "frozen"
    """A new number, and the exposure of an old frame."""
    RESTARTED = "restarted"
    """The first one after the server began to count anew."""


@dataclass(frozen=True, slots=True)
class StreamCounts:
    """Frames of a stream so far.

    Attributes
    ----------
    taken : int
        Frames that were new.
    missing : int
        Numbers that were skipped.
    repeated, late, frozen : int
        Frames that were put aside.
    restarts : int
        How often the server began to count anew.
    """

    taken: int = 0
    missing: int = 0
    repeated: int = 0
    late: int = 0
    frozen: int = 0
    restarts: int = 0


class FrameSequence:
    """Judges frames as they come."""

    __slots__ = ("_counts", "_exposure", "_last", "_missing", "_seen")

    def __init__(self) -> None:
        self._last: int | None = None
        self._exposure = -1
        self._missing = 0
        self._seen: deque[int] = deque(maxlen=REMEMBERED)
        self._counts = dict.fromkeys(Verdict, 0)

    @property
    def counts(self) -> StreamCounts:
        """Frames so far."""
        of = self._counts
        return StreamCounts(
            taken=of[Verdict.NEW] + of[Verdict.RESTARTED],
            missing=self._missing,
            repeated=of[Verdict.REPEATED],
            late=of[Verdict.LATE],
            frozen=of[Verdict.FROZEN],
            restarts=of[Verdict.RESTARTED],
        )

    def judge(self, number: int, exposure_ticks: int) -> Verdict:
        """Say what a frame is, and count it."""
        verdict = self._verdict(number, exposure_ticks)
        self._counts[verdict] += 1
        if verdict in (Verdict.NEW, Verdict.RESTARTED):
            if verdict is Verdict.NEW and self._last is not None:
                self._missing += number - self._last - 1
            self._last, self._exposure = number, exposure_ticks
            self._seen.append(number)
        return verdict

    def _verdict(self, number: int, exposure_ticks: int) -> Verdict:
        if self._last is None:
            return Verdict.NEW
        if number < self._last - RESTART:
            return Verdict.RESTARTED
        if number <= self._last:
            return Verdict.REPEATED if number in self._seen else Verdict.LATE
        return Verdict.NEW if exposure_ticks > self._exposure else Verdict.FROZEN
