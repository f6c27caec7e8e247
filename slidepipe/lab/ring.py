"""From the loop to the recorder through shared memory: a ring of fixed-size records that never makes the loop wait.

One process writes, one reads. The writer fills a slot and then moves ``head`` past it, the reader empties it and then
moves ``tail``; each is one aligned word that only its owner changes. Where there is no room a record is dropped and
counted, by kind, in the ring itself, so that both ends know.
"""

import mmap
import os
from collections.abc import Mapping
from dataclasses import dataclass, fields
from enum import IntEnum

import numpy as np

from slidepipe.lab.protocols import (
    BodyPose,
    ClockExchange,
    JointCommand,
    JointState,
    MocapFrame,
    Recorder,
)
from slidepipe.series import FloatArray, IntArray, StreamStatistics

SLOTS = 16_384
"""Records of some fifteen seconds: the recorder may stand still for so long."""
JOINTS = 7
_WORDS = 48
"""Eight-byte words of a slot, and of the head of the ring."""
_WORD = 8
_HEAD, _TAIL, _CLOSED, _DROPPED = 0, 8, 16, 24
"""Words of the ring's own: on cache lines of their own where two processes write them."""
_TEXT_AT = 4
MOST_TEXT_BYTES = (_WORDS - _TEXT_AT) * _WORD
_POSE_WORDS = 7


class Kind(IntEnum):
    """What a record is."""

    JOINTS = 0
    FRAME = 1
    CLOCK = 2
    EVENT = 3
    TICK = 4
    STATISTICS = 5


class Ring:
    """The shared memory, without a name: it is gone when the last process that has it is gone.

    Parameters
    ----------
    descriptor : int
        Of the memory, as :meth:`make` made it and another process inherited it.
    """

    def __init__(self, descriptor: int) -> None:
        self.descriptor = descriptor
        self._memory = mmap.mmap(descriptor, 0)
        words = np.frombuffer(self._memory, dtype=np.int64)
        self.head: IntArray = words[:_WORDS]
        self.words: IntArray = words[_WORDS:].reshape(-1, _WORDS)
        self.numbers: FloatArray = self.words.view(np.float64)

    @classmethod
    def make(cls, slots: int = SLOTS) -> "Ring":
        """Make a ring with room for so many records; it is touched, so that no page of it is missing later."""
        descriptor = os.memfd_create("slidepipe-ring")
        os.ftruncate(descriptor, (slots + 1) * _WORDS * _WORD)
        ring = cls(descriptor)
        ring.words[:] = 0
        return ring

    @property
    def dropped(self) -> Mapping[Kind, int]:
        """Records that there was no room for, by kind; kinds that lost none are left out."""
        counts = self.head[_DROPPED : _DROPPED + len(Kind)]
        return {kind: int(counts[kind]) for kind in Kind if counts[kind]}

    @property
    def waiting(self) -> int:
        """Records that were written and not read yet."""
        return int(self.head[_HEAD] - self.head[_TAIL])

    @property
    def closed(self) -> bool:
        """Whether the writer has said that nothing more comes."""
        return bool(self.head[_CLOSED])

    def close(self) -> None:
        """Say that nothing more comes."""
        self.head[_CLOSED] = 1


class RingRecorder:
    """The loop's end of a ring: implements ``Recorder`` in a microsecond or two each.

    Parameters
    ----------
    ring : Ring
    """

    def __init__(self, ring: Ring) -> None:
        self._ring, self._slots = ring, len(ring.words)
        self._head, self._words, self._numbers = ring.head, ring.words, ring.numbers
        self._written = int(ring.head[_HEAD])

    def joints(self, command: JointCommand, state: JointState) -> None:
        """Record one tick of the arm."""
        at = self._room(Kind.JOINTS)
        if at < 0:
            return
        self._words[at, 1] = state.stamp_ns
        row = self._numbers[at]
        row[2:9] = command.position_rad
        row[9:16] = command.velocity_rad_s
        row[16:23] = command.feedforward_n_m
        row[23:30] = state.position_rad
        row[30:37] = state.velocity_rad_s
        row[37:44] = state.effort_n_m
        self._commit()

    def frame(self, frame: MocapFrame) -> None:
        """Record one camera frame."""
        at = self._room(Kind.FRAME)
        if at < 0:
            return
        seen = (frame.hand is not None) + 2 * (frame.object is not None)
        self._words[at, 1:5] = (frame.frame, frame.ticks, frame.received_ns, seen)
        row = self._numbers[at]
        for place, body in ((5, frame.hand), (5 + _POSE_WORDS, frame.object)):
            if body is not None:
                row[place : place + 3] = body.position_m
                row[place + 3 : place + _POSE_WORDS] = body.quaternion_xyzw
        self._commit()

    def clock(self, exchange: ClockExchange) -> None:
        """Record one echo."""
        self._put(Kind.CLOCK, exchange.sent_ns, exchange.ticks, exchange.received_ns)

    def event(self, stamp_ns: int, text: str) -> None:
        """Record that something happened; a text that is too long is cut and says so."""
        at = self._room(Kind.EVENT)
        if at < 0:
            return
        data = _fitted(text)
        self._words[at, 1:3] = (stamp_ns, len(data))
        room = self._words[at, _TEXT_AT:].view(np.uint8)
        room[: len(data)] = np.frombuffer(data, dtype=np.uint8)
        self._commit()

    def tick(self, stamp_ns: int, late_ns: int) -> None:
        """Record that a tick was due, and how late it began."""
        self._put(Kind.TICK, stamp_ns, late_ns)

    def statistics(self, statistics: StreamStatistics) -> None:
        """Record the statistics so far."""
        self._put(Kind.STATISTICS, *(getattr(statistics, field.name) for field in fields(statistics)))

    def _put(self, kind: Kind, *words: int) -> None:
        at = self._room(kind)
        if at >= 0:
            self._words[at, 1 : 1 + len(words)] = words
            self._commit()

    def _room(self, kind: Kind) -> int:
        """Slot for the next record; -1, and counted, where there is none."""
        if self._written - self._head[_TAIL] >= self._slots:
            self._head[_DROPPED + kind] += 1
            return -1
        at = self._written % self._slots
        self._words[at, 0] = kind
        return at

    def _commit(self) -> None:
        self._written += 1
        self._head[_HEAD] = self._written


@dataclass(frozen=True, slots=True)
class RingReader:
    """The recorder's end of a ring."""

    ring: Ring

    def replay(self, recorder: Recorder, most: int = SLOTS) -> int:
        """Tell a recorder what the loop told the ring, the oldest first; returns how many records that were.

        Where the recorder raises, the record is gone, and the next call goes on with the one after it.
        """
        ring, count = self.ring, min(self.ring.waiting, most)
        tail = int(ring.head[_TAIL])
        for place in range(tail, tail + count):
            at = place % len(ring.words)
            try:
                _tell(recorder, ring.words[at], ring.numbers[at])
            finally:
                ring.head[_TAIL] = place + 1
        return count


def _tell(recorder: Recorder, words: IntArray, numbers: FloatArray) -> None:
    kind = int(words[0])
    if kind == Kind.JOINTS:
        command = JointCommand(numbers[2:9], numbers[9:16], numbers[16:23])
        recorder.joints(command, JointState(int(words[1]), numbers[23:30], numbers[30:37], numbers[37:44]))
    elif kind == Kind.FRAME:
        frame, ticks, received_ns, seen = words[1:5].tolist()
        hand = _pose(numbers, 5) if seen & 1 else None
        thing = _pose(numbers, 5 + _POSE_WORDS) if seen & 2 else None
        recorder.frame(MocapFrame(frame, ticks, received_ns, hand, thing))
    elif kind == Kind.CLOCK:
        recorder.clock(ClockExchange(*words[1:4].tolist()))
    elif kind == Kind.EVENT:
        stamp_ns, length = words[1:3].tolist()
        text = words[_TEXT_AT:].view(np.uint8)[:length].tobytes().decode("utf-8", "replace")
        recorder.event(stamp_ns, text)
    elif kind == Kind.TICK:
        recorder.tick(*words[1:3].tolist())
    else:
        recorder.statistics(StreamStatistics(*words[1 : 1 + len(fields(StreamStatistics))].tolist()))


def _pose(numbers: FloatArray, place: int) -> BodyPose:
    return BodyPose(numbers[place : place + 3], numbers[place + 3 : place + _POSE_WORDS])


def _fitted(text: str) -> bytes:
    data = text.encode("utf-8", "replace")
    if len(data) <= MOST_TEXT_BYTES:
        return data
    return data[: MOST_TEXT_BYTES - 4].decode("utf-8", "ignore").encode() + b" ..."
