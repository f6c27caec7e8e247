"""The index is a cache: whatever happens to it, the answers are those of the directories."""

import os
import random
import shutil
import sqlite3
import subprocess
import sys
from pathlib import Path

import pytest

from slidepipe.artifacts import index_tables
from slidepipe.artifacts.draft import Draft
from slidepipe.artifacts.index import FILE, Index
from slidepipe.artifacts.index_tables import Tables
from slidepipe.artifacts.query import Query
from slidepipe.artifacts.run import Run
from slidepipe.artifacts.store import Store


def publish(store: Store, **changes: object) -> Run:
    asked = {"stage": "plan", "stage_version": 1, "experiment": "a", "parameters": {}} | changes
    with store.draft(**asked) as draft:
        draft.add("plan", "plan.yaml").write_text("a: 1\n")
        draft.report("error", 0.001, std=0.1, unit="m")
    return draft.run


@pytest.fixture
def store(tmp_path: Path) -> Store:
    return Store(tmp_path / "data")


def listed(store: Store, **query: object) -> list[str]:
    return [one.run for one in store.find(Query(**query)).entries]


def settle(store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the index believe that a second look at the directories is not needed."""
    monkeypatch.setattr(index_tables, "SETTLED_NS", -1_000_000_000)
    store.find(Query())


def test_an_entry_is_the_manifest_in_short(store):
    first = publish(store)
    second = publish(store, stage="execute", seed=7, inputs=[first.input("plan")], experiment="b")
    one, two = store.find(Query()).entries
    told = second.manifest
    assert (two.run, two.directory, two.stage, two.experiment) == (second.id, second.directory, "execute", "b")
    assert (two.state, two.recipe, two.seed, two.inputs) == ("complete", told.recipe, 7, (first.id,))
    assert (two.started, two.finished, two.fault) == (told.times.started, told.times.finished, None)
    assert two.results == ({"name": "error", "value": 0.001, "std": 0.1, "unit": "m"},)
    assert (one.inputs, one.seed) == ((), None)


def test_queries(store):
    runs = [publish(store, stage=stage, experiment=name) for stage in ("plan", "execute") for name in ("a", "b")]
    ids, times = [run.id for run in runs], [run.manifest.times.finished for run in runs]
    assert listed(store) == ids
    assert listed(store, stage="execute") == ids[2:]
    assert listed(store, experiment="b", stage="plan") == [ids[1]]
    assert listed(store, since=times[1]) == ids[1:]
    assert listed(store, until=times[1]) == ids[:1]
    assert listed(store, since=times[0][:10]) == ids
    assert listed(store, states=("failed", "lost")) == []
    assert listed(store, recipe=runs[2].manifest.recipe) == ids[2:]
    assert listed(store, begins=ids[3].partition("-")[2][:6]) == [ids[3]]
    page = store.find(Query(limit=1))
    assert ([one.run for one in page.entries], page.total) == ([ids[3]], 4)


@pytest.mark.parametrize("settled", [False, True])
def test_what_others_publish_and_move_away_is_seen(store, monkeypatch, settled):
    first = publish(store)
    if settled:
        settle(store, monkeypatch)
    second = publish(store)
    assert listed(store) == [first.id, second.id]
    if settled:
        settle(store, monkeypatch)
    shutil.rmtree(first.directory)
    assert listed(store) == [second.id]
    shutil.rmtree(second.directory.parent)
    assert listed(store) == []


def test_a_settled_store_is_not_read_again(store, monkeypatch):
    run = publish(store)
    settle(store, monkeypatch)

    def fail(*_: object) -> None:
        raise AssertionError("was read again")

    monkeypatch.setattr(index_tables, "read_entry", fail)
    monkeypatch.setattr(Tables, "_look", fail)
    assert listed(store) == [run.id]


def test_an_edited_manifest_is_read_again(store, monkeypatch):
    run = publish(store)
    settle(store, monkeypatch)
    path = run.directory / "run.yaml"
    path.write_text(path.read_text().replace("stage: plan", "stage: 3"))
    page = store.find(Query())
    assert (page.entries, [one.run for one in page.damaged]) == ((), [run.id])
    assert "stage: must be text, got 3" in page.damaged[0].fault
    path.write_text(path.read_text().replace("stage: 3", "stage: plan"))
    assert listed(store) == [run.id]


def test_a_manifest_without_a_seal_is_validated(store):
    run = publish(store)
    (run.directory / "run.sha256").unlink()
    path = run.directory / "run.yaml"
    path.write_text(path.read_text().replace("platform:", "platfrom:"))
    (damaged,) = store.find(Query()).damaged
    assert "environment.platform: required key is missing" in damaged.fault


def damage(path: Path, how: str) -> None:
    data = bytearray(path.read_bytes())
    if how == "deleted":
        path.unlink()
    elif how == "emptied":
        path.write_bytes(b"")
    elif how == "cut off":
        path.write_bytes(data[: len(data) // 2])
    elif how == "garbage":
        path.write_bytes(bytes(random.Random(1).randbytes(len(data))))
    elif how == "another version":
        with sqlite3.connect(path) as database:
            database.execute("PRAGMA user_version = 99")
        database.close()
    elif how == "a directory":
        path.unlink()
        path.mkdir()
    else:
        path.write_bytes(data.replace(b'"error"', b'"ERROR"'))


@pytest.mark.parametrize(
    "how", ["deleted", "emptied", "cut off", "garbage", "another version", "a directory", "flipped bits in a row"]
)
def test_a_damaged_index_does_not_matter(store, monkeypatch, how):
    runs = [publish(store).id for _ in range(8)]
    settle(store, monkeypatch)
    damage(store.root / FILE, how)
    page = store.find(Query())
    assert [one.run for one in page.entries] == runs
    assert {one.results[0]["name"] for one in page.entries} == {"error"}


def test_any_flipped_byte_of_the_index_does_not_matter(store, monkeypatch):
    runs = [publish(store).id for _ in range(3)]
    settle(store, monkeypatch)
    path, chosen = store.root / FILE, random.Random(2)
    sound = path.read_bytes()
    for _ in range(60):
        data = bytearray(sound)
        data[chosen.randrange(len(data))] ^= 1 << chosen.randrange(8)
        path.write_bytes(data)
        assert listed(store) == runs


def test_a_locked_index_does_not_matter(store, monkeypatch):
    run = publish(store)
    listed(store)
    monkeypatch.setattr(index_tables, "WAIT_S", 0.01)
    holder = sqlite3.connect(store.root / FILE, isolation_level=None)
    holder.execute("BEGIN EXCLUSIVE")
    assert listed(store) == [run.id]
    holder.close()


def test_a_store_that_cannot_be_written_is_read(store, monkeypatch):
    run = publish(store)

    def refuse(*_: object, **__: object) -> None:
        raise PermissionError

    monkeypatch.setattr(Path, "mkdir", refuse)
    assert listed(store) == [run.id]
    assert not (store.root / FILE).exists()


def test_rows_that_another_machine_lost_are_missed(store, monkeypatch):
    runs = [publish(store).id for _ in range(2)]
    settle(store, monkeypatch)
    with sqlite3.connect(store.root / FILE) as database:
        database.execute("DELETE FROM runs WHERE run = ?", (runs[0],))
    database.close()
    assert listed(store) == runs


def test_rebuilding(store):
    publish(store)
    assert store.index.rebuild() == 1
    assert (store.root / FILE).is_file()
    assert Index(store.root / "nothing").rebuild() == 0
    assert not (store.root / "nothing").exists()


def test_drafts_are_not_listed(store):
    with store.draft(stage="plan", stage_version=1, experiment="a", parameters={}) as draft:
        assert isinstance(draft, Draft)
        page = store.find(Query())
        assert (page.entries, page.drafts) == ((), (draft.staging,))
    page = store.find(Query())
    assert ([one.run for one in page.entries], page.drafts) == ([draft.run_id], ())


READER = """
import sys
from pathlib import Path
from slidepipe.artifacts.index import Index
from slidepipe.artifacts.query import Query
index, last = Index(Path(sys.argv[1])), 0
for _ in range(30):
    count = len(index.find(Query()).entries)
    assert count >= last, (count, last)
    last = count
print(last)
"""


def test_readers_make_the_index_together(store):
    runs = [publish(store).id for _ in range(5)]
    command = [sys.executable, "-c", READER, str(store.root)]
    readers = [subprocess.Popen(command, stdout=subprocess.PIPE, text=True) for _ in range(3)]  # noqa: S603
    for reader in readers:
        assert reader.stdout is not None
        assert os.waitstatus_to_exitcode(os.waitpid(reader.pid, 0)[1]) == 0
        assert reader.stdout.read() == "5\n"
        reader.stdout.close()
        reader.returncode = 0
    assert listed(store) == runs
