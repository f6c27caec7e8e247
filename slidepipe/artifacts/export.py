"""Recordings for other tools: a directory of CSV tables, or a ROS 2 bag."""

import os
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from slidepipe.artifacts import messages
from slidepipe.artifacts.messages import Kind
from slidepipe.artifacts.recording_reader import Recording
from slidepipe.artifacts.recording_writer import PROVENANCE
from slidepipe.artifacts.strict_yaml import dump
from slidepipe.errors import InputError

KINDS = {
    kind.name: kind
    for kind in (
        messages.POSE,
        messages.JOINTS,
        messages.EVENT,
        messages.FRAME,
        messages.CLOCK,
        messages.PLANAR,
        messages.TICK,
        messages.STATISTICS,
    )
}
"""Every kind of message that a recording of ours holds, by the name of its schema."""
PROVENANCE_FILE = "provenance.yaml"


def export_csv(recording: Recording, directory: Path) -> tuple[str, ...]:
    """Write a table for each topic, the attachments and the provenance; returns the names of the files.

    Raises
    ------
    InputError
        The directory exists or cannot be made.
    """
    return _staged(recording, directory, lambda staging: _write_tables(recording, staging))


def export_ros2(recording: Recording, directory: Path) -> tuple[str, ...]:
    """Write a ROS 2 bag with MCAP inside, beside it the attachments and the provenance; returns the names of the files.

    Raises
    ------
    InputError
        The directory exists or cannot be made.
    """
    from slidepipe.artifacts.ros2_bag import write_bag  # noqa: PLC0415  # it is not needed for tables

    return _staged(recording, directory, lambda staging: write_bag(recording, staging))


def decoded(recording: Recording, topic: str, kind: Kind) -> Iterator[Any]:
    """Messages of a topic, one after the other."""
    return (kind.message.FromString(payload) for payload in recording.payloads(topic))


def _staged(recording: Recording, directory: Path, write: Callable[[Path], None]) -> tuple[str, ...]:
    """Write beside the directory and move there in one go, so that nothing half-written is ever seen."""
    if directory.exists():
        raise InputError(f"{directory}: exists already, name a directory that does not")
    place = directory.with_name(f".tmp-{directory.name}-{os.getpid()}")
    staging = place / directory.name  # a bag's files are named after its directory
    try:
        place.mkdir(parents=True)
        write(staging)
        for name, data in recording.attachments.items():
            (staging / Path(name).name).write_bytes(data)
        (staging / PROVENANCE_FILE).write_text(dump(recording.metadata.get(PROVENANCE, {})), encoding="utf-8")
        staging.rename(directory)
    except OSError as error:
        raise InputError(f"{directory}: cannot be written: {error.strerror}") from None
    finally:
        shutil.rmtree(place, ignore_errors=True)
    return tuple(sorted(path.name for path in directory.iterdir()))


def _write_tables(recording: Recording, staging: Path) -> None:
    import pandas as pd  # noqa: PLC0415  # slow to load

    staging.mkdir()
    for topic in recording.topic_names:
        kind = KINDS.get(recording.schema(topic))
        if kind is None:
            raise InputError(f"{recording.path}: {topic}: {recording.schema(topic)} cannot be exported")
        rows = [_row(message) for message in decoded(recording, topic, kind)]
        columns = list(rows[0]) if rows else []
        table = pd.DataFrame(rows, columns=columns)
        table.insert(0, "received_ns" if "received_ns" not in columns else "log_ns", recording.log_ns(topic))
        table.to_csv(staging / f"{topic.strip('/').replace('/', '_')}.csv", index=False)


def _row(message: Any) -> dict[str, object]:
    """One message as a row, its columns named with their units."""
    name = message.DESCRIPTOR.full_name
    if name == messages.POSE.name:
        at, turn = message.pose.position, message.pose.orientation
        numbers = {"x_m": at.x, "y_m": at.y, "z_m": at.z, "qx": turn.x, "qy": turn.y, "qz": turn.z, "qw": turn.w}
        return {"stamp_ns": message.timestamp.ToNanoseconds(), "frame_id": message.frame_id, **numbers}
    if name == messages.JOINTS.name:
        row: dict[str, object] = {"stamp_ns": message.timestamp.ToNanoseconds()}
        for field, unit in (("position", "rad"), ("velocity", "rad_s"), ("effort", "n_m")):
            row |= {f"{joint.name}_{field}_{unit}": getattr(joint, field) for joint in message.joints}
        return row
    if name == messages.EVENT.name:
        level = messages.LEVELS[message.level]
        stamp_ns = message.timestamp.ToNanoseconds()
        return {"stamp_ns": stamp_ns, "level": level, "name": message.name, "message": message.message}
    return {field.name: getattr(message, field.name) for field in message.DESCRIPTOR.fields}
