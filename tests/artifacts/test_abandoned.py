"""Runs whose process was killed, and those that only look like it."""

import os
import platform
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from click.testing import CliRunner

from slidepipe.artifacts.draft_document import OWNER, read_draft, write_draft
from slidepipe.artifacts.manifest import RunState
from slidepipe.artifacts.store import Store
from slidepipe.cli.main import cli

HELD = """
import sys, time
from pathlib import Path
from slidepipe.artifacts.store import Store
store = Store(Path(sys.argv[1]))
asked = {"stage": "execute", "stage_version": 3, "experiment": "a", "parameters": {"b": 1.5}, "seed": 4}
with store.draft(**asked, command=("x",)) as draft:
    draft.add("notes", "notes.txt").write_text("some")
    print(draft.run_id, flush=True)
    time.sleep(60)
"""


@pytest.fixture
def store(tmp_path: Path) -> Store:
    return Store(tmp_path / "data")


@pytest.fixture
def process(store: Store) -> Iterator[subprocess.Popen]:
    with subprocess.Popen([sys.executable, "-c", HELD, str(store.root)], stdout=subprocess.PIPE, text=True) as one:  # noqa: S603
        one.run_id = one.stdout.readline().strip()
        yield one
        one.kill()


def kill_unnoticed(process: subprocess.Popen) -> None:
    """Kill it and do not wait: it is a zombie then, as a shell's background job may be for long."""
    os.kill(process.pid, signal.SIGKILL)
    while ") Z " not in Path(f"/proc/{process.pid}/stat").read_text():
        time.sleep(0.001)


def call(store: Store, *arguments: str):
    return CliRunner().invoke(cli, ["--data", str(store.root), *arguments])


def test_a_killed_run_is_listed_as_interrupted_and_recovered(store: Store, process: subprocess.Popen) -> None:
    assert store.abandoned() == ()
    assert "no runs in" in call(store, "ls").stderr
    kill_unnoticed(process)
    listed = call(store, "ls")
    assert f"{process.run_id}  execute  a           interrupted     4" in listed.stdout
    assert listed.stderr == "1 interrupted and not published: slidepipe recover\n"
    assert store.runs() == [], "it is no run before it is published"
    (one,) = store.abandoned()
    run = one.publish()
    assert store.get("@latest").manifest == run.manifest
    told = run.manifest
    assert (told.run, told.stage, told.stage_version, told.seed) == (process.run_id, "execute", 3, 4)
    assert (told.parameters, told.command, told.state) == ({"b": 1.5}, ("x",), RunState.INTERRUPTED)
    assert told.times.started <= told.times.finished
    assert run.file("notes").read_text() == "some"
    assert not (run.directory / OWNER).exists()
    assert store.abandoned() == ()
    assert call(store, "ls").stderr == ""


def test_recover_tells_what_it_did(store: Store, process: subprocess.Popen) -> None:
    nothing = call(store, "recover")
    assert (nothing.exit_code, nothing.stdout) == (0, "")
    assert nothing.stderr == f"nothing to recover in {store.root}\n"
    kill_unnoticed(process)
    unknown = call(store, "recover", "2020")
    assert unknown.exit_code == 4
    assert unknown.stderr == f"error: run 2020: is not interrupted, or not known; there are: {process.run_id}\n"
    done = call(store, "recover", process.run_id[:17], "--json")
    assert done.exit_code == 0
    assert f'"run": "{process.run_id}"' in done.stdout
    assert store.get(process.run_id).manifest.state is RunState.INTERRUPTED


@pytest.mark.usefixtures("process")
def test_a_number_that_another_process_has_by_now(store: Store) -> None:
    (staging,) = store.root.glob("runs/*/.tmp-*")
    owner = read_draft(staging)
    assert not owner.gone
    assert owner.model_copy(update={"begun": "2020-01-01T00:00:00.000000Z"}).gone
    assert owner.model_copy(update={"pid": 2**22 + 1}).gone
    elsewhere = owner.model_copy(update={"pid": 2**22 + 1, "host": platform.node() + "-other"})
    assert not elsewhere.gone, "of another machine nobody knows"
    write_draft(staging, elsewhere)
    assert store.abandoned() == ()


@pytest.mark.parametrize("text", ["", "schema: slidepipe.draft/1\n", "{", None])
def test_a_draft_that_says_nothing_is_passed_over(store: Store, process: subprocess.Popen, text: str | None) -> None:
    (staging,) = store.root.glob("runs/*/.tmp-*")
    kill_unnoticed(process)
    (staging / OWNER).unlink() if text is None else (staging / OWNER).write_text(text)
    assert store.abandoned() == ()
