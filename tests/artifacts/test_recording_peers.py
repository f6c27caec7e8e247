"""Readers that others wrote open our recordings: whole, recorded by the process, and recovered."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from recording_samples import ATTACHMENTS, PROVENANCE, everything, write

from slidepipe.artifacts.recording import read_recording
from slidepipe.artifacts.recovery import recover_recording

ROOT = Path(__file__).resolve().parents[2]
MODULES = ROOT / "build" / "peers" / "node_modules"
"""Where ``make check-peers`` puts npm's packages."""
SCRIPT = Path(__file__).with_name("read_by_mcap_core.cjs")
NODE = shutil.which("node")
RERUN = shutil.which("rerun", path=os.pathsep.join((str(Path(sys.executable).parent), os.environ.get("PATH", ""))))
with_node = pytest.mark.skipif(NODE is None, reason="node is not installed")
with_core = pytest.mark.skipif(
    not (MODULES / "@mcap" / "support").is_dir(), reason="npm's @mcap/core is not installed: make check-peers"
)
with_rerun = pytest.mark.skipif(RERUN is None, reason="rerun is not installed: make check-peers")


@pytest.fixture(params=["whole", "recovered"])
def recording(tmp_path: Path, request: pytest.FixtureRequest) -> Path:
    path = write(tmp_path / "a.mcap", everything(2000))
    if request.param == "recovered":
        data = path.read_bytes()
        path.write_bytes(data[: len(data) // 2])
        assert recover_recording(path).fault is not None
    return path


@with_node
@with_core
def test_mcap_core_reads_it_all(recording: Path) -> None:
    environment = {**os.environ, "NODE_PATH": str(MODULES)}
    done = subprocess.run(  # noqa: S603
        [NODE, str(SCRIPT), str(recording)], capture_output=True, text=True, check=True, env=environment, timeout=60
    )
    told, ours = json.loads(done.stdout), read_recording(recording)
    assert told["topics"] == {topic: len(ours.payloads(topic)) for topic in ours.topic_names}
    assert told["streamed"] == {"messages": ours.message_count, "done": True}
    assert told["metadata"]["slidepipe.run"] == PROVENANCE
    assert told["attachments"] == {name: data.decode() for name, data in ATTACHMENTS.items()}
    assert told["schemas"]["/mocap/hand"] == ["protobuf", "foxglove.PoseInFrame", "protobuf"]


@with_rerun
def test_rerun_finds_nothing_wrong(recording: Path) -> None:
    command = [RERUN, "mcap", "check", str(recording)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)  # noqa: S603
    assert done.returncode == 0, done.stdout + done.stderr
    assert "error" not in (done.stdout + done.stderr).lower()
