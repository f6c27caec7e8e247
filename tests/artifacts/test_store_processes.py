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
from slidepipe.artifacts.query import Query
from slidepipe.artifacts.run import read_run
from slidepipe.artifacts.seal import read_seal
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.verify import verify_store


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
        draft.add("plan", "plan.txt").write_text("x" * 10_000)
    print(draft.run_id, flush=True)
"""


def start_writer(store: Store, log: Path) -> "subprocess.Popen[bytes]":
    with log.open("ab") as stream:
        return subprocess.Popen([sys.executable, "-c", WRITER, str(store.root)], stdout=stream)  # noqa: S603


def look(store: Store, seen: set[str]) -> int:
    """Read the runs that are new: each must be whole; and what was there once is there for good."""
    entries = {one.run: one for one in store.find(Query()).entries}
    assert seen <= entries.keys(), "a run was lost"
    for new in entries.keys() - seen:
        run = read_run(entries[new].directory)
        assert hashlib.sha256(run.file("plan").read_bytes()).hexdigest() == run.sha256("plan")
        assert read_seal(run.directory).keys() >= {"run.yaml", "plan.txt"}
    reads = len(entries.keys() - seen)
    seen.update(entries)
    return reads


def test_killed_writers_leave_only_whole_runs(store, tmp_path):
    """Six write at once; three are killed over and over, and start again. ``SLIDEPIPE_WRITERS_S`` sets for how long."""
    lasting_s, logs = float(os.environ.get("SLIDEPIPE_WRITERS_S", "2")), [tmp_path / f"{n}.log" for n in range(6)]
    writers = [start_writer(store, log) for log in logs]
    seen, kills, reads = set[str](), 0, 0
    deadline = time.monotonic() + lasting_s
    while time.monotonic() < deadline or not all(log.read_bytes().count(b"\n") > 1 for log in logs):
        reads += look(store, seen)
        for index in range(3):
            if logs[index].read_bytes().count(b"\n") > kills // 3:
                writers[index].send_signal(signal.SIGKILL)
                writers[index].wait()
                writers[index], kills = start_writer(store, logs[index]), kills + 1
    for writer in writers:
        writer.send_signal(signal.SIGKILL)
        writer.wait()
    told = [line for log in logs for line in log.read_text().splitlines() if len(line) == 25]
    look(store, seen)
    published = [path.parent.name for path in store.root.glob("runs/*/2*/run.yaml")]
    assert len(told) == len(set(told)), "a run was published twice"
    assert sorted(published) == sorted(seen), "the index and the directories agree"
    assert set(told) <= seen, "a run that its writer knew to be published was lost"
    assert len(seen) - len(set(told)) <= kills + 6, "and none came from nowhere"
    assert list(verify_store(store)) == []
    print(f"{len(seen)} runs by 6 writers in {lasting_s:g} s, {kills} kills, {reads} whole reads")  # noqa: T201  # what a long run is for


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
