"""The words of ``slidepipe lab``, and of an execution on a real arm."""

import json
import re
from pathlib import Path
from types import SimpleNamespace

import pytest

from cli import samples
from slidepipe.artifacts.lab import find_lab, load_lab
from slidepipe.artifacts.manifest import RunState
from slidepipe.artifacts.trial import StreamReport
from slidepipe.cli.exits import ExitCode
from slidepipe.cli.main import cli
from slidepipe.errors import InputError, LabError
from slidepipe.lab.faults import Fault, FaultKind

EXPERIMENTS = Path(__file__).resolve().parents[2] / "experiments"
STREAM = StreamReport(
    ticks=2000,
    late_p50_s=3e-5,
    late_p99_s=6e-5,
    late_max_s=0.0012,
    late_share=0.0005,
    longest_gap_s=0.0031,
    commands=2000,
    states=1999,
    states_lost=1,
    frames_missing=0,
    records_lost=0,
    not_permitted=("no real-time scheduling: Operation not permitted (ulimit -r)",),
)


def test_the_group_says_what_there_is(call) -> None:
    result = call("lab", "--help")
    assert result.exit_code == 0
    assert re.findall(r"^  (\w+)  +[A-Z]", result.stdout, re.MULTILINE) == ["check", "serve"]


@pytest.mark.parametrize("verb", ["check", "serve"])
def test_both_explain_themselves(call, verb: str) -> None:
    result = call("lab", verb, "--help")
    assert result.exit_code == 0
    assert f"\n  Example:\n    slidepipe lab {verb} " in result.stdout
    assert "--json" in result.stdout
    assert max(len(line) for line in result.stdout.splitlines()) <= 80
    codes = {
        int(code) for code in re.findall(r"^    (\d+) +\S", result.stdout.partition("Exit codes:")[2], re.MULTILINE)
    }
    assert {0, 2, 3, 4, 7} <= codes <= set(ExitCode)


def test_every_fault_is_named_in_the_help(call) -> None:
    told = call("lab", "serve", "--help").stdout
    assert all(kind.value in told for kind in FaultKind)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (
            "los=0.1",
            r"^fault 'los=0.1': must read KIND=STRENGTH or KIND=STRENGTH@START_S, KIND one of loss, duplication,",
        ),
        ("loss", r"must read KIND=STRENGTH"),
        ("loss=x", r"must read KIND=STRENGTH"),
        ("loss=1.5", r"^fault loss: its strength must be from 0 to 1, got 1.5"),
        ("stall=-1", r"^fault stall: its strength must be from 0"),
        ("stall=1@-2", r"^fault stall: it must begin at 0 s or later, got -2.0"),
        ("stall=nan", r"^fault stall: its strength must be from 0 .*, got nan"),
    ],
)
def test_faults_that_are_none_are_refused(text: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        Fault.parse(text)


def test_without_a_terminal_nobody_can_be_asked(call, stages) -> None:
    result = call("execute", "@latest", "--lab", "loopback")
    assert result.exit_code == ExitCode.USAGE
    assert "nobody can be asked before the arm moves: answer beforehand with --yes" in result.stderr
    assert not stages.requests


def test_ctrl_c_at_the_question_interrupts(monkeypatch) -> None:
    import click  # noqa: PLC0415

    from slidepipe.cli import watching  # noqa: PLC0415

    def asked(*_: object, **__: object) -> bool:
        raise click.Abort

    monkeypatch.setattr(watching.click, "confirm", asked)
    question = SimpleNamespace(
        lab=SimpleNamespace(name="loopback"), checks=(), found=SimpleNamespace(course_s=4.0, approach_s=1.0)
    )
    with watching.watched("loopback", yes=True) as real, pytest.raises(KeyboardInterrupt):
        watching._Person(yes=False).confirm(question)
    assert real.confirm(question)


def test_the_lab_and_the_answer_go_to_the_stage(call, stages) -> None:
    assert call("execute", "@latest", "--lab", "loopback", "--yes").exit_code == 0
    assert stages.requests[-1].lab.name == "loopback"
    assert call("run", str(EXPERIMENTS / "regrasp.yaml"), "--lab", "wam", "--yes").exit_code == 0
    assert (stages.requests[-1].lab.name, stages.requests[-1].lab.beside) == ("wam", EXPERIMENTS)
    assert call("execute", "@latest").exit_code == 0
    assert stages.requests[-1].lab is None


@pytest.mark.parametrize(
    ("state", "changes", "code", "words"),
    [
        (RunState.STOPPED, {"stopped": "link lost: nothing heard"}, 7, "stopped: link lost: nothing heard\n"),
        (RunState.INTERRUPTED, {"stopped": "Ctrl-C: a person asked for it"}, 130, "stopped: Ctrl-C: a person"),
        (RunState.LOST, {"stopped": "object lost: gone"}, 1, "stopped: object lost: gone\nlost: the fingers"),
        (
            RunState.COMPLETE,
            {"invalid": "a gap of 19 ms"},
            7,
            "invalid: a gap of 19 ms: this trial cannot be estimated",
        ),
    ],
)
def test_how_a_trial_ended_is_the_exit_code(call, stages, *, state, changes, code, words) -> None:
    run = samples.run(samples.TRIAL, "execute", state=state)
    trial = samples.trial().model_copy(update={"lab": "loopback", "seed": None, "stream": STREAM, **changes})
    stages.answer("execute", run=run, document=trial, truth=None)
    result = call("execute", "@latest", "--lab", "loopback", "--yes")
    assert result.exit_code == code
    assert words in result.stderr
    assert "loopback lab" in result.stdout
    assert "stream" in result.stdout
    assert "30 us median, 60 us in 99 %, 1200 us at most" in result.stdout


def test_a_trial_that_was_stopped_before_its_motion_says_so(call, stages) -> None:
    changes = {"stopped": "cameras lost: no new frame for 102 ms", "started_ns": 5 * 10**18, "finished_ns": 5 * 10**18}
    run = samples.run(samples.TRIAL, "execute", state=RunState.STOPPED)
    stages.answer("execute", run=run, document=samples.trial().model_copy(update=changes), truth=None)
    assert re.search(r"^lasted +the motion did not begin$", call("execute", "@latest").stdout, re.MULTILINE)


def test_a_fault_of_the_lab_is_one_line_and_code_7(call, stages) -> None:
    stages.answers["execute"] = LabError("arm: nothing heard of it for 5 s")
    result = call("execute", "@latest", "--lab", "loopback", "--yes")
    assert (result.exit_code, result.stderr) == (7, "error: arm: nothing heard of it for 5 s\n")


def test_a_check_is_shown_and_its_fault_marked(call, monkeypatch) -> None:
    from slidepipe.stages import lab_check  # noqa: PLC0415  # the fakes stand before it

    facts = (
        lab_check.Fact("arm", "states", "500 a second"),
        lab_check.Fact("cameras", "error", "no answer", sound=False),
    )
    found = lab_check.LabCheck(load_lab(find_lab("loopback", EXPERIMENTS)), facts)
    monkeypatch.setattr(lab_check, "run", lambda _: found)
    result = call("lab", "check", "loopback")
    assert result.exit_code == 7
    assert result.stdout == (
        "lab loopback  not sound\n\narm\nstates  500 a second\n\ncameras\nerror  no answer  <- not as it should be\n"
    )
    told = json.loads(call("lab", "check", "loopback", "--json").stdout)
    assert told["schema"] == "slidepipe.lab_check_result/1"
    assert [fact["sound"] for fact in told["facts"]] == [True, False]


def test_the_example_of_serve_is_accepted() -> None:
    import click  # noqa: PLC0415

    group = cli.get_command(click.Context(cli), "lab")
    assert isinstance(group, click.Group)
    serve = group.commands["serve"]
    serve.make_context("serve", ["experiments/regrasp.yaml", "--lab", "loopback"])
