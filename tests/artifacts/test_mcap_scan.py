import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from recording_samples import everything, poses, write

from slidepipe.artifacts.mcap_scan import scan
from slidepipe.artifacts.recording import (
    Series,
    read_recording,
)
from slidepipe.errors import InputError, NotFoundError


def test_files_that_are_no_recordings(tmp_path):
    path = tmp_path / "a.mcap"
    with pytest.raises(NotFoundError) as missing:
        read_recording(path)
    assert str(missing.value) == f"{path}: no such file"
    with pytest.raises(InputError) as directory:
        read_recording(tmp_path)
    assert str(directory.value) == f"{tmp_path}: is a directory, an MCAP recording is needed"
    path.touch()
    with pytest.raises(InputError) as empty:
        read_recording(path)
    assert str(empty.value) == f"{path}: is empty, an MCAP recording is needed"
    path.write_text("schema: slidepipe.plan/1\n")
    with pytest.raises(InputError) as yaml:
        read_recording(path)
    assert str(yaml.value) == f"{path}: is not an MCAP recording, it begins with b'schema: '"


def chunk_ends(data: bytes) -> list[int]:
    ends, offset = [], 8
    while offset < len(data) - 8:
        end = offset + 9 + int.from_bytes(data[offset + 1 : offset + 9], "little")
        if data[offset] == 0x06:
            ends.append(end)
        offset = end
    return ends


def test_a_truncated_recording_says_what_remains(tmp_path):
    path = write(tmp_path / "a.mcap", Series(poses={"/a": poses(3000)}))
    data = path.read_bytes()
    second = chunk_ends(data)[1]
    path.write_bytes(data[: second + 20])
    with pytest.raises(InputError) as caught:
        read_recording(path)
    readable = scan(data[:second]).messages
    assert 0 < readable < 3000
    assert str(caught.value) == (
        f"{path}: byte {second}: cut off inside the record that begins here, {second + 20} bytes are there; "
        f"{readable} messages can be recovered"
    )
    path.write_bytes(data[:second])
    with pytest.raises(
        InputError, match=rf"byte {second}: the file ends here and was never closed; {readable} messages"
    ):
        read_recording(path)


def test_a_damaged_chunk_is_passed_over(tmp_path):
    path = write(tmp_path / "a.mcap", Series(poses={"/a": poses(3000)}))
    data = bytearray(path.read_bytes())
    first, second = chunk_ends(bytes(data))[:2]
    data[second - 50] ^= 0xFF
    path.write_bytes(data)
    with pytest.raises(InputError, match="damaged chunk") as caught:
        read_recording(path)
    found = scan(bytes(data))
    assert f"; {found.messages} messages can be recovered" in str(caught.value)
    assert 2000 < found.messages < 3000
    assert int(found.fault.split()[1].rstrip(":")) >= first


@pytest.fixture(scope="module")
def small_recording(tmp_path_factory) -> Path:
    return write(tmp_path_factory.mktemp("small") / "a.mcap", everything(20))


@settings(max_examples=300, deadline=None)
@given(data=st.data())
def test_no_single_wrong_byte_goes_unseen(small_recording, data):
    sound = small_recording.read_bytes()
    place = data.draw(st.integers(0, len(sound) - 1))
    value = data.draw(st.integers(1, 255))
    broken = bytearray(sound)
    broken[place] ^= value
    path = small_recording.with_name("broken.mcap")
    path.write_bytes(broken)
    with pytest.raises(InputError) as caught:
        read_recording(path)
    assert len(caught.value.lines) == 1
    assert "\n" not in str(caught.value)


@settings(max_examples=100, deadline=None)
@given(data=st.data())
def test_no_truncation_goes_unseen(small_recording, data):
    sound = small_recording.read_bytes()
    path = small_recording.with_name("short.mcap")
    path.write_bytes(sound[: data.draw(st.integers(0, len(sound) - 1))])
    with pytest.raises(InputError):
        read_recording(path)


KILLED = """
import sys, time
from pathlib import Path
from slidepipe.artifacts.recording import RecordingWriter
writer = RecordingWriter(Path(sys.argv[1]), {"seed": "1"}, {"plan.yaml": b"a: 1"})
print("ready", flush=True)
sent = 0
while True:
    now = time.monotonic_ns()
    writer.pose("/a", stamp_ns=now, log_ns=now, position_m=(sent, 0, 0), quaternion_xyzw=(0, 0, 0, 1), sequence=sent)
    sent += 1
    print(sent, flush=True)
    time.sleep(0.0005)
"""


def test_a_killed_writer_loses_only_the_last_moment(tmp_path):
    path = tmp_path / "a.mcap"
    command = [sys.executable, "-c", KILLED, str(path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:  # noqa: S603
        assert process.stdout.readline() == "ready\n"
        begun = scan(path.read_bytes())
        assert begun.metadata == {"slidepipe.run": {"seed": "1"}}
        assert begun.attachments == {"plan.yaml": b"a: 1"}
        time.sleep(1.2)
        os.kill(process.pid, signal.SIGKILL)
        sent = int(process.stdout.read().split()[-1])
    with pytest.raises(InputError, match=r"never closed; [0-9]+ messages can be recovered") as caught:
        read_recording(path)
    kept = int(str(caught.value).split()[-5])
    assert kept >= 0.6 * sent
    found = scan(path.read_bytes())
    assert found.topics["/a"].sequence == list(range(kept))
