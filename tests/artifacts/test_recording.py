import importlib.util
import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader
from recording_samples import ATTACHMENTS, PROVENANCE, everything, joints, mocap, poses, write

from slidepipe.artifacts import messages, topics
from slidepipe.artifacts.recording import (
    Event,
    RecordingWriter,
    Series,
    read_recording,
)
from slidepipe.errors import InputError, StoreError


def equal(left: object, right: object) -> None:
    for name in type(left).__dataclass_fields__:
        a, b = getattr(left, name), getattr(right, name)
        if hasattr(a, "__dataclass_fields__"):
            equal(a, b)
        else:
            np.testing.assert_array_equal(a, b, err_msg=name)


def test_everything_comes_back_exactly(tmp_path):
    series = everything()
    recording = read_recording(write(tmp_path / "a.mcap", series))
    equal(recording.mocap(), series.mocap)
    equal(recording.poses("/truth/object"), series.poses["/truth/object"])
    equal(recording.joints(topics.COMMANDED), series.joints[topics.COMMANDED])
    equal(recording.planar("/smoothed/object"), series.planar["/smoothed/object"])
    assert recording.events() == list(series.events)
    assert recording.attachment("plan.yaml") == ATTACHMENTS["plan.yaml"]
    assert recording.metadata["slidepipe.run"] == PROVENANCE
    assert recording.metadata["slidepipe.end"] == {"state": "complete", "messages": str(recording.message_count)}
    np.testing.assert_array_equal(recording.log_ns(topics.HAND), series.mocap.frames.received_ns)


@settings(max_examples=30, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    rows=st.lists(
        st.tuples(
            st.integers(0, 2**63 - 1),
            st.integers(0, 2**32 - 1),
            st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=7, max_size=7),
        ),
        max_size=30,
    )
)
def test_any_poses_come_back_exactly(tmp_path, rows):
    path = tmp_path / "a.mcap"
    path.unlink(missing_ok=True)
    with RecordingWriter(path, {}) as writer:
        writer.announce("/a", messages.POSE)
        for stamp, sequence, numbers in rows:
            writer.pose(
                "/a",
                stamp_ns=stamp,
                log_ns=stamp,
                position_m=numbers[:3],
                quaternion_xyzw=numbers[3:],
                sequence=sequence,
            )
    back = read_recording(path).poses("/a")
    assert back.stamp_ns.tolist() == [row[0] for row in rows]
    assert back.sequence.tolist() == [row[1] for row in rows]
    assert np.hstack([back.position_m, back.quaternion_xyzw]).tolist() == [row[2] for row in rows]


def test_same_series_same_bytes(tmp_path):
    first, second = (write(tmp_path / name, everything()).read_bytes() for name in ("a.mcap", "b.mcap"))
    assert first == second


def test_slow_writing_changes_no_byte(tmp_path, monkeypatch):
    first = write(tmp_path / "a.mcap", everything()).read_bytes()
    hours = iter(range(10**6))
    monkeypatch.setattr(time, "monotonic", lambda: 3600.0 * next(hours))
    assert write(tmp_path / "b.mcap", everything()).read_bytes() == first


def test_provenance_and_attachments_come_first_and_the_end_last(tmp_path):
    opcodes, data, offset = [], write(tmp_path / "a.mcap", everything()).read_bytes(), 8
    while offset < len(data) - 8:
        opcodes.append(data[offset])
        offset += 9 + int.from_bytes(data[offset + 1 : offset + 9], "little")
    data_section = opcodes[: opcodes.index(0x0F)]
    assert data_section[:4] == [0x01, 0x0C, 0x09, 0x09]
    assert data_section[-1] == 0x0C


def test_another_reader_agrees(tmp_path):
    path = write(tmp_path / "a.mcap", everything())
    with path.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        summary = reader.get_summary()
        seen = list(reader.iter_messages())
    assert summary.statistics.message_count == len(seen) == read_recording(path).message_count
    logs = [message.log_time for _, _, message in seen]
    assert logs == sorted(logs)
    assert {channel.message_encoding for _, channel, _ in seen} == {"protobuf"}


def test_schemas_are_whole(tmp_path):
    with write(tmp_path / "a.mcap", everything()).open("rb") as stream:
        schemas = make_reader(stream).get_summary().schemas.values()
    assert {schema.name for schema in schemas} == {
        "foxglove.PoseInFrame", "foxglove.JointStates", "foxglove.Log",
        "slidepipe.MocapFrame", "slidepipe.ClockSync", "slidepipe.PlanarState",
    }  # fmt: skip
    for schema in schemas:
        files = FileDescriptorSet.FromString(schema.data).file
        known = [file.name for file in files]
        for index, file in enumerate(files):
            assert set(file.dependency) <= set(known[:index])
        assert schema.name in {f"{file.package}.{message.name}" for file in files for message in file.message_type}


@pytest.mark.skipif(importlib.util.find_spec("grpc_tools") is None, reason="needs grpcio-tools")
def test_compiled_messages_are_those_of_the_source(tmp_path):
    room = Path(messages.__file__).parent
    out = tmp_path / "messages.binpb"
    command = [sys.executable, "-m", "grpc_tools.protoc", f"--descriptor_set_out={out}", f"-I{room}", "messages.proto"]
    subprocess.run(command, check=True)  # noqa: S603
    compiled, kept = (FileDescriptorSet.FromString(path.read_bytes()) for path in (out, room / "messages.binpb"))
    assert compiled == kept


def test_a_recording_has_its_name_when_its_provenance_is_on_the_disk(tmp_path, monkeypatch):
    path, named = tmp_path / "a.mcap", []
    monkeypatch.setattr(os, "fsync", lambda _: named.append(path.exists()))
    with RecordingWriter(path, {"run": "a"}, {"plan.yaml": b"a: 1\n"}):
        assert named == [False]
        assert list(tmp_path.iterdir()) == [path]


def test_twenty_thousand_messages_are_read_fast(tmp_path):
    path = write(tmp_path / "a.mcap", Series(poses={"/a": poses(20_000)}))
    begun = time.perf_counter()
    assert len(read_recording(path).poses("/a").stamp_ns) == 20_000
    assert time.perf_counter() - begun < 0.5


def test_a_topic_without_samples_is_there(tmp_path):
    recording = read_recording(write(tmp_path / "a.mcap", Series(mocap=mocap(0))))
    assert recording.mocap().hand.position_m.shape == (0, 3)


def test_missing_and_wrong_topics(tmp_path):
    path = write(tmp_path / "a.mcap", Series(poses={"/a": poses(1)}, joints={"/b": joints(1)}))
    recording = read_recording(path)
    with pytest.raises(InputError) as caught:
        recording.mocap()
    assert str(caught.value) == f"{path}: has no topic /mocap/frame, there are: /a, /b"
    with pytest.raises(InputError) as caught:
        recording.poses("/b")
    assert str(caught.value) == f"{path}: /b: must hold foxglove.PoseInFrame, got foxglove.JointStates"
    with pytest.raises(InputError) as caught:
        recording.attachment("x.yaml")
    assert str(caught.value) == f"{path}: has no attachment x.yaml, there are: plan.yaml, experiment.yaml"


def record_and_fail(path: Path) -> None:
    with RecordingWriter(path, {}) as writer:
        writer.event(stamp_ns=0, log_ns=0, name="lab", message="begun")
        raise RuntimeError


def test_an_interrupted_writer_says_so(tmp_path):
    path = tmp_path / "a.mcap"
    with pytest.raises(RuntimeError):
        record_and_fail(path)
    recording = read_recording(path)
    assert recording.metadata["slidepipe.end"] == {"state": "interrupted by RuntimeError", "messages": "1"}
    assert recording.events() == [Event(0, "info", "lab", "begun")]


def test_what_cannot_be_recorded_is_refused(tmp_path):
    path = tmp_path / "a.mcap"
    pose = {"position_m": (0, 0, 0), "quaternion_xyzw": (0, 0, 0, 1)}
    with RecordingWriter(path, {}) as writer:
        with pytest.raises(StoreError, match=r"a.mcap: /a: stamp_ns must be from 0 to 9223372036854775807, got -3$"):
            writer.pose("/a", stamp_ns=-3, log_ns=0, **pose)
        with pytest.raises(StoreError, match=r"/a: numbers must be finite, got \[0.0, nan, 0.0\]"):
            writer.pose("/a", stamp_ns=0, log_ns=0, position_m=(0, float("nan"), 0), quaternion_xyzw=(0, 0, 0, 1))
        writer.pose("/a", stamp_ns=0, log_ns=0, **pose)
        with pytest.raises(StoreError, match=r"/a: holds foxglove.PoseInFrame, got foxglove.Log$"):
            writer.event(topic="/a", stamp_ns=0, log_ns=0, name="a", message="b")
    with pytest.raises(StoreError, match=r"a.mcap: cannot be recorded to: File exists$"):
        RecordingWriter(path, {})
    assert read_recording(path).message_count == 1
