"""What the verbs ask of the stages, and what a program gets back."""

import json
import os
import pty
from pathlib import Path
from typing import Any

import pytest

from cli import pooled_samples, samples
from slidepipe.artifacts.store import Store
from slidepipe.cli import render


def asked(stages) -> dict[str, Any]:
    (request,) = stages.requests
    return vars(request)


def test_plan(call, stages) -> None:
    call("plan", "e.yaml", "--set", "friction=0.4", "--set", "lab.seed=2", "--force")
    assert asked(stages) == {
        "experiment": Path("e.yaml"),
        "store": Store(Path("data")),
        "overrides": ("friction=0.4", "lab.seed=2"),
        "force": True,
        "figure": False,
        "command": ("slidepipe", "plan", "e.yaml", "--set", "friction=0.4", "--set", "lab.seed=2", "--force"),
    }


def test_execute(call, stages) -> None:
    call("--data", "elsewhere", "execute", "k3f9", "--set", "lab.friction=0.4", "--seed", "7")
    assert asked(stages) == {
        "plan": "k3f9",
        "store": Store(Path("elsewhere")),
        "overrides": ("lab.friction=0.4", "lab.seed=7"),
        "command": (
            *("slidepipe", "--data", "elsewhere", "execute", "k3f9"),
            *("--set", "lab.friction=0.4", "--seed", "7"),
        ),
        "lab": None,
    }


def test_estimate(call, stages) -> None:
    call("estimate", "m0x7", env={"SLIDEPIPE_DATA": "from-the-environment"})
    assert asked(stages) == {
        "trial": "m0x7",
        "store": Store(Path("from-the-environment")),
        "force": False,
        "figure": False,
        "calibration": None,
        "overrides": (),
        "command": ("slidepipe", "estimate", "m0x7"),
    }


def test_estimate_of_several_trials(call, stages) -> None:
    call("estimate", "m0x7", "away/trial.mcap", "--force")
    assert asked(stages) == {
        "trials": ("m0x7", "away/trial.mcap"),
        "store": Store(Path("data")),
        "force": True,
        "figure": False,
        "calibration": None,
        "overrides": (),
        "command": ("slidepipe", "estimate", "m0x7", "away/trial.mcap", "--force"),
    }


def test_several_trials_as_one_object(call, stages) -> None:
    result = call("estimate", "x", "y", "--json")
    assert (result.exit_code, result.stderr) == (0, "")
    told = json.loads(result.stdout)
    assert list(told) == ["schema", "run", "directory", "reused", "document", "estimates"]
    assert told["schema"] == "slidepipe.pool_result/1"
    assert told["document"]["schema"] == "slidepipe.pooled/1"
    assert [one and one["schema"] for one in told["estimates"]] == ["slidepipe.estimate/2", None]
    stages.answers["pool"].document = pooled_samples.pooled(friction=False)
    assert call("estimate", "x", "y", "--json").exit_code == 1


def test_iterate(call, stages) -> None:
    call("iterate", "9zq1", "--way", "goal")
    assert asked(stages) == {
        "estimate": "9zq1",
        "store": Store(Path("data")),
        "way": "goal",
        "put_back": False,
        "force": False,
        "command": ("slidepipe", "iterate", "9zq1", "--way", "goal"),
    }


def test_run(call, stages) -> None:
    call("run", "e.yaml", "--trials", "3", "--way", "learned", "--set", "lab.seed=2")
    assert asked(stages) == {
        "experiment": Path("e.yaml"),
        "store": Store(Path("data")),
        "overrides": ("lab.seed=2",),
        "trials": 3,
        "way": "learned",
        "resume": False,
        "command": (
            *("slidepipe", "run", "e.yaml", "--trials", "3"),
            *("--way", "learned", "--set", "lab.seed=2"),
        ),
        "report": render.note,
        "lab": None,
    }


def test_what_is_not_given_is_left_to_the_experiment(call, stages) -> None:
    call("run", "e.yaml")
    request = asked(stages)
    assert (request["overrides"], request["trials"], request["way"]) == ((), None, None)


def test_progress_is_told_on_stderr_while_it_happens(call, stages) -> None:
    class Campaign(dict):  # type: ignore[type-arg]
        """Answers like the stage, after two lines of progress."""

        def __getitem__(self, stage: str) -> Any:
            stages.requests[-1].report("trial 1: planned")
            stages.requests[-1].report("trial 1: executed")
            return super().__getitem__(stage)

    stages.answers = Campaign(stages.answers)
    result = call("run", "e.yaml", "--json")
    assert result.stderr == "trial 1: planned\ntrial 1: executed\n"
    assert json.loads(result.stdout)["schema"] == "slidepipe.run_result/1"


RESULTS = {
    "plan": (samples.plan_run(), ["schema", "run", "directory", "reused", "document"]),
    "execute": (samples.run(samples.TRIAL, "execute"), ["schema", "run", "directory", "document", "truth"]),
    "estimate": (samples.run(samples.ESTIMATE, "estimate"), ["schema", "run", "directory", "reused", "document"]),
    "iterate": (
        samples.plan_run(),
        ["schema", "run", "directory", "within_tolerance", "reused", "document", "why"],
    ),
    "run": (samples.run(samples.CAMPAIGN, "campaign"), ["schema", "run", "directory", "document"]),
}


@pytest.mark.parametrize("verb", RESULTS)
def test_one_object_and_nothing_else(call, verb: str) -> None:
    run, keys = RESULTS[verb]
    result = call(verb, "x", "--json")
    assert (result.exit_code, result.stderr) == (0, "")
    told = json.loads(result.stdout)
    assert list(told) == keys
    assert told["schema"] == f"slidepipe.{verb}_result/1"
    assert (told["run"], told["directory"]) == (run.id, str(run.directory))
    name = {"execute": "trial", "iterate": "plan", "run": "campaign"}.get(verb, verb)
    assert next(iter(told["document"].items())) == ("schema", f"slidepipe.{name}/2")


def test_the_truth_is_told_where_it_is_known(call, stages) -> None:
    assert json.loads(call("execute", "x", "--json").stdout)["truth"]["friction"] == 0.4256
    stages.answers["execute"].truth = None
    assert json.loads(call("execute", "x", "--json").stdout)["truth"] is None


@pytest.mark.parametrize(
    ("verb", "stage", "document"),
    [
        ("execute", "execute", samples.trial("lost")),
        ("estimate", "estimate", samples.estimate(friction=False, lost="it fell")),
        ("run", "campaign", samples.campaign(samples.row(1), outcome="lost")),
    ],
)
def test_no_is_told_by_the_code(call, stages, verb: str, stage: str, document) -> None:
    stages.answers[stage].document = document
    result = call(verb, "x", "--json")
    assert result.exit_code == 1
    assert json.loads(result.stdout)["schema"] == f"slidepipe.{verb}_result/1"


def test_nothing_left_to_iterate(call, stages) -> None:
    stages.answer("iterate", run=None, document=None, why=None, reused=False)
    assert json.loads(call("iterate", "x", "--json").stdout) == {
        "schema": "slidepipe.iterate_result/1",
        "run": None,
        "directory": None,
        "within_tolerance": True,
        "reused": False,
        "document": None,
        "why": None,
    }


def test_list(call, publish) -> None:
    publish(samples.plan_run())
    told = json.loads(call("ls", "--json").stdout)
    assert list(told) == ["schema", "runs", "faults"]
    assert told["schema"] == "slidepipe.run_list/1"
    (line,) = told["runs"]
    assert (line["run"], line["stage"], line["state"]) == (samples.PLAN, "plan", "complete")
    assert line["results"][0] == {"name": "peak_hand_speed", "value": 1.234567, "std": None, "unit": "m/s"}


def test_list_of_nothing(call) -> None:
    assert json.loads(call("ls", "--json").stdout) == {"schema": "slidepipe.run_list/1", "runs": [], "faults": []}


def test_show(call, publish) -> None:
    run = publish(samples.plan_run(), plan=samples.plan())
    told = json.loads(call("show", "@latest", "--json").stdout)
    assert list(told) == ["schema", "run", "directory", "manifest", "documents", "annotations"]
    assert told["schema"] == "slidepipe.run_view/1"
    assert told["manifest"]["schema"] == "slidepipe.run/1"
    assert told["manifest"]["outputs"][1]["sha256"] == run.sha256("reference")
    assert told["documents"]["plan.yaml"]["believed"]["friction"] == 0.38


@pytest.mark.parametrize(
    ("environment", "coloured"), [({}, True), ({"NO_COLOR": "1"}, False), ({"TERM": "dumb"}, False)]
)
def test_colour_on_a_terminal_only(
    monkeypatch: pytest.MonkeyPatch, environment: dict[str, str], coloured: bool
) -> None:
    monkeypatch.setenv("TERM", "xterm-256color")
    monkeypatch.delenv("NO_COLOR", raising=False)
    for name, value in environment.items():
        monkeypatch.setenv(name, value)
    assert ("\x1b" in shown_on_a_terminal(monkeypatch)) is coloured


def test_no_colour_off_a_terminal(call) -> None:
    result = call("plan", "x", env={"FORCE_COLOR": "1", "TERM": "xterm-256color"})
    assert "\x1b" not in result.stdout


def shown_on_a_terminal(monkeypatch: pytest.MonkeyPatch) -> str:
    from slidepipe.cli.views.tables import heading  # noqa: PLC0415

    outer, inner = pty.openpty()
    with os.fdopen(inner, "w") as terminal, monkeypatch.context() as patched:
        patched.setattr("sys.stdout", terminal)
        render.put([heading("plan")])
        terminal.flush()
        shown = os.read(outer, 1000).decode()
    os.close(outer)
    assert "plan" in shown
    return shown


def test_a_terminal_that_knows_no_greek() -> None:
    from click.testing import CliRunner  # noqa: PLC0415

    from slidepipe.cli.main import cli  # noqa: PLC0415

    result = CliRunner(charset="ascii").invoke(cli, ["estimate", "x"])
    assert result.exit_code == 0
    assert "10.00 ? 0.03" in result.stdout
