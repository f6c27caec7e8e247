"""What the command line says of itself, and that it says so at once."""

import os
import re
import subprocess
import sys
from pathlib import Path

import click
import pytest

from slidepipe import __version__
from slidepipe.artifacts.store import Store
from slidepipe.cli.exits import ExitCode
from slidepipe.cli.main import VERBS, cli

HEAVY = {
    "numpy", "scipy", "mujoco", "mink", "numba", "filterpy", "pandas", "matplotlib", "mcap", "google", "pydantic",
    "yaml", "rich",
}  # fmt: skip


NUMERICAL = HEAVY - {"rich", "pydantic", "yaml"}


def packages(told: str) -> set[str]:
    """Top packages that ``-X importtime`` told of."""
    names = [line.rpartition("|")[2].strip() for line in told.splitlines() if line.startswith("import time:")]
    return {name.partition(".")[0] for name in names}


def imported_by(*arguments: str) -> set[str]:
    command = [sys.executable, "-X", "importtime", "-m", "slidepipe", *arguments]
    return packages(subprocess.run(command, capture_output=True, text=True, check=True).stderr)  # noqa: S603


@pytest.mark.parametrize(
    "arguments", [["--help"], ["plan", "--help"], ["--version"], *([verb, "-h"] for verb in VERBS)]
)
def test_help_waits_for_nothing_heavy(arguments: list[str]) -> None:
    imported = imported_by(*arguments)
    assert "slidepipe" in imported
    assert imported & HEAVY == set()


LISTS = [["ls"], ["ls", "--json"], ["ref"]]


@pytest.mark.parametrize("arguments", LISTS)
def test_lists_wait_for_nothing_that_computes(tmp_path: Path, arguments: list[str]) -> None:
    """A list of runs that the index knows loads neither YAML nor pydantic; a name, no numerical library."""
    store = Store(tmp_path)
    with store.draft(stage="plan", stage_version=1, experiment="a", parameters={}):
        pass
    store.index.rebuild()
    heavy = HEAVY - {"rich"} if arguments[0] == "ls" else NUMERICAL
    assert imported_by("--data", str(tmp_path), *arguments) & heavy == set()


def test_completion_waits_for_nothing_that_computes(tmp_path: Path) -> None:
    store = Store(tmp_path)
    with store.draft(stage="plan", stage_version=1, experiment="a", parameters={}) as draft:
        pass
    store.index.rebuild()
    words = {"_SLIDEPIPE_COMPLETE": "bash_complete", "COMP_CWORD": "4"}
    shell = words | {"COMP_WORDS": f"slidepipe --data {tmp_path} show {draft.run_id[:10]}"}
    command = [sys.executable, "-X", "importtime", "-m", "slidepipe"]
    done = subprocess.run(command, capture_output=True, text=True, check=True, env=os.environ | shell)  # noqa: S603
    assert done.stdout.splitlines() == [f"plain,{draft.run_id}"]
    assert packages(done.stderr) & HEAVY == set()


def test_help_of_the_group(call) -> None:
    result = call("--help")
    assert result.exit_code == 0
    assert re.findall(r"^  (\w+)  +[A-Z]", result.stdout, re.MULTILINE) == list(VERBS)
    assert "..." not in result.stdout.partition("Commands:")[2], "no short help is cut off"
    assert "SLIDEPIPE_DATA" in result.stdout


@pytest.mark.parametrize("verb", VERBS)
def test_every_verb_explains_itself(call, verb: str) -> None:
    result = call(verb, "--help")
    assert result.exit_code == 0
    assert f"\n  Example:\n    slidepipe {verb} " in result.stdout
    assert re.search(r"^  [A-Z][^.]+\.$", result.stdout, re.MULTILINE), "one sentence that says what it does"
    codes = {
        int(code) for code in re.findall(r"^    (\d+) +\S", result.stdout.partition("Exit codes:")[2], re.MULTILINE)
    }
    assert {0, 2, 3, 4, 5, 130} <= codes <= set(ExitCode)
    assert "--json" in result.stdout
    assert max(len(line) for line in result.stdout.splitlines()) <= 80


@pytest.mark.parametrize("verb", VERBS)
def test_every_example_is_accepted(call, verb: str) -> None:
    example = call(verb, "--help").stdout.partition("Example:\n")[2].splitlines()[0].split()
    assert example[:2] == ["slidepipe", verb]
    context = click.Context(cli, info_name="slidepipe")
    command = cli.get_command(context, verb)
    command.make_context(verb, example[2:], parent=context)


def test_version(call) -> None:
    assert call("--version").stdout == f"slidepipe {__version__}\n"


@pytest.mark.parametrize(
    "arguments",
    [
        ["unknown"],
        ["--unknown"],
        ["plan"],
        ["plan", "a.yaml", "b.yaml"],
        ["execute", "@latest", "--seed", "-1"],
        ["iterate", "@latest", "--way", "guess"],
        ["run", "a.yaml", "--trials", "0"],
        ["run", "a.yaml", "--set", "friction", "0.4"],
        ["run", "a.yaml", "--repeat", "2", "--lab", "loopback"],
        ["run", "a.yaml", "--repeat", "2", "--trials", "3", "--way", "goal"],
        ["ls", "too-much"],
        ["show"],
    ],
)
def test_wrong_usage(call, arguments: list[str]) -> None:
    result = call(*arguments)
    assert result.exit_code == 2
    assert result.stdout == ""
    assert result.stderr.startswith("Usage: slidepipe ")
    assert "\nError: " in result.stderr


@pytest.mark.parametrize(
    ("typed", "right"),
    [
        (["ls", "--version"], "slidepipe --version ls"),
        (["ls", "--data", "elsewhere"], "slidepipe --data PATH ls"),
        (["run", "a.yaml", "--data=elsewhere"], "slidepipe --data PATH run"),
        (["lab", "check", "loopback", "--version"], "slidepipe --version lab check"),
    ],
)
def test_an_option_of_the_group_after_the_verb(call, typed: list[str], right: str) -> None:
    option = right.split()[1]
    result = call(*typed)
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr == f"Error: {option} is an option of slidepipe itself, before the command: {right}\n"


def test_a_setting_in_two_words_is_told_as_such(call) -> None:
    result = call("plan", "a.yaml", "--set", "friction", "0.4")
    assert result.stderr.endswith("'--set': must read KEY=VALUE in one word: friction=...\n")
