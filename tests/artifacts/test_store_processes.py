import hashlib
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from slidepipe.artifacts.manifest import RunState
from slidepipe.artifacts.store import Store


@pytest.fixture
def store(tmp_path: Path) -> Store:
    return Store(tmp_path / "data")


WRITER = """
import sys
from pathlib import Path
from slidepipe.artifacts.store import Store
store = Store(Path(sys.argv[1]))
while True:
    with store.draft(stage="plan", stage_version=1, experiment="a", parameters={}) as draft:
        draft.add("plan", "plan.yaml").write_text("x" * 10_000)
    print(draft.run_id, flush=True)
"""


def test_killed_writers_leave_only_whole_runs(store):
    command = [sys.executable, "-c", WRITER, str(store.root)]
    writers = [subprocess.Popen(command, stdout=subprocess.PIPE, text=True) for _ in range(2)]  # noqa: S603
    told = [writer.stdout.readline().strip() for writer in writers]
    time.sleep(0.3)
    for writer in writers:
        os.kill(writer.pid, signal.SIGKILL)
    for writer in writers:
        told += writer.stdout.read().split("\n")
        writer.stdout.close()
        writer.wait()
    runs = store.runs()
    assert {line for line in told if len(line) == 25} <= {run.id for run in runs}
    for run in runs:
        assert hashlib.sha256(run.file("plan").read_bytes()).hexdigest() == run.sha256("plan")


INTERRUPTED = """
import sys, time
from pathlib import Path
from slidepipe.artifacts.store import Store
with Store(Path(sys.argv[1])).draft(stage="execute", stage_version=1, experiment="a", parameters={}) as draft:
    draft.add("trial", "trial.mcap").write_bytes(b"some")
    print("ready", flush=True)
    time.sleep(60)
"""


def test_ctrl_c_publishes_what_there_is(store):
    command = [sys.executable, "-c", INTERRUPTED, str(store.root)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:  # noqa: S603
        assert process.stdout.readline() == "ready\n"
        process.send_signal(signal.SIGINT)
        assert "KeyboardInterrupt" in process.communicate(timeout=20)[1]
    run = store.get("@latest")
    assert run.manifest.state is RunState.INTERRUPTED
    assert run.file("trial").read_bytes() == b"some"


def test_a_store_is_read_without_numpy():
    code = (
        "import sys, json; import slidepipe.artifacts.store, slidepipe.artifacts.experiment; "
        "print(json.dumps(sorted({'numpy', 'scipy', 'mcap', 'google.protobuf'} & set(sys.modules))))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)  # noqa: S603
    assert json.loads(done.stdout) == []
