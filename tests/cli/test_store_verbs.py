"""The verbs around the store, to the letter where a person reads them."""

import json
import re
from pathlib import Path

import pytest
from click.testing import CliRunner
from jsonschema import Draft202012Validator
from jsonschema.exceptions import ValidationError

from cli import samples
from slidepipe.artifacts.documents import DOCUMENTS
from slidepipe.artifacts.manifest import RunState
from slidepipe.artifacts.run import Run
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.strict_yaml import load
from slidepipe.cli.main import cli

ROOT = Path(__file__).resolve().parents[2]
RELEASED = ROOT / "tests" / "artifacts" / "released"


@pytest.fixture
def store(tmp_path: Path) -> Store:
    return Store(tmp_path / "data")


def make(store: Store, stage: str = "plan", *inputs: Run, **changes: object) -> Run:
    asked = {"stage_version": 1, "experiment": "regrasp", "parameters": {"friction": 0.38}} | changes
    with store.draft(stage=stage, inputs=[run.input("blob") for run in inputs], **asked) as draft:
        draft.add("blob", "blob.bin").write_bytes(stage.encode())
        draft.report("believed_friction", asked["parameters"]["friction"], std=0.01, unit="1")
        draft.report("duration", 0.84, unit="s")
    return draft.run


def test_log(call, store) -> None:
    plan = make(store)
    trial = make(store, "execute", plan)
    estimate = make(store, "estimate", trial)
    result = call("log", "@latest")
    assert (result.exit_code, result.stderr) == (0, "")
    assert result.stdout == (
        f"{estimate.id}  estimate  regrasp  believed_friction 0.38\n"
        f"{trial.id}  execute  regrasp  believed_friction 0.38\n"
        f"{plan.id}  plan  regrasp  believed_friction 0.38\n"
    )
    told = json.loads(call("log", "@latest", "--json").stdout)
    assert (told["schema"], told["run"]) == ("slidepipe.ancestry/1", estimate.id)
    assert [(one["run"], one["parents"]) for one in told["ancestors"]] == [
        (estimate.id, [trial.id]),
        (trial.id, [plan.id]),
        (plan.id, []),
    ]


def test_log_branches_where_a_run_was_made_from_several(call, store) -> None:
    plan = make(store, experiment="as_long_as_a_name_of_an_experiment_may_be_so_that_it_is_wide")
    first, second = make(store, "execute", plan), make(store, "estimate", plan)
    make(store, "pool", first, second)
    lines = call("log", "@latest").stdout.splitlines()
    newer, older = sorted((first, second), key=lambda run: run.id, reverse=True)
    ids = [(line[:4], line.removeprefix(line[:4]).split()[0]) for line in lines[1:]]
    assert ids == [("├── ", newer.id), ("│   ", plan.id), ("└── ", older.id), ("    ", plan.id)]
    assert lines[2].endswith("so_that_it_is_wide  believed_friction 0.38")
    assert lines[4].endswith("(see above)")


def test_diff(call, store) -> None:
    old = make(store)
    new = make(store, parameters={"friction": 0.4}, seed=2)
    result = call("diff", old.id, new.id)
    assert (result.exit_code, result.stderr) == (0, "")
    assert result.stdout == (
        f"before  {old.id}  plan regrasp\n"
        f"after   {new.id}  plan regrasp\n"
        "\n"
        "asked     before  after\n"
        "───────────────────────\n"
        "seed      -       2\n"
        "friction  0.38    0.4\n"
        "\n"
        "result                  before       after  change  unit\n"
        "────────────────────────────────────────────────────────\n"
        "believed_friction  0.38 ± 0.01  0.4 ± 0.01   +0.02\n"
        "duration                  0.84        0.84      +0  s\n"
    )
    told = json.loads(call("diff", old.id, new.id, "--json").stdout)
    assert (told["schema"], told["same_recipe"], told["code"]) == ("slidepipe.difference/1", False, [])
    assert told["task"][1] == {"name": "friction", "before": 0.38, "after": 0.4}
    assert told["results"][1]["unit"] == "s"
    assert "the same recipe" in call("diff", old.id, old.id).stdout


def test_verify(call, store) -> None:
    whole, broken = make(store), make(store)
    result = call("verify")
    assert (result.exit_code, result.stdout, result.stderr) == (0, "", "checked 2 runs: all whole\n")
    (broken.directory / "blob.bin").write_bytes(b"lump")
    result = call("verify")
    path = f"data/runs/{broken.id[:4]}-{broken.id[4:6]}-{broken.id[6:8]}/{broken.id}/blob.bin"
    problem = "was changed: its sha256 is not the one that it was published with"
    assert (result.exit_code, result.stdout) == (5, f"{path}: {problem}\n")
    assert result.stderr == "checked 2 runs: 1 faults in 1\n"
    told = json.loads(call("verify", "--json").stdout)
    assert told == {
        "schema": "slidepipe.verification/1",
        "checked": 2,
        "findings": [{"run": broken.id, "file": path, "problem": problem}],
    }
    assert call("verify", whole.id).exit_code == 0
    assert call("verify", whole.id, broken.id).exit_code == 5


def test_repair(call, store) -> None:
    whole, broken = make(store), make(store)
    (broken.directory / "blob.bin").unlink()
    result = call("repair")
    assert (result.exit_code, result.stderr) == (0, "1 can be repaired (--apply does it), 0 cannot\n")
    assert result.stdout.rstrip().endswith(f"{whole.id}/blob.bin, which has its sha256")
    assert call("verify").exit_code == 5, "nothing was done yet"
    told = json.loads(call("repair", "--apply", "--json").stdout)
    assert (told["schema"], told["applied"], len(told["fixes"]), told["left"]) == (
        "slidepipe.repair_result/1",
        True,
        1,
        [],
    )
    assert call("verify").exit_code == 0
    assert call("repair").stderr == "nothing to repair\n"
    (whole.directory / "run.sha256").unlink()
    (whole.directory / "blob.bin").write_bytes(b"x")
    (broken.directory / "blob.bin").write_bytes(b"x")
    result = call("repair", "--apply")
    assert result.exit_code == 5
    assert result.stderr.endswith("0 repaired, 3 cannot\n")


def test_gc(call, store) -> None:
    old, new = make(store), make(store)
    assert call("gc").stderr == "0 may go, 0 B; 2 are kept\n"
    result = call("gc", "--before", "0m")
    assert (result.exit_code, re.sub(r"[\d.]+ kB", "N kB", result.stderr)) == (
        0,
        "1 may go, N kB (--apply moves them to the trash); 1 are kept\n",
    )
    assert result.stdout.splitlines()[2].startswith(old.id)
    told = json.loads(call("gc", "--before", "0m", "--apply", "--json").stdout)
    assert (told["schema"], told["applied"], told["kept"]) == ("slidepipe.sweep/1", True, 1)
    assert Path(told["moved_to"][0]).joinpath("run.yaml").is_file()
    assert [line.split()[0] for line in call("ls").stdout.splitlines()[2:] if line.startswith("2")] == [new.id]


def test_ref(call, store) -> None:
    run = make(store)
    assert (call("ref").stdout, call("ref").stderr) == ("", "no names\n")
    assert call("ref", "best", "@latest").stdout == f"@regrasp/best  {run.id}\n"
    assert call("ref", "best").stdout == call("ref").stdout == f"@regrasp/best  {run.id}\n"
    assert json.loads(call("ref", "--json").stdout) == {
        "schema": "slidepipe.refs/1",
        "refs": [{"experiment": "regrasp", "name": "best", "run": run.id}],
        "deleted": False,
    }
    assert call("show", "@best").exit_code == 0
    assert call("ref", "best", "--delete").stdout == f"@regrasp/best  {run.id}  (taken away)\n"
    result = call("show", "@best")
    assert (result.exit_code, result.stderr) == (
        4,
        "error: run @best: no such name, there are @latest, @latest:STAGE; did you mean @latest?\n",
    )
    assert call("ref", "latest", run.id).exit_code == 3
    assert call("ref", "--delete").exit_code == 2


def test_annotate(call, store) -> None:
    run = make(store)
    assert call("annotate", "@latest").stderr == f"run {run.id} has no notes\n"
    line = call("annotate", "@latest", "new fingertips", "--verdict", "good", "--author", "me").stdout
    assert re.fullmatch(r"\d{4}-\d\d-\d\dT[\d:.]{15}Z me good new fingertips\n", line)
    told = json.loads(call("annotate", "@latest", "--json").stdout)
    assert (told["schema"], told["run"], len(told["annotations"])) == ("slidepipe.annotations/1", run.id, 1)
    assert line.strip() in call("show", "@latest").stdout
    assert json.loads(call("show", "@latest", "--json").stdout)["annotations"] == told["annotations"]


def test_ls_filters_by_state_and_time(call, publish) -> None:
    publish(samples.plan_run())
    publish(samples.failed_run())

    def ids(*arguments: str) -> list[str]:
        return [one["run"] for one in json.loads(call("ls", "--json", *arguments).stdout)["runs"]]

    assert ids("--state", "failed") == [samples.TRIAL]
    assert ids("--state", "failed", "--state", "complete") == [samples.PLAN, samples.TRIAL]
    assert ids("--since", "2026-11-24T09:30:15") == [samples.TRIAL]
    assert ids("--until", "2026-11-24T10:30:15+01:00") == [samples.PLAN]
    assert ids("--until", "2026-11-24") == []
    assert ids("--limit", "1") == [samples.TRIAL]
    assert call("ls", "--limit", "1").stderr == "the last 1 of 2 runs (--limit 0 lists all)\n"
    result = call("ls", "--since", "yesterday")
    assert result.exit_code == 2
    assert "'yesterday' is no time: 2026-11-24, 2026-11-24T09:30, or 3d, 12h, 30m ago" in result.stderr


def test_references_that_mean_nothing_or_several(call, publish) -> None:
    publish(samples.plan_run())
    publish(samples.failed_run())
    result = call("show", "20261124T0930")
    assert (result.exit_code, result.stderr) == (
        4,
        f"error: run 20261124T0930: may be {samples.PLAN}, {samples.TRIAL}\n",
    )
    result = call("log", "20270101T000000Z-k3f9q2aw")
    assert (result.exit_code, result.stderr) == (
        4,
        "error: run 20270101T000000Z-k3f9q2aw: there is none in data\n",
    )


def test_why_it_was_computed_is_said(call, stages, store) -> None:
    old = make(store)
    stages.answers["plan"].run = make(store)
    result = call("plan", "e.yaml", "--force")
    assert result.stderr == (f"computed anew (--force), though run {old.id} has the same parameters, inputs and code\n")


@pytest.mark.parametrize("name", DOCUMENTS)
def test_released_documents_satisfy_their_json_schema(call, name: str) -> None:
    schema = json.loads(call("schema", name).stdout)
    Draft202012Validator.check_schema(schema)
    document = load(RELEASED / f"{name}-{DOCUMENTS[name].VERSION}.yaml").data
    Draft202012Validator(schema).validate(document)
    with pytest.raises(ValidationError):
        Draft202012Validator(schema).validate(document | {"unknown": 1})
    with pytest.raises(ValidationError):
        Draft202012Validator(schema).validate(document | {"schema": "slidepipe.other/1"})


@pytest.mark.parametrize("path", sorted((ROOT / "experiments").glob("*.yaml")), ids=lambda path: path.stem)
def test_the_shipped_experiments_satisfy_theirs(call, path: Path) -> None:
    document = load(path).data
    kind = document["schema"].removeprefix("slidepipe.").partition("/")[0]
    schema = json.loads(call("schema", kind, "--json").stdout)["json_schema"]
    Draft202012Validator(schema).validate(document)
    owner = document if kind == "one_dof" else document["object"]
    owner["mass_kg"] = -1
    with pytest.raises(ValidationError, match="-1 is less than or equal to the minimum of 0"):
        Draft202012Validator(schema).validate(document)


def test_schemas_are_listed_and_written(call, tmp_path: Path) -> None:
    lines = call("schema").stdout.splitlines()
    assert [line.split()[0] for line in lines] == list(DOCUMENTS)
    assert [one["name"] for one in json.loads(call("schema", "--json").stdout)["documents"]] == list(DOCUMENTS)
    result = call("schema", "plan", "--out", "plan.json")
    assert (result.exit_code, result.stdout) == (0, "")
    assert result.stderr.splitlines()[-1] == "# yaml-language-server: $schema=plan.json"
    assert json.loads((tmp_path / "plan.json").read_text())["title"] == "slidepipe.plan/2"
    assert call("schema", "plan", "--out", "no/such/plan.json").exit_code == 3
    result = call("schema", "plans")
    assert (result.exit_code, result.stderr) == (
        4,
        f"error: schema plans: no such document, there are {', '.join(DOCUMENTS)}\n",
    )


def completed(*words: str) -> list[str]:
    environment = {
        "_SLIDEPIPE_COMPLETE": "bash_complete",
        "COMP_WORDS": " ".join(("slidepipe", *words)),
        "COMP_CWORD": str(len(words)),
    }
    result = CliRunner().invoke(cli, [], prog_name="slidepipe", env=environment)
    return [line.partition(",")[2] for line in result.stdout.splitlines()]


@pytest.mark.usefixtures("call")
def test_completion(store, tmp_path: Path) -> None:
    first, second = make(store), make(store, "execute")
    store.refs.set("best", first)
    assert completed("show", "20") == [second.id, first.id]
    assert completed("show", first.id.partition("-")[2][:7]) == [first.id]
    assert completed("show", "@") == [
        *("@latest", "@latest:plan", "@latest:execute", "@latest:estimate", "@latest:iterate", "@latest:run", "@best"),
    ]
    assert completed("diff", first.id, "20") == [second.id, first.id]
    assert completed("ls", "--experiment", "") == ["regrasp"]
    assert completed("ls", "--stage", "e") == ["execute", "estimate"]
    assert completed("schema", "pl") == ["plan"]
    assert completed("--data", str(tmp_path / "elsewhere"), "show", "20") == ["20"], "else a file"


def test_a_lost_run_is_listed_as_such(call, store) -> None:
    with store.draft(stage="execute", stage_version=1, experiment="a", parameters={}) as draft:
        draft.state = RunState.LOST
    assert json.loads(call("ls", "--json").stdout)["runs"][0]["state"] == "lost"


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("@latest:plann", "of the stages there is plan; did you mean plan?"),
        ("regrasp", "it is an experiment: slidepipe ls --experiment regrasp lists its runs"),
    ],
)
def test_a_name_that_is_not_there_is_told_with_what_there_is(call, publish, name: str, told: str) -> None:
    publish(samples.plan_run())
    result = call("show", name)
    assert (result.exit_code, result.stderr) == (4, f"error: run {name}: there is none in data; {told}\n")
