"""ROS 2 bags, by rosbags: written from a recording, and read as poses of two bodies."""

from pathlib import Path
from typing import Any, Literal

import numpy as np
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from slidepipe.artifacts import messages
from slidepipe.artifacts.export import KINDS, decoded
from slidepipe.artifacts.foreign_poses import SeenBody, Sighting, in_frames
from slidepipe.artifacts.messages import Kind
from slidepipe.artifacts.recording_reader import Recording
from slidepipe.errors import InputError, NotFoundError, SlidepipeError

BAG_VERSION: Literal[9] = 9
OWN = "slidepipe_msgs/msg/"
_TYPES = {
    messages.POSE.name: "geometry_msgs/msg/PoseStamped",
    messages.JOINTS.name: "sensor_msgs/msg/JointState",
    messages.EVENT.name: "rcl_interfaces/msg/Log",
}
_FIELD_TYPES = {1: "float64", 6: "uint64", 7: "uint32", 8: "bool", 16: "int64"}
"""Types of fields in ROS by their numbers in protobuf: double, fixed64, fixed32, bool, sfixed64."""
_LOG_LEVELS = (0, 10, 20, 30, 40, 50)
"""Of rcl_interfaces, in the order of ours."""


def write_bag(recording: Recording, directory: Path) -> None:
    """Write a bag with MCAP inside: poses, joint states and events as ROS has them, the rest as messages of our own."""
    store: Any = get_typestore(Stores.ROS2_HUMBLE)
    for kind in KINDS.values():
        if kind.name not in _TYPES:
            store.register(get_types_from_msg(_definition(kind), _ros_type(kind)))
    with Writer(directory, version=BAG_VERSION, storage_plugin=StoragePlugin.MCAP) as writer:
        for topic in recording.topic_names:
            kind = _kind(recording, topic)
            connection = writer.add_connection(topic, _ros_type(kind), typestore=store)
            rows = zip(recording.log_ns(topic).tolist(), decoded(recording, topic, kind), strict=True)
            for log_ns, message in rows:
                data = store.serialize_cdr(_translated(store, message), _ros_type(kind))
                writer.write(connection, log_ns, data)


def read_bag(path: Path, hand: str, thing: str) -> Sighting:
    """Poses of the hand and the object from two topics of stamped poses; each sample's time is its header's stamp.

    Raises
    ------
    NotFoundError
        There is no such bag.
    InputError
        It is damaged, has no such topics, or the two were never seen in one frame.
    """
    if not path.exists():
        raise NotFoundError(f"{path}: no such bag")
    store = get_typestore(Stores.ROS2_HUMBLE)
    try:
        with AnyReader([path], default_typestore=store) as reader:
            return in_frames(str(path), _seen(reader, path, hand), _seen(reader, path, thing))
    except SlidepipeError:
        raise
    except Exception as error:  # noqa: BLE001  # a damaged bag ends the reading in many ways
        raise InputError(f"{path}: is no ROS 2 bag that can be read: {' '.join(str(error).split())}") from None


def _seen(reader: AnyReader, path: Path, topic: str) -> SeenBody:
    connections = [one for one in reader.connections if one.topic == topic and _pose_of(one.msgtype) is not None]
    if not connections:
        there = ", ".join(sorted(one.topic for one in reader.connections if _pose_of(one.msgtype))) or "none"
        raise InputError(f"{path}: has no stamped poses on {topic}, there are: {there}")
    stamps, rows = [], []
    for connection, received_ns, data in reader.messages(connections=connections):
        message: Any = reader.deserialize(data, connection.msgtype)
        stamp = message.header.stamp
        at, turn = _parts(message, connection.msgtype)
        stamps.append(10**9 * stamp.sec + stamp.nanosec or received_ns)
        rows.append((at.x, at.y, at.z, turn.x, turn.y, turn.z, turn.w))
    return SeenBody(topic, np.array(stamps, dtype=np.int64), np.array(rows, dtype=float).reshape(-1, 7))


def _pose_of(ros_type: str) -> tuple[str, ...] | None:
    """Where in a message the pose stands; None for messages without one."""
    return {
        "geometry_msgs/msg/PoseStamped": ("pose",),
        "geometry_msgs/msg/PoseWithCovarianceStamped": ("pose", "pose"),
        "geometry_msgs/msg/TransformStamped": ("transform",),
        "nav_msgs/msg/Odometry": ("pose", "pose"),
    }.get(ros_type)


def _parts(message: Any, ros_type: str) -> tuple[Any, Any]:
    """Position and orientation of a message."""
    for name in _pose_of(ros_type) or ():
        message = getattr(message, name)
    if hasattr(message, "translation"):
        return message.translation, message.rotation
    return message.position, message.orientation


def _kind(recording: Recording, topic: str) -> Kind:
    name = recording.schema(topic)
    if name not in KINDS:
        raise InputError(f"{recording.path}: {topic}: {name} cannot be exported")
    return KINDS[name]


def _ros_type(kind: Kind) -> str:
    return _TYPES.get(kind.name) or OWN + kind.name.rpartition(".")[2]


def _definition(kind: Kind) -> str:
    fields = kind.message.DESCRIPTOR.fields
    return "\n".join(f"{_FIELD_TYPES[field.type]} {field.name}" for field in fields)


def _translated(store: Any, message: Any) -> Any:
    """A message of ours as ROS has it."""
    types, name = store.types, message.DESCRIPTOR.full_name
    if name not in _TYPES:
        fields = message.DESCRIPTOR.fields
        return types[OWN + message.DESCRIPTOR.name](**{field.name: getattr(message, field.name) for field in fields})
    stamp = types["builtin_interfaces/msg/Time"](sec=message.timestamp.seconds, nanosec=message.timestamp.nanos)
    if name == messages.EVENT.name:
        level = _LOG_LEVELS[message.level]
        return types[_TYPES[name]](
            stamp=stamp, level=level, name=message.name, msg=message.message, file="", function="", line=0
        )
    header = types["std_msgs/msg/Header"](stamp=stamp, frame_id=getattr(message, "frame_id", ""))
    if name == messages.POSE.name:
        at, turn = message.pose.position, message.pose.orientation
        point = types["geometry_msgs/msg/Point"](x=at.x, y=at.y, z=at.z)
        quaternion = types["geometry_msgs/msg/Quaternion"](x=turn.x, y=turn.y, z=turn.z, w=turn.w)
        return types[_TYPES[name]](header, types["geometry_msgs/msg/Pose"](point, quaternion))
    columns = (
        np.array([getattr(one, field) for one in message.joints]) for field in ("position", "velocity", "effort")
    )
    return types[_TYPES[name]](header, [one.name for one in message.joints], *columns)
