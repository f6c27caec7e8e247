"""Whatever is changed in a store is found; what can be put right without guessing is."""

import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from slidepipe.artifacts.recording_writer import RecordingWriter
from slidepipe.artifacts.repair import find_fixes
from slidepipe.artifacts.run import Run
from slidepipe.artifacts.seal import SEAL, read_seal
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.verify import verify_store

RELEASED = Path(__file__).parent / "released"


@pytest.fixture
def store(tmp_path: Path) -> Store:
    return Store(tmp_path / "data")


@pytest.fixture
def plan(store: Store) -> Run:
    with store.draft(stage="plan", stage_version=1, experiment="a", parameters={"friction": 0.38}, seed=3) as draft:
        shutil.copy(RELEASED / "plan-1.yaml", draft.add("plan", "plan.yaml"))
        with RecordingWriter(draft.add("reference", "reference.mcap"), {"run": draft.run_id}, {"a": b"x" * 500}):
            pass
    return draft.run


@pytest.fixture
def trial(store: Store, plan: Run) -> Run:
    with store.draft(
        stage="execute", stage_version=1, experiment="a", parameters={}, inputs=[plan.input("plan")]
    ) as draft:
        shutil.copy(RELEASED / "trial-1.yaml", draft.add("trial", "trial.yaml"))
    return draft.run


def problems(store: Store) -> list[str]:
    return [f"{one.run} {one.file.name}: {one.problem}" for one in verify_store(store)]


@pytest.mark.usefixtures("trial")
def test_a_whole_store(store, plan) -> None:
    assert problems(store) == []
    assert set(read_seal(plan.directory)) >= {"run.yaml", "plan.yaml", "reference.mcap"}


@pytest.mark.skipif(shutil.which("sha256sum") is None, reason="there is no sha256sum")
def test_the_seal_is_checked_without_slidepipe(plan) -> None:
    def check() -> int:
        command = ["sha256sum", "--check", "--status", SEAL]
        return subprocess.run(command, cwd=plan.directory, check=False).returncode  # noqa: S603

    assert check() == 0
    edit(plan.directory / "run.yaml", "seed: 3", "seed: 4")
    assert check() == 1


def edit(path: Path, old: str, new: str) -> None:
    text = path.read_text()
    assert text.count(old) == 1
    path.write_text(text.replace(old, new))


def flip(path: Path, where: float) -> None:
    data = bytearray(path.read_bytes())
    data[int(where * len(data))] ^= 4
    path.write_bytes(data)


@pytest.mark.parametrize("name", ["plan.yaml", "reference.mcap", "run.yaml", "run.sha256"])
@pytest.mark.parametrize("where", [0.05, 0.3, 0.5, 0.7, 0.95])
def test_a_flipped_bit(store, plan, name: str, where: float) -> None:
    flip(plan.directory / name, where)
    found = list(verify_store(store))
    assert found
    assert {one.run for one in found} == {plan.id}
    assert name in {one.file.name for one in found} or name == "run.sha256"


@pytest.mark.parametrize("name", ["plan.yaml", "reference.mcap", "run.sha256"])
def test_a_missing_file(store, plan, name: str) -> None:
    (plan.directory / name).unlink()
    (found,) = verify_store(store)
    assert (found.run, found.file.name) == (plan.id, name)
    assert found.problem.startswith("is missing")


def test_a_missing_manifest(store, plan) -> None:
    (plan.directory / "run.yaml").unlink()
    assert problems(store) == [f"{plan.id} run.yaml: no such file"]


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("friction: 0.38", "friction: 0.39"),
        ("seed: 3", "seed: 4"),
        ("state: complete", "state: lost"),
        ("command: []", "command: [x]"),
    ],
)
def test_an_edited_manifest(store, plan, old: str, new: str) -> None:
    edit(plan.directory / "run.yaml", old, new)
    assert f"{plan.id} run.yaml: was edited: its sha256 is not the one in run.sha256" in problems(store)


def test_an_edited_manifest_whose_seal_was_made_anew_breaks_its_recipe(store, plan) -> None:
    edit(plan.directory / "run.yaml", "friction: 0.38", "friction: 0.39")
    (plan.directory / SEAL).unlink()
    (seal,) = [fix for fix in find_fixes(store) if fix.file.name == SEAL] or [None]
    assert seal is None, "it is not sealed again either"
    assert [line.partition(": ")[2] for line in problems(store)] == [
        "is missing: nobody can tell whether the manifest was edited",
        "recipe: is not the hash of the stage, parameters, inputs and seed that stand there",
    ]


def test_a_dangling_input(store, plan, trial) -> None:
    shutil.rmtree(plan.directory)
    assert problems(store) == [f"{trial.id} run.yaml: input plan: run {plan.id} is not in the store"]


def test_an_input_that_is_another_file_by_now(store, plan, trial) -> None:
    (plan.directory / "plan.yaml").write_bytes((RELEASED / "trial-1.yaml").read_bytes())
    text = (plan.directory / "run.yaml").read_text()
    other = trial.sha256("trial")
    (plan.directory / "run.yaml").write_text(text.replace(plan.sha256("plan"), other))
    assert f"{trial.id} run.yaml: input plan: {plan.id}/plan.yaml is not the file that went in" in problems(store)


def test_a_stranger_in_a_run(store, plan) -> None:
    (plan.directory / "notes.txt").write_text("mine")
    (plan.directory / ".DS_Store").write_text("")
    assert problems(store) == [f"{plan.id} notes.txt: is not one of the run's files in run.yaml"]


def test_a_document_that_never_was_right(store) -> None:
    with store.draft(stage="plan", stage_version=1, experiment="a", parameters={}) as draft:
        draft.add("plan", "plan.yaml").write_text("schema: slidepipe.plan/1\nexperiment: 3\n")
    lines = problems(store)
    assert f"{draft.run_id} plan.yaml: 2:1: experiment: must be text, got 3" in lines


def test_names_and_notes(store, plan) -> None:
    store.refs.set("best", plan)
    (store.root / "annotations.jsonl").write_text("{}\n")
    shutil.rmtree(plan.directory)
    assert [line.partition(" ")[0] for line in problems(store)] == ["refs", "annotations"]


@pytest.mark.parametrize("spoil", [Path.unlink, lambda path: flip(path, 0.5)])
def test_a_file_is_restored_from_where_its_bytes_are(store, plan, spoil: Callable[[Path], object]) -> None:
    with store.draft(stage="plan", stage_version=1, experiment="b", parameters={}) as draft:
        shutil.copy(plan.file("plan"), draft.add("plan", "plan.yaml"))
    spoil(plan.file("plan"))
    (fix,) = find_fixes(store)
    assert (fix.run, fix.file) == (plan.id, plan.file("plan"))
    fix.apply()
    assert problems(store) == []
    assert list(find_fixes(store)) == []


def test_a_missing_seal_is_made(store, plan) -> None:
    (plan.directory / SEAL).unlink()
    (fix,) = find_fixes(store)
    fix.apply()
    assert problems(store) == []


def test_what_has_no_copy_is_left(store, plan) -> None:
    flip(plan.file("reference"), 0.5)
    assert list(find_fixes(store)) == []
    assert problems(store) != []
