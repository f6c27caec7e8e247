import hashlib
import re
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from slidepipe.artifacts.manifest import InputRef, RunState
from slidepipe.artifacts.run import Run, outside_input, read_run
from slidepipe.artifacts.store import Store
from slidepipe.errors import InfeasibleError, InputError, NewerSchemaError, NotFoundError, StoreError


def publish(store: Store, content: str = "a: 1\n", **changes: object) -> Run:
    asked = {
        "stage": "plan",
        "stage_version": 1,
        "experiment": "paper_linear",
        "parameters": {"friction": 0.38},
    } | changes
    with store.draft(**asked) as draft:
        draft.add("plan", "plan.yaml").write_text(content)
    return draft.run


@pytest.fixture
def store(tmp_path: Path) -> Store:
    return Store(tmp_path / "data")


def test_a_run_has_its_place_and_its_manifest(store):
    made = InputRef(role="experiment", sha256="0" * 64, size=3, run=None, file="experiments/a.yaml")
    with store.draft(
        stage="estimate",
        stage_version=3,
        experiment="paper_linear",
        parameters={"window_s": 0.1, "names": ["a", "b"]},
        inputs=[made],
        seed=7,
        command=["slidepipe", "estimate"],
    ) as draft:
        draft.add("estimate", "estimate.yaml").write_text("mu: 0.38\n")
        draft.path("notes.txt").write_text("hello")
        draft.report("friction", 0.38, std=0.01, unit="1")
        assert store.runs() == []
        assert draft.staging.name == f".tmp-{draft.run_id}"
        assert not draft.final.exists()
    run = draft.run
    assert re.fullmatch(r"\d{8}T\d{6}Z-[0-9a-hjkmnp-tv-z]{8}", run.id)
    day = f"{run.id[:4]}-{run.id[4:6]}-{run.id[6:8]}"
    assert run.directory == store.root / "runs" / day / run.id
    assert {path.name for path in run.directory.iterdir()} - {"diff.patch"} == {
        "run.yaml",
        "estimate.yaml",
        "notes.txt",
        "run.sha256",
    }
    assert (store.root / "store.yaml").read_text() == "schema: slidepipe.store/1\n"
    assert run.file("estimate").read_text() == "mu: 0.38\n"
    assert run.sha256("estimate") == hashlib.sha256(b"mu: 0.38\n").hexdigest()
    manifest = run.manifest
    assert manifest.state is RunState.COMPLETE
    assert (manifest.stage, manifest.stage_version, manifest.seed) == ("estimate", 3, 7)
    assert manifest.inputs == (made,)
    assert {output.role for output in manifest.outputs} >= {"estimate", "other-1"}
    assert manifest.results[0].model_dump() == {"name": "friction", "value": 0.38, "std": 0.01, "unit": "1"}
    assert manifest.command == ("slidepipe", "estimate")
    assert manifest.error is None
    assert manifest.environment.packages["numpy"]
    assert manifest.times.started <= manifest.times.finished
    assert store.get(run.id) == run == read_run(run.directory)


@settings(max_examples=20, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    parameters=st.dictionaries(
        st.text(),
        st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text(),
    ),
    content=st.binary(max_size=50),
    seed=st.none() | st.integers(0, 2**63),
    result=st.floats(allow_nan=False, allow_infinity=False),
)
def test_any_run_comes_back_equal(store, parameters, content, seed, result):
    with store.draft(stage="plan", stage_version=1, experiment="a", parameters=parameters, seed=seed) as draft:
        draft.add("blob", "blob.bin").write_bytes(content)
        draft.report("x", result, unit="m")
    back = store.get(draft.run_id)
    assert back == draft.run
    assert back.manifest.parameters == parameters
    assert back.file("blob").read_bytes() == content
    assert store.find_recipe(draft.recipe).id == draft.run_id


def test_runs_are_listed_in_order_of_finishing(store):
    with store.draft(stage="run", stage_version=1, experiment="a", parameters={}) as outer:
        first, second = publish(store), publish(store, stage="execute", experiment="b")
    assert [run.id for run in store.runs()] == [first.id, second.id, outer.run_id]
    assert [run.id for run in store.runs(stage="execute")] == [second.id]
    assert [run.id for run in store.runs(experiment="paper_linear")] == [first.id]
    assert store.get("@latest").id == outer.run_id
    assert store.get("@latest:plan").id == first.id


def test_the_latest_of_a_stage_says_what_came_after_it(store):
    told = []
    listening = Store(store.root, told.append)
    with (
        pytest.raises(RuntimeError),
        store.draft(stage="execute", stage_version=1, experiment="a", parameters={}) as bad,
    ):
        raise RuntimeError
    with pytest.raises(NotFoundError) as caught:
        listening.get("@latest:execute")
    assert str(caught.value) == (
        f"run @latest:execute: there is none in {store.root} that ran to its end; {bad.run_id} is failed: "
        "name it by its id"
    )
    good = publish(store, stage="execute")
    assert listening.get("@latest:execute").id == good.id
    assert told == []
    with store.draft(stage="execute", stage_version=1, experiment="a", parameters={}) as stopped:
        stopped.state = RunState.STOPPED
    assert listening.get("@latest:execute").id == good.id
    assert told == [f"@latest:execute: {good.id}; after it came {stopped.run_id}, which is stopped"]


def test_references(store, monkeypatch):
    ids = iter(["20261123T093012Z-k3f9q2aw", "20261123T093012Z-k3zzzzzz"])
    monkeypatch.setattr("slidepipe.artifacts.draft.new_run_id", lambda _: next(ids))
    monkeypatch.setattr(
        "slidepipe.artifacts.draft.Draft.final", property(lambda self: self.runs / "2026-11-23" / self.run_id)
    )
    first, second = publish(store), publish(store)
    assert store.get("20261123T093012Z-k3f").id == first.id
    assert store.get("k3z").id == second.id
    assert store.get(str(first.directory)).id == first.id
    with pytest.raises(NotFoundError) as caught:
        store.get("k3")
    assert str(caught.value) == f"run k3: may be {first.id}, {second.id}"
    for reference in ("x", "", "@latest:execute", "@first", str(store.root / "nothing")):
        with pytest.raises(NotFoundError) as caught:
            store.get(reference)
        assert "\n" not in str(caught.value)
    with pytest.raises(NotFoundError) as caught:
        first.file("trial")
    assert str(caught.value).startswith(f"run {first.id} of stage plan: has no trial, its files are: plan")


def test_an_empty_store_is_not_made_by_looking(store):
    assert store.runs() == []
    with pytest.raises(NotFoundError, match=r"^run @latest: there is none in "):
        store.get("@latest")
    assert not store.root.exists()


def publish_and_fail(store: Store, error: BaseException) -> None:
    with store.draft(stage="plan", stage_version=1, experiment="a", parameters={}) as draft:
        draft.add("plan", "plan.yaml")
        draft.add("reference", "reference.mcap").write_bytes(b"half")
        raise error


def test_wrong_input_leaves_nothing(store):
    with pytest.raises(InputError):
        publish_and_fail(store, InputError("a.yaml:1:1: wrong"))
    assert not store.root.exists()
    kept = publish(store)
    with pytest.raises(InputError):
        publish_and_fail(store, InputError("a.yaml:1:1: wrong"))
    assert [path.name for path in kept.directory.parent.iterdir()] == [kept.id]


@pytest.mark.parametrize(
    ("error", "state"),
    [
        (InfeasibleError("too fast", "too far"), RunState.FAILED),
        (ZeroDivisionError("x"), RunState.FAILED),
        (KeyboardInterrupt(), RunState.INTERRUPTED),
        (SystemExit(3), RunState.INTERRUPTED),
    ],
)
def test_other_errors_are_published_and_go_on(store, error, state):
    with pytest.raises(type(error)):
        publish_and_fail(store, error)
    manifest = store.get("@latest").manifest
    assert manifest.state is state
    assert (manifest.error.type, manifest.error.message) == (type(error).__name__, str(error))
    assert [output.role for output in manifest.outputs if output.file != "diff.patch"] == ["reference"]
    assert store.find_recipe(manifest.recipe) is None


def test_a_lost_block_is_data(store):
    with store.draft(stage="execute", stage_version=1, experiment="a", parameters={}) as draft:
        draft.state = RunState.LOST
    assert store.get("@latest").manifest.state is RunState.LOST


def test_an_announced_file_must_be_written(store):
    with (
        pytest.raises(StoreError, match=r"plan.yaml was announced and never written$"),
        store.draft(stage="plan", stage_version=1, experiment="a", parameters={}) as draft,
    ):
        draft.add("plan", "plan.yaml")
    assert store.get(draft.run_id).manifest.state is RunState.FAILED


@pytest.mark.parametrize("name", ["../x", "a/b", ".hidden", "run.yaml", "diff.patch", ""])
def test_names_stay_inside(store, name):
    with (
        pytest.raises(StoreError, match="cannot be the name of a run's file"),
        store.draft(stage="plan", stage_version=1, experiment="a", parameters={}) as draft,
    ):
        draft.path(name)


def test_results_are_finite(store):
    with (
        pytest.raises(StoreError, match=r"result mu must be finite, got nan \+- None"),
        store.draft(stage="plan", stage_version=1, experiment="a", parameters={}) as draft,
    ):
        draft.report("mu", float("nan"), unit="1")


def test_recipes(store, tmp_path):
    source = tmp_path / "a.yaml"
    source.write_text("x")
    base = publish(store, inputs=[outside_input("experiment", source)])
    elsewhere = tmp_path / "b.yaml"
    elsewhere.write_text("x")
    same = publish(store, inputs=[outside_input("experiment", elsewhere)], command=["other"], experiment="b")
    assert same.manifest.recipe == base.manifest.recipe
    assert store.find_recipe(base.manifest.recipe).id == same.id
    elsewhere.write_text("y")
    others = [
        publish(store, inputs=[outside_input("experiment", elsewhere)]),
        publish(store, inputs=[outside_input("other", source)]),
        publish(store, inputs=[outside_input("experiment", source)], seed=1),
        publish(store, inputs=[outside_input("experiment", source)], stage_version=2),
        publish(store, inputs=[outside_input("experiment", source)], stage="iterate"),
        publish(store, inputs=[outside_input("experiment", source)], parameters={"friction": 0.39}),
    ]
    assert len({run.manifest.recipe for run in [base, *others]}) == 1 + len(others)
    assert store.find_recipe("0" * 64) is None


def test_a_damaged_run_is_not_reused(store):
    first, second = publish(store), publish(store)
    recipe = first.manifest.recipe
    assert store.find_recipe(recipe).id == second.id
    second.file("plan").write_text("a: 2\n")
    assert store.find_recipe(recipe).id == first.id
    first.file("plan").unlink()
    assert store.find_recipe(recipe) is None


def test_an_output_is_the_input_of_the_next_run(store):
    plan = publish(store)
    trial = publish(store, stage="execute", inputs=[plan.input("plan")])
    assert trial.manifest.inputs[0].model_dump() == {
        "role": "plan", "sha256": plan.sha256("plan"), "size": 5, "run": plan.id, "file": "plan.yaml",
    }  # fmt: skip


def test_damage_is_told_and_does_not_hide_the_rest(store):
    sound, broken = publish(store), publish(store)
    path = broken.directory / "run.yaml"
    path.write_text(path.read_text().replace("stage: plan", "stage: 3"))
    survey = store.survey()
    assert survey.runs == (sound,)
    assert len(survey.faults) == 1
    assert re.fullmatch(rf"{re.escape(str(path))}:3:1: stage: must be text, got 3", survey.faults[0])
    with pytest.raises(StoreError, match=r"stage: must be text, got 3 \(1 damaged: repair or move away\)$"):
        store.runs()
    path.write_text((sound.directory / "run.yaml").read_text())
    with pytest.raises(StoreError, match=rf"run: must be {broken.id} as its directory, got {sound.id}$"):
        store.get(broken.id)
    path.unlink()
    assert len(store.survey().faults) == 1


def test_newer_stores_and_runs_are_refused(store):
    run = publish(store)
    path = run.directory / "run.yaml"
    path.write_text(path.read_text().replace("slidepipe.run/1", "slidepipe.run/2"))
    with pytest.raises(NewerSchemaError, match=r"slidepipe.run/2 was written by a newer slidepipe"):
        store.get(run.id)
    (store.root / "store.yaml").write_text("schema: slidepipe.store/2\n")
    with pytest.raises(
        NewerSchemaError, match=r"store.yaml:1:1: schema: slidepipe.store/2 was written by a newer slidepipe"
    ):
        Store(store.root)
    (store.root / "store.yaml").write_text("layout: 1\n")
    with pytest.raises(StoreError, match=r"store.yaml:1:1: schema: required key is missing"):
        Store(store.root)


def test_a_file_is_no_store(tmp_path):
    (tmp_path / "data").touch()
    with pytest.raises(InputError, match=r"data: is a file, the store is a directory$"):
        Store(tmp_path / "data")
