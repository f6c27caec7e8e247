"""Writes recordings that survive the process that writes them."""

import errno
import fcntl
import math
import os
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Any

from mcap.writer import CompressionType, Writer

from slidepipe.artifacts import messages, topics
from slidepipe.artifacts.messages import JOINT_NAMES, Kind, StoredKind
from slidepipe.errors import StoreError

CHUNK_BYTES = 64 * 1024
FLUSH_NS = 200_000_000
"""Time on the host's clock after which what was recorded leaves the process, so that at most 0.3 s are ever lost."""
SYNC_S = 1.0
"""Time after which what left the process is forced onto the disk."""
MAX_STAMP_NS = 2**63 - 1

PROVENANCE = "slidepipe.run"
END = "slidepipe.end"
BASE_FRAME = "base"

Numbers = Sequence[float] | Any
"""A few numbers: a sequence or an array."""


class RecordingWriter:
    """An MCAP file in the making, to be used in a ``with`` statement.

    Provenance and attachments stand first and are on the disk before the file has its name. Messages leave the process
    every 200 ms of the host's clock, as their ``log_ns`` tells it: so a killed process loses that much, and a simulated
    lab, whose clock is virtual, writes the same bytes each time.

    Parameters
    ----------
    path : Path
        File to be made; it must not exist.
    provenance : Mapping[str, str]
        Where the recording comes from.
    attachments : Mapping[str, bytes]
        Files to keep inside, by name.

    Attributes
    ----------
    count : int
        Messages so far.

    Raises
    ------
    StoreError
        The file exists, or a message cannot be recorded: a time out of range or a number that is not finite.
    """

    def __init__(
        self, path: Path, provenance: Mapping[str, str], attachments: Mapping[str, bytes] | None = None
    ) -> None:
        self._path, made = path, path.with_name(f".{path.name}.new")
        try:
            if path.exists():
                raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST))
            self._stream = made.open("wb")
        except OSError as error:
            raise StoreError(f"{path}: cannot be recorded to: {error.strerror}") from None
        with suppress(OSError):  # some file systems know no locks
            fcntl.flock(self._stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
        self._writer: Any = Writer(
            self._stream, chunk_size=CHUNK_BYTES, compression=CompressionType.ZSTD, enable_data_crcs=True
        )
        self._channels: dict[str, tuple[int, Kind | StoredKind]] = {}
        self._schemas: dict[str, int] = {}
        self.count, self._flushed_ns, self._synced_s = 0, -1, time.monotonic()
        self._writer.start(profile="", library="slidepipe")
        self._writer.add_metadata(PROVENANCE, dict(provenance))
        for name, data in (attachments or {}).items():
            self._writer.add_attachment(0, 0, name, _media_type(name), data)
        self._sync()
        made.rename(path)

    def __enter__(self) -> "RecordingWriter":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close("complete" if kind is None else f"interrupted by {kind.__name__}")

    def close(self, state: str = "complete") -> None:
        """Write how the recording ended and the index, and close the file; a closed one stays as it is."""
        if self._stream.closed:
            return
        self._writer.flush()
        self._writer.add_metadata(END, {"state": state, "messages": str(self.count)})
        self._writer.finish()
        self._sync()
        self._stream.close()

    def announce(self, topic: str, kind: Kind | StoredKind) -> None:
        """Make a topic known that may stay without messages."""
        self._channel(topic, kind)

    def pose(
        self,
        topic: str,
        *,
        stamp_ns: int,
        log_ns: int,
        position_m: Numbers,
        quaternion_xyzw: Numbers,
        sequence: int = 0,
        frame_id: str = BASE_FRAME,
    ) -> None:
        """Record the pose of a body: (3,) m and (4,) scalar last, in the frame ``frame_id``."""
        position, quaternion = self._finite(topic, position_m), self._finite(topic, quaternion_xyzw)
        payload = messages.pose_bytes(int(stamp_ns), frame_id, position, quaternion)
        self.add(topic, messages.POSE, payload, stamp_ns=stamp_ns, log_ns=log_ns, sequence=sequence)

    def joints(
        self,
        topic: str,
        *,
        stamp_ns: int,
        log_ns: int,
        position_rad: Numbers,
        velocity_rad_s: Numbers,
        effort_n_m: Numbers,
        sequence: int = 0,
    ) -> None:
        """Record the state of the arm's joints, (7,) each."""
        columns = (self._finite(topic, values) for values in (position_rad, velocity_rad_s, effort_n_m))
        payload = messages.joint_bytes(int(stamp_ns), JOINT_NAMES, list(zip(*columns, strict=True)))
        self.add(topic, messages.JOINTS, payload, stamp_ns=stamp_ns, log_ns=log_ns, sequence=sequence)

    def frame(
        self, *, stamp_ns: int, received_ns: int, frame: int, ticks: int, hand_valid: bool, object_valid: bool
    ) -> None:
        """Record that the cameras sent a frame; ``stamp_ns`` is its mid-exposure as far as the host knows."""
        payload = messages.own_bytes(
            messages.FRAME,
            frame=int(frame),
            ticks=int(ticks),
            received_ns=int(received_ns),
            hand_valid=bool(hand_valid),
            object_valid=bool(object_valid),
        )
        self.add(topics.FRAME, messages.FRAME, payload, stamp_ns=stamp_ns, log_ns=received_ns, sequence=frame)

    def clock(self, *, sent_ns: int, ticks: int, received_ns: int, ticks_per_s: float) -> None:
        """Record an echo exchange with the cameras."""
        payload = messages.own_bytes(
            messages.CLOCK,
            sent_ns=int(sent_ns),
            ticks=int(ticks),
            received_ns=int(received_ns),
            ticks_per_s=float(ticks_per_s),
        )
        self.add(topics.CLOCK, messages.CLOCK, payload, stamp_ns=received_ns, log_ns=received_ns)

    def event(
        self, *, stamp_ns: int, log_ns: int, name: str, message: str, level: str = "info", topic: str = topics.EVENTS
    ) -> None:
        """Record that something happened; ``level`` is one of unknown, debug, info, warning, error, fatal."""
        payload = messages.event_bytes(int(stamp_ns), level, name, message)
        self.add(topic, messages.EVENT, payload, stamp_ns=stamp_ns, log_ns=log_ns)

    def planar(
        self,
        topic: str,
        *,
        stamp_ns: int,
        log_ns: int,
        pose: Numbers,
        velocity: Numbers,
        std: Numbers = (0.0, 0.0, 0.0),
    ) -> None:
        """Record a state in the motion plane: pose, velocity and one standard deviation of the pose, (3,) each."""
        numbers = [value for part in (pose, velocity, std) for value in self._finite(topic, part)]
        fields = dict(zip(_PLANAR_FIELDS, numbers, strict=True))
        payload = messages.own_bytes(messages.PLANAR, stamp_ns=int(stamp_ns), **fields)
        self.add(topic, messages.PLANAR, payload, stamp_ns=stamp_ns, log_ns=log_ns)

    def counts(self, topic: str, kind: Kind, *, stamp_ns: int, **fields: int) -> None:
        """Record whole numbers that belong to a time, as one of our own messages."""
        payload = messages.own_bytes(kind, stamp_ns=int(stamp_ns), **fields)
        self.add(topic, kind, payload, stamp_ns=stamp_ns, log_ns=stamp_ns)

    def flush(self) -> None:
        """Let go of what is recorded now, whatever the host's clock says."""
        self._writer.flush()

    def add(
        self, topic: str, kind: Kind | StoredKind, payload: bytes, *, stamp_ns: int, log_ns: int, sequence: int = 0
    ) -> None:
        """Record an encoded message."""
        for name, value, top in (
            ("stamp_ns", stamp_ns, MAX_STAMP_NS),
            ("log_ns", log_ns, MAX_STAMP_NS),
            ("sequence", sequence, 2**32 - 1),
        ):
            if not 0 <= value <= top:
                raise StoreError(f"{self._path}: {topic}: {name} must be from 0 to {top}, got {value}")
        channel = self._channel(topic, kind)
        self._writer.add_message(channel, int(log_ns), payload, int(stamp_ns), int(sequence))
        self.count += 1
        self._pace(int(log_ns))

    def _channel(self, topic: str, kind: Kind | StoredKind) -> int:
        if topic not in self._channels:
            if kind.name not in self._schemas:
                self._schemas[kind.name] = self._writer.register_schema(kind.name, "protobuf", kind.schema)
            channel = self._writer.register_channel(topic, "protobuf", self._schemas[kind.name])
            self._channels[topic] = (channel, kind)
        channel, known = self._channels[topic]
        if known.name != kind.name:
            raise StoreError(f"{self._path}: {topic}: holds {known.name}, got {kind.name}")
        return channel

    def _pace(self, log_ns: int) -> None:
        """Let go of what is recorded; series written one after the other make the clock jump back, hence abs."""
        if self._flushed_ns < 0:
            self._flushed_ns = log_ns
        if abs(log_ns - self._flushed_ns) < FLUSH_NS:
            return
        self._writer.flush()
        self._flushed_ns = log_ns
        if time.monotonic() - self._synced_s >= SYNC_S:
            self._sync()

    def _sync(self) -> None:
        self._writer.flush()
        self._stream.flush()
        os.fsync(self._stream.fileno())
        self._synced_s = time.monotonic()

    def _finite(self, topic: str, values: Numbers) -> list[float]:
        numbers = [float(value) for value in values]
        if not all(map(math.isfinite, numbers)):
            raise StoreError(f"{self._path}: {topic}: numbers must be finite, got {numbers}")
        return numbers


def _media_type(name: str) -> str:
    return "application/yaml" if name.endswith(".yaml") else "application/octet-stream"


_PLANAR_FIELDS = ("x_m", "y_m", "theta_rad", "x_m_s", "y_m_s", "theta_rad_s", "x_std_m", "y_std_m", "theta_std_rad")
