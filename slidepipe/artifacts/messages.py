"""The messages of a recording as bytes: foxglove schemas where one fits, our own for what they lack."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from foxglove_schemas_protobuf.JointStates_pb2 import JointStates
from foxglove_schemas_protobuf.Log_pb2 import Log
from foxglove_schemas_protobuf.PoseInFrame_pb2 import PoseInFrame
from google.protobuf.descriptor_pb2 import FileDescriptorProto, FileDescriptorSet
from google.protobuf.descriptor_pool import DescriptorPool
from google.protobuf.message_factory import GetMessageClass

from slidepipe.series import FloatArray

JOINT_NAMES = tuple(f"j{number}" for number in range(1, 8))
LEVELS = ("unknown", "debug", "info", "warning", "error", "fatal")
"""Levels of an event, in the order of foxglove.Log."""


def _own_messages() -> DescriptorPool:
    pool = DescriptorPool()
    described = FileDescriptorSet.FromString(Path(__file__).with_name("messages.binpb").read_bytes())
    for file in described.file:
        pool.AddSerializedFile(file.SerializeToString())
    return pool


_OWN = _own_messages()
MocapFrame: Any = GetMessageClass(_OWN.FindMessageTypeByName("slidepipe.MocapFrame"))
ClockSync: Any = GetMessageClass(_OWN.FindMessageTypeByName("slidepipe.ClockSync"))
PlanarState: Any = GetMessageClass(_OWN.FindMessageTypeByName("slidepipe.PlanarState"))
LoopTick: Any = GetMessageClass(_OWN.FindMessageTypeByName("slidepipe.LoopTick"))
StreamStatistics: Any = GetMessageClass(_OWN.FindMessageTypeByName("slidepipe.StreamStatistics"))


@dataclass(frozen=True, slots=True)
class Kind:
    """One kind of message: its class, and the schema that makes a recording readable without us."""

    message: Any

    @property
    def name(self) -> str:
        """Full name of the schema, ``foxglove.PoseInFrame`` say."""
        return str(self.message.DESCRIPTOR.full_name)

    @property
    def schema(self) -> bytes:
        """FileDescriptorSet with the message's file and everything that it imports."""
        return _descriptor_set(self.message)


@dataclass(frozen=True, slots=True)
class StoredKind:
    """A kind of message as another recording defines it."""

    name: str
    schema: bytes


POSE, JOINTS, EVENT = Kind(PoseInFrame), Kind(JointStates), Kind(Log)
FRAME, CLOCK, PLANAR = Kind(MocapFrame), Kind(ClockSync), Kind(PlanarState)
TICK, STATISTICS = Kind(LoopTick), Kind(StreamStatistics)


def pose_bytes(stamp_ns: int, frame_id: str, position_m: Sequence[float], quaternion_xyzw: Sequence[float]) -> bytes:
    """Encode a pose as a foxglove.PoseInFrame."""
    message = PoseInFrame(frame_id=frame_id)
    message.timestamp.seconds, message.timestamp.nanos = divmod(stamp_ns, 10**9)
    at, turn = message.pose.position, message.pose.orientation
    at.x, at.y, at.z = position_m
    turn.x, turn.y, turn.z, turn.w = quaternion_xyzw
    return _bytes(message)


def joint_bytes(stamp_ns: int, names: Iterable[str], states: Iterable[Sequence[float]]) -> bytes:
    """Encode joints as a foxglove.JointStates; each state is position rad, velocity rad/s and effort N m."""
    message = JointStates()
    message.timestamp.seconds, message.timestamp.nanos = divmod(stamp_ns, 10**9)
    for name, (position, velocity, effort) in zip(names, states, strict=True):
        message.joints.add(name=name, position=position, velocity=velocity, effort=effort)
    return _bytes(message)


def event_bytes(stamp_ns: int, level: str, name: str, text: str) -> bytes:
    """Encode an event as a foxglove.Log; the level is one of :data:`LEVELS`."""
    message = Log(level=Log.Level.Value(level.upper()), name=name, message=text)
    message.timestamp.seconds, message.timestamp.nanos = divmod(stamp_ns, 10**9)
    return _bytes(message)


def own_bytes(kind: Kind, **fields: float) -> bytes:
    """Encode one of our own messages."""
    return _bytes(kind.message(**fields))


def pose_array(payloads: Sequence[bytes]) -> FloatArray:
    """(T, 7) positions in m and quaternions xyzw of foxglove.PoseInFrame messages."""
    rows = []
    for payload in payloads:
        pose = PoseInFrame.FromString(payload).pose
        at, turn = pose.position, pose.orientation
        rows.append((at.x, at.y, at.z, turn.x, turn.y, turn.z, turn.w))
    return np.array(rows, dtype=float).reshape(-1, 7)


def joint_array(payloads: Sequence[bytes]) -> FloatArray:
    """(T, joints, 3) positions, velocities and efforts of foxglove.JointStates messages; ValueError where ragged."""
    rows = []
    for payload in payloads:
        joints = JointStates.FromString(payload).joints
        rows.append([(joint.position, joint.velocity, joint.effort) for joint in joints])
    return np.array(rows, dtype=float).reshape(len(rows), len(rows[0]) if rows else 7, 3)


def event_rows(payloads: Sequence[bytes]) -> list[tuple[str, Log]]:
    """Level and message of foxglove.Log messages; IndexError where the level is none of ours."""
    logs = [Log.FromString(payload) for payload in payloads]
    return [(LEVELS[log.level], log) for log in logs]


def field_lists(kind: Kind, payloads: Sequence[bytes]) -> list[list[Any]]:
    """Values of each field of our own messages, in the order of the schema."""
    names = [field.name for field in kind.message.DESCRIPTOR.fields]
    messages = [kind.message.FromString(payload) for payload in payloads]
    return [[getattr(message, name) for message in messages] for name in names]


def _bytes(message: Any) -> bytes:
    return bytes(message.SerializeToString(deterministic=True))


@cache
def _descriptor_set(message: Any) -> bytes:
    described = FileDescriptorSet()
    _add_file(described, message.DESCRIPTOR.file)
    return described.SerializeToString(deterministic=True)


def _add_file(described: FileDescriptorSet, file: Any) -> None:
    """Append a file after everything that it imports, each once."""
    if any(known.name == file.name for known in described.file):
        return
    for dependency in file.dependencies:
        _add_file(described, dependency)
    proto = FileDescriptorProto()
    file.CopyToProto(proto)
    described.file.append(proto)
