"""Names, notes, ancestry, differences, and what is kept when the rest goes."""

import json
import os
import re
import subprocess
import sys
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest

from slidepipe.artifacts.ancestry import ancestry, direct
from slidepipe.artifacts.annotations import Annotations, annotation_of
from slidepipe.artifacts.difference import Change, difference
from slidepipe.artifacts.gc import find_garbage, sweep
from slidepipe.artifacts.manifest import RunState
from slidepipe.artifacts.reuse import equal_before, what_changed
from slidepipe.artifacts.run import Run, outside_input
from slidepipe.artifacts.store import Store
from slidepipe.errors import InputError, NotFoundError, StoreError

SOON = datetime.now(UTC) + timedelta(days=1)


@pytest.fixture
def store(tmp_path: Path) -> Store:
    return Store(tmp_path / "data")


def publish(store: Store, stage: str = "plan", *inputs: Run, **changes: object) -> Run:
    asked = {"stage_version": 1, "experiment": "a", "parameters": {}} | changes
    asked["inputs"] = [*asked.get("inputs", ()), *(run.input("blob") for run in inputs)]
    state = asked.pop("state", RunState.COMPLETE)
    with store.draft(stage=stage, **asked) as draft:
        draft.add("blob", "blob.bin").write_bytes(os.urandom(8))
        draft.report("error", asked["stage_version"] * 0.001, unit="m")
        draft.state = state
    return draft.run


def test_names(store) -> None:
    first, second = publish(store), publish(store)
    other = publish(store, experiment="b")
    assert store.refs.all() == ()
    store.refs.set("best", first)
    assert store.get("@best").id == first.id
    assert (store.root / "refs" / "a" / "best").read_text() == f"{first.id}\n"
    store.refs.set("best", second)
    assert store.get("@best").id == second.id
    store.refs.set("best", other)
    with pytest.raises(NotFoundError, match=r"^run @best: may be @a/best, @b/best$"):
        store.get("@best")
    assert store.get("@b/best").id == other.id
    store.refs.delete("b/best")
    assert [(ref.experiment, ref.name, ref.run) for ref in store.refs.all()] == [("a", "best", second.id)]
    with pytest.raises(NotFoundError, match=r"^run @worst: no such name, there are @latest, @latest:STAGE, @best$"):
        store.get("@worst")


@pytest.mark.parametrize("name", ["latest", "", "a/b", "../x", ".x", "A", "x" * 65])
def test_what_is_no_name(store, name: str) -> None:
    run = publish(store)
    with pytest.raises(InputError, match=r"^name .*: must begin with"):
        store.refs.set(name, run)


def test_a_damaged_name(store) -> None:
    store.refs.set("best", publish(store))
    (store.root / "refs" / "a" / "best").write_text("yesterday\n")
    with pytest.raises(StoreError, match=r"best: must hold one line, a run id, got 'yesterday'$"):
        store.get("@best")


def test_notes_are_only_added(store) -> None:
    run, other = publish(store), publish(store)
    for verdict, note in (("good", "new fingertips"), (None, "ein Wort: größer"), ("good", "new fingertips")):
        store.annotations.add(annotation_of(run.id, author="me", verdict=verdict, note=note))
    assert [(one.verdict, one.note) for one in store.annotations.of(run.id)] == [
        ("good", "new fingertips"),
        (None, "ein Wort: größer"),
        ("good", "new fingertips"),
    ]
    assert store.annotations.of(other.id) == ()
    lines = (store.root / "annotations.jsonl").read_text().splitlines()
    assert [json.loads(line)["run"] for line in lines] == [run.id] * 3


def test_a_note_that_was_cut_off_spoils_no_other(store) -> None:
    run = publish(store)
    store.annotations.add(annotation_of(run.id, author="me", verdict="good", note=""))
    path = store.root / "annotations.jsonl"
    path.write_bytes(path.read_bytes() + b'{"run": "2026')
    store.annotations.add(annotation_of(run.id, author="me", verdict="bad", note=""))
    assert [one.verdict for one in store.annotations.of(run.id)] == ["good", "bad"]
    assert store.annotations.faults() == (f"{path}:2: is not a note",)


def test_a_note_that_another_machine_wrote_over_is_added_again(store, monkeypatch) -> None:
    run = publish(store)
    append, lost = Annotations._append, [True]

    def lossy(self: Annotations, line: bytes) -> None:
        if not lost.pop() if lost else True:
            append(self, line)

    monkeypatch.setattr(Annotations, "_append", lossy)
    store.annotations.add(annotation_of(run.id, author="me", verdict="good", note=""))
    assert len(store.annotations.of(run.id)) == 1


NOTER = """
import sys
from pathlib import Path
from slidepipe.artifacts.annotations import Annotations, annotation_of
for number in range(40):
    Annotations(Path(sys.argv[1])).add(annotation_of("r", author=sys.argv[2], verdict=None, note=str(number)))
"""


def test_several_writers_of_notes(tmp_path) -> None:
    path = tmp_path / "annotations.jsonl"
    command = [sys.executable, "-c", NOTER, str(path)]
    writers = [subprocess.Popen([*command, name]) for name in "abc"]  # noqa: S603
    assert [writer.wait() for writer in writers] == [0, 0, 0]
    told = sorted((one.author, int(one.note)) for one in Annotations(path).all())
    assert told == [(name, number) for name in "abc" for number in range(40)]


def test_ancestry(store, tmp_path) -> None:
    source = tmp_path / "e.yaml"
    source.write_text("x")
    plan = publish(store, "plan", inputs=[outside_input("experiment", source)])
    trial = publish(store, "execute", plan)
    estimate = publish(store, "estimate", trial)
    with store.draft(
        stage="iterate",
        stage_version=1,
        experiment="a",
        parameters={},
        inputs=[run.input("blob").model_copy(update={"role": run.manifest.stage}) for run in (estimate, plan)],
    ) as draft:
        pass
    found = ancestry(store, [draft.run])
    assert list(found) == [draft.run_id, estimate.id, plan.id, trial.id]
    assert found[draft.run_id].parents == (estimate.id, plan.id)
    assert direct(found, draft.run_id) == (estimate.id,)
    assert found[plan.id].outside == (str(source),)
    (trial.directory / "run.yaml").write_text("schema: slidepipe.run/1\n")
    assert ancestry(store, [draft.run])[trial.id].run is None


def test_difference(store) -> None:
    before = publish(store, parameters={"friction": 0.38, "lab": {"seed": 1}}, seed=1)
    after = publish(store, parameters={"friction": 0.4, "lab": {"seed": 1}, "new": True}, stage_version=2)
    found = difference(before, after)
    assert found.task == (
        Change("stage_version", 1, 2),
        Change("seed", 1, None),
        Change("friction", 0.38, 0.4),
        Change("new", None, True),
    )
    assert found.code == ()
    (result,) = found.results
    assert (result.name, result.unit, round(result.change, 9)) == ("error", "m", 0.001)
    assert not found.same_recipe
    assert difference(before, before).task == ()


def test_inputs_of_one_role_are_counted(store) -> None:
    plans = [publish(store) for _ in range(3)]
    old, new = publish(store, "run", *plans[:2]), publish(store, "run", *plans)
    (change,) = difference(old, new).task
    assert (change.name, change.before) == ("input.blob.3", None)
    assert change.after.startswith(f"{plans[2].id} sha256 ")


def test_why_it_was_computed(store, tmp_path) -> None:
    source, elsewhere = tmp_path / "e.yaml", tmp_path / "f.yaml"
    source.write_text("x")
    elsewhere.write_text("x")
    first = publish(store, parameters={"friction": 0.38}, inputs=[outside_input("experiment", source)])
    assert (equal_before(store, first), what_changed(store, first)) == (None, None)
    again = publish(store, parameters={"friction": 0.38}, inputs=[outside_input("experiment", source)])
    assert equal_before(store, again) == first.id
    source.write_text("y")
    other = publish(store, parameters={"friction": 0.4}, inputs=[outside_input("experiment", source)])
    assert equal_before(store, other) is None
    assert what_changed(store, other) == f"unlike run {again.id}: friction was 0.38, is 0.4"
    source.write_text("z")
    bytes_only = publish(store, parameters={"friction": 0.4}, inputs=[outside_input("experiment", source)])
    assert what_changed(store, bytes_only) == f"unlike run {other.id}: another experiment went in"
    unrelated = publish(store, inputs=[outside_input("experiment", elsewhere)])
    assert what_changed(store, unrelated) is None


def test_only_what_nothing_reaches_goes(store) -> None:
    planned = [publish(store) for _ in range(5)]
    named, noted, executed, spare, latest = planned
    store.refs.set("kept", named)
    store.annotations.add(annotation_of(noted.id, author="me", verdict="good", note=""))
    trial = publish(store, "execute", executed, state=RunState.LOST)
    failed = publish(store, "execute", latest, state=RunState.FAILED)
    other = publish(store, experiment="b")
    assert find_garbage(store, before=datetime.now(UTC) - timedelta(days=1)).garbage == ()
    found = find_garbage(store, before=SOON)
    assert {one.name for one in found.garbage} == {spare.id, failed.id}
    assert {one.reason for one in found.garbage} == {
        "plan that no name, note, trial or later result reaches",
        "execute failed",
    }
    assert found.kept == 6
    assert len(store.runs()) == 8, "nothing was moved yet"
    moved = sweep(store, found)
    assert {path.name for path in moved} == {spare.id, failed.id}
    assert all(path.parent.parent == store.root / "trash" and (path / "run.yaml").exists() for path in moved)
    assert {run.id for run in store.runs()} == {named.id, noted.id, executed.id, latest.id, trial.id, other.id}
    assert find_garbage(store, before=SOON).garbage == ()


def test_what_goes_into_a_run_meanwhile_comes_back(store) -> None:
    old, _ = publish(store), publish(store)
    found = find_garbage(store, before=SOON)
    assert [one.name for one in found.garbage] == [old.id]
    trial = publish(store, "execute", old)
    assert sweep(store, found) == ()
    assert store.get(old.id).id == old.id
    assert trial.manifest.inputs[0].run == old.id


def test_nothing_goes_while_a_run_is_damaged(store) -> None:
    publish(store)
    path = publish(store).directory / "run.yaml"
    path.write_text("schema: slidepipe.run/1\n")
    with pytest.raises(StoreError, match=re.escape(f"{path}:1:1: run: required key is missing")):
        find_garbage(store, before=SOON)


KILLED = """
import os, signal, sys
from pathlib import Path
from slidepipe.artifacts.store import Store
with Store(Path(sys.argv[1])).draft(stage=sys.argv[2], stage_version=1, experiment="a", parameters={}) as draft:
    draft.add("file", sys.argv[3]).write_bytes(b"some")
    os.kill(os.getpid(), signal.SIGKILL)
"""


def test_drafts_of_the_dead_go_but_for_recordings(store) -> None:
    publish(store)
    for stage, name in (("plan", "plan.yaml"), ("execute", "trial.mcap")):
        subprocess.run([sys.executable, "-c", KILLED, str(store.root), stage, name], check=False)  # noqa: S603
    with store.draft(stage="plan", stage_version=1, experiment="a", parameters={}):
        (garbage,) = find_garbage(store, before=SOON).garbage
    assert (garbage.reason, garbage.size > 0) == ("draft of a process that was killed", True)
    assert (garbage.directory / "plan.yaml").exists()
