"""Reads recordings back as plain series."""

from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from google.protobuf.message import DecodeError

from slidepipe.artifacts import messages, topics
from slidepipe.artifacts.mcap_scan import MAGIC, Scan, Topic, scan
from slidepipe.artifacts.messages import Kind
from slidepipe.errors import InputError, NotFoundError
from slidepipe.series import (
    BoolArray,
    ClockSync,
    FloatArray,
    FrameSeries,
    IntArray,
    JointSeries,
    MocapSeries,
    PoseSeries,
    StreamStatistics,
    TickSeries,
)


@dataclass(frozen=True, slots=True)
class PlanarSeries:
    """States in the motion plane: (T,) stamps, and (T, 3) pose, velocity and standard deviation of the pose."""

    stamp_ns: IntArray
    pose: FloatArray
    velocity: FloatArray
    std: FloatArray


@dataclass(frozen=True, slots=True)
class Event:
    """Something that happened; ``level`` is one of unknown, debug, info, warning, error, fatal."""

    stamp_ns: int
    level: str
    name: str
    message: str


@dataclass(frozen=True, slots=True)
class Recording:
    """An MCAP file that is sound from end to end; series are decoded when they are asked for.

    Every method raises :class:`~slidepipe.errors.InputError` where the topic is missing or holds something else.
    """

    path: Path
    _scan: Scan

    @property
    def metadata(self) -> dict[str, dict[str, str]]:
        """Metadata records by name: ``slidepipe.run`` holds the provenance, ``slidepipe.end`` how it ended."""
        return self._scan.metadata

    @property
    def topic_names(self) -> tuple[str, ...]:
        """Names of the topics, in order."""
        return tuple(sorted(self._scan.topics))

    @property
    def message_count(self) -> int:
        """Messages of all topics."""
        return self._scan.messages

    def attachment(self, name: str) -> bytes:
        """Bytes of a file that is kept inside."""
        if name not in self._scan.attachments:
            there = ", ".join(self._scan.attachments) or "none"
            raise InputError(f"{self.path}: has no attachment {name}, there are: {there}")
        return self._scan.attachments[name]

    @property
    def attachments(self) -> dict[str, bytes]:
        """Files that are kept inside, by name."""
        return self._scan.attachments

    def schema(self, topic: str) -> str:
        """Name of the schema of a topic's messages."""
        return self._topic(topic).schema

    def log_ns(self, topic: str) -> IntArray:
        """(T,) times at which the host received a topic's messages."""
        return np.array(self._topic(topic).log_ns, dtype=np.int64)

    def payloads(self, topic: str) -> tuple[bytes, ...]:
        """Encoded messages of a topic."""
        return tuple(self._topic(topic).payload)

    def poses(self, topic: str) -> PoseSeries:
        """Poses of a body."""
        column = self._of_kind(topic, messages.POSE)
        numbers = self._decoded(topic, messages.pose_array, column.payload)
        return PoseSeries(
            stamp_ns=np.array(column.publish_ns, dtype=np.int64),
            position_m=numbers[:, :3],
            quaternion_xyzw=numbers[:, 3:],
            sequence=np.array(column.sequence, dtype=np.int64),
        )

    def joints(self, topic: str) -> JointSeries:
        """States of the arm's joints."""
        column = self._of_kind(topic, messages.JOINTS)
        numbers = self._decoded(topic, messages.joint_array, column.payload)
        return JointSeries(
            stamp_ns=np.array(column.publish_ns, dtype=np.int64),
            position_rad=numbers[..., 0],
            velocity_rad_s=numbers[..., 1],
            effort_n_m=numbers[..., 2],
        )

    def planar(self, topic: str) -> PlanarSeries:
        """States in the motion plane."""
        stamps, *columns = self._fields(topic, messages.PLANAR)
        numbers = np.array(columns, dtype=float).reshape(9, -1).T
        return PlanarSeries(np.array(stamps, dtype=np.int64), numbers[:, :3], numbers[:, 3:6], numbers[:, 6:])

    def mocap(self) -> MocapSeries:
        """Everything that the cameras recorded."""
        return MocapSeries(
            frames=self._frames(), hand=self.poses(topics.HAND), object=self.poses(topics.OBJECT), clock=self._clock()
        )

    def ticks(self) -> TickSeries:
        """Ticks of the loop."""
        stamps, late = self._fields(topics.TICKS, messages.TICK)
        return TickSeries(_whole(stamps), _whole(late))

    def statistics(self) -> list[StreamStatistics]:
        """Statistics of the streams, as often as they were recorded."""
        columns = self._fields(topics.STATISTICS, messages.STATISTICS)
        return [StreamStatistics(*row) for row in zip(*columns, strict=True)]

    def events(self, topic: str = topics.EVENTS) -> list[Event]:
        """What happened, in the order of the file."""
        column = self._of_kind(topic, messages.EVENT)
        rows = self._decoded(topic, messages.event_rows, column.payload)
        return [
            Event(stamp, level, log.name, log.message)
            for stamp, (level, log) in zip(column.publish_ns, rows, strict=True)
        ]

    def _frames(self) -> FrameSeries:
        frame, ticks, received, hand, body = self._fields(topics.FRAME, messages.FRAME)
        return FrameSeries(_whole(frame), _whole(ticks), _whole(received), _flags(hand), _flags(body))

    def _clock(self) -> ClockSync:
        sent, ticks, received, rates = self._fields(topics.CLOCK, messages.CLOCK)
        if len(set(rates)) != 1:
            raise InputError(
                f"{self.path}: {topics.CLOCK}: must state one rate of the cameras' clock, got {len(set(rates))}"
            )
        return ClockSync(_whole(sent), _whole(ticks), _whole(received), rates[0])

    def _fields(self, topic: str, kind: Kind) -> list[list[Any]]:
        column = self._of_kind(topic, kind)
        columns: list[list[Any]] = self._decoded(topic, partial(messages.field_lists, kind), column.payload)
        return columns

    def _topic(self, topic: str) -> Topic:
        if topic not in self._scan.topics:
            raise InputError(f"{self.path}: has no topic {topic}, there are: {', '.join(self.topic_names) or 'none'}")
        return self._scan.topics[topic]

    def _of_kind(self, topic: str, kind: Kind) -> Topic:
        column = self._topic(topic)
        if column.schema != kind.name:
            raise InputError(f"{self.path}: {topic}: must hold {kind.name}, got {column.schema or 'no schema'}")
        return column

    def _decoded(self, topic: str, decode: Any, payloads: list[bytes]) -> Any:
        try:
            return decode(payloads)
        except (DecodeError, ValueError, IndexError) as error:
            raise InputError(f"{self.path}: {topic}: a message cannot be decoded: {error}") from None


def read_recording(path: Path) -> Recording:
    """Read a whole recording.

    Raises
    ------
    InputError
        It is a directory, empty, not MCAP, cut off or damaged: at which byte, and how many messages can be read.
    NotFoundError
        There is no such file.
    """
    data = bytes_of(path)
    if not data:
        raise InputError(f"{path}: is empty, an MCAP recording is needed")
    if not data.startswith(MAGIC):
        raise InputError(f"{path}: is not an MCAP recording, it begins with {data[:8]!r}")
    found = scan(data)
    if found.fault:
        raise InputError(f"{path}: {found.fault}; {found.messages} messages can be recovered")
    return Recording(path, found)


def bytes_of(path: Path) -> bytes:
    """Bytes of a file that shall be a recording.

    Raises
    ------
    NotFoundError
        There is no such file.
    InputError
        It is a directory, or cannot be read.
    """
    try:
        return path.read_bytes()
    except FileNotFoundError:
        raise NotFoundError(f"{path}: no such file") from None
    except IsADirectoryError:
        raise InputError(f"{path}: is a directory, an MCAP recording is needed") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from None


def _whole(values: list[int]) -> IntArray:
    return np.array(values, dtype=np.int64)


def _flags(values: list[bool]) -> BoolArray:
    return np.array(values, dtype=np.bool_)
