"""Recordings that were cut off or damaged become sound, with everything that could be read of them."""

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from recording_samples import ATTACHMENTS, PROVENANCE, everything, poses, write

from slidepipe.artifacts.mcap_scan import scan
from slidepipe.artifacts.recording import RecordingWriter, Series, read_recording
from slidepipe.artifacts.recovery import recover_recording
from slidepipe.errors import BusyError, InputError, NotFoundError


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    return write(tmp_path_factory.mktemp("sound") / "a.mcap", everything(200)).read_bytes()


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("place") / "a.mcap"


def recovered(path: Path, data: bytes) -> None:
    """Recover, and compare with what can be read of the damaged bytes."""
    before = scan(data)
    path.write_bytes(data)
    told = recover_recording(path)
    assert told.fault == before.fault
    assert told.messages == before.messages
    after = read_recording(path)
    assert after.metadata["slidepipe.run"] == PROVENANCE
    assert after.message_count == before.messages
    for topic, column in before.topics.items():
        rows = sorted(zip(column.log_ns, column.payload, strict=True), key=lambda row: row[0])
        assert list(after.payloads(topic)) == [payload for _, payload in rows]
        assert after.schema(topic) == column.schema
    assert recover_recording(path).fault is None, "once is enough"


@settings(max_examples=40)
@given(share=st.floats(0.0, 1.0))
def test_cut_off_anywhere_after_the_provenance(sound: bytes, place: Path, share: float) -> None:
    first = len(scan_begin(sound))
    data = sound[: first + round(share * (len(sound) - first - 1))]
    recovered(place, data)
    assert {name: read_recording(place).attachment(name) for name in ATTACHMENTS} == ATTACHMENTS


def scan_begin(data: bytes) -> bytes:
    """Bytes up to the end of the last attachment."""
    offset = end = 8
    while offset < len(data) - 8:
        opcode, length = data[offset], int.from_bytes(data[offset + 1 : offset + 9], "little")
        offset += 9 + length
        if opcode == 0x09:
            end = offset
    return data[:end]


@settings(max_examples=40)
@given(data=st.data())
def test_a_wrong_byte_anywhere_after_the_provenance(sound: bytes, place: Path, data: st.DataObject) -> None:
    broken = bytearray(sound)
    broken[data.draw(st.integers(len(scan_begin(sound)), len(sound) - 1))] ^= data.draw(st.integers(1, 255))
    recovered(place, bytes(broken))


def test_a_sound_recording_is_left_alone(tmp_path: Path, sound: bytes) -> None:
    path = tmp_path / "a.mcap"
    path.write_bytes(sound)
    told = recover_recording(path)
    assert (told.fault, told.messages) == (None, read_recording(path).message_count)
    assert path.read_bytes() == sound
    assert [one.name for one in tmp_path.iterdir()] == ["a.mcap"]


def test_how_it_ended_is_told(tmp_path: Path, sound: bytes) -> None:
    path = tmp_path / "a.mcap"
    path.write_bytes(sound[: len(sound) // 2])
    fault = recover_recording(path).fault
    assert read_recording(path).metadata["slidepipe.end"]["state"] == f"recovered: {fault}"


def test_what_is_still_written_is_left_alone(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    with RecordingWriter(path, PROVENANCE), pytest.raises(BusyError, match=r"a\.mcap: is still being written$"):
        recover_recording(path)
    assert recover_recording(path).fault is None


def test_more_can_be_added(tmp_path: Path) -> None:
    path = write(tmp_path / "a.mcap", Series(poses={"/a": poses(3000)}))
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])

    def more(writer: RecordingWriter) -> None:
        writer.event(stamp_ns=10**12, log_ns=10**12, name="test", message="added")

    told = recover_recording(path, more)
    recording = read_recording(path)
    assert recording.message_count == told.messages
    assert [event.message for event in recording.events()] == ["added"]


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", r"is not an MCAP recording, it begins with b''$"),
        (b"schema: slidepipe", r"is not an MCAP recording, it begins with b'schema: '$"),
        (b"\x89MCAP0\r\n", r"never closed; it does not say where it comes from, and cannot be recovered$"),
    ],
)
def test_what_cannot_be_recovered(tmp_path: Path, data: bytes, message: str) -> None:
    path = tmp_path / "a.mcap"
    path.write_bytes(data)
    with pytest.raises(InputError, match=message):
        recover_recording(path)
    assert path.read_bytes() == data
    with pytest.raises(NotFoundError, match=r"b\.mcap: no such file$"):
        recover_recording(tmp_path / "b.mcap")
