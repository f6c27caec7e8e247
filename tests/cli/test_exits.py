"""How commands end: a line for each fault on stderr, a code, and never a traceback for what was foreseen."""

import errno
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from slidepipe import errors
from slidepipe.cli.exits import OF_ERROR, exit_code


def error_classes(root: type = errors.SlidepipeError) -> set[type]:
    return {root}.union(*(error_classes(child) for child in root.__subclasses__()))


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (errors.InputError("e.yaml:4:9: object.mass_kg: must be greater than 0, got -1.0"), 3),
        (errors.NotFoundError("run 2027: there is none in data"), 4),
        (errors.StoreError("data/runs: is damaged"), 5),
        (errors.NewerSchemaError("e.yaml:1:1: schema: is newer"), 5),
        (errors.BusyError("data: is held by process 7"), 6),
        (errors.LabError("joint 4: is 0.3 rad away from its command"), 7),
        (errors.RefusedError("too few frames"), 1),
        (errors.InfeasibleError("joint 4 torque: 31 N m at t = 0.412 s, beyond 29.4 N m"), 1),
        (errors.EstimationError("the residuals do not fit"), 1),
    ],
)
def test_each_error_is_one_line_and_a_code(call, stages, error: errors.SlidepipeError, code: int) -> None:
    stages.answers["plan"] = error
    result = call("plan", "e.yaml")
    assert result.exit_code == code
    assert result.stdout == ""
    assert result.stderr == f"error: {error}\n"


def test_the_table_of_codes_holds_the_whole_tree_of_errors() -> None:
    listed = tuple(kind for kind, _ in OF_ERROR)
    assert {kind for kind in error_classes() if not issubclass(kind, listed)} == {errors.SlidepipeError}
    assert exit_code(errors.SlidepipeError("something else")) == 1


def test_every_fault_has_its_own_line_however_long(call, stages) -> None:
    lines = ("e.yaml:4:9: " + "long " * 60 + "end", "--set lab.seed=[bold]x[/bold]: must be a whole number")
    stages.answers["plan"] = errors.InputError(*lines)
    assert call("plan", "e.yaml").stderr.splitlines() == [f"error: {line}" for line in lines]


def test_an_error_prints_no_json(call, stages) -> None:
    stages.answers["estimate"] = errors.EstimationError("the residuals do not fit")
    result = call("estimate", "@latest", "--json")
    assert (result.exit_code, result.stdout) == (1, "")


def test_interrupt(call, stages) -> None:
    stages.answers["campaign"] = KeyboardInterrupt()
    result = call("run", "e.yaml")
    assert (result.exit_code, result.stdout, result.stderr) == (130, "", "interrupted\n")


def test_the_unforeseen_is_not_hidden(call, stages) -> None:
    stages.answers["plan"] = ZeroDivisionError("a slip of the programmer")
    result = call("plan", "e.yaml")
    assert isinstance(result.exception, ZeroDivisionError)


def test_a_file_for_the_store(call, tmp_path: Path) -> None:
    (tmp_path / "data").write_text("")
    result = call("ls")
    assert (result.exit_code, result.stderr) == (3, "error: data: is a file, the store is a directory\n")


def test_a_newer_store(call, tmp_path: Path) -> None:
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "store.yaml").write_text("schema: slidepipe.store/99\n")
    result = call("ls")
    assert result.exit_code == 5
    assert result.stderr.startswith("error: data/store.yaml:1:1: schema: slidepipe.store/99 was written by a newer")


CHILD = """
import sys
from types import ModuleType, SimpleNamespace
stage = ModuleType("slidepipe.stages.plan")
stage.PlanRequest = SimpleNamespace
def run(request):
    {body}
stage.run = run
sys.modules["slidepipe.stages.plan"] = stage
from slidepipe.cli.main import main
main()
"""


def child(body: str, *arguments: str, **options: object) -> "subprocess.Popen[str]":
    command = [sys.executable, "-c", CHILD.format(body=body), *arguments]
    streams = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE} | options
    return subprocess.Popen(command, text=True, **streams)  # noqa: S603


def test_ctrl_c_ends_the_process_with_130(tmp_path: Path) -> None:
    process = child("import time; print('begun', flush=True); time.sleep(60)", "plan", "e.yaml", cwd=tmp_path)
    assert process.stdout.readline() == "begun\n"
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=20)
    assert (process.returncode, out, err) == (130, "", "interrupted\n")


@pytest.mark.parametrize("arguments", [["ls", "--json"], ["plan", "e.yaml"]])
def test_a_reader_that_went_away_is_no_error(tmp_path: Path, arguments: list[str]) -> None:
    reading, writing = os.pipe()
    os.close(reading)
    process = child("print('x' * 100000)", *arguments, cwd=tmp_path, stdout=writing)
    os.close(writing)
    _, err = process.communicate(timeout=20)
    assert (process.returncode, err) == (141, "")


def test_interrupt_says_what_is_kept(call, stages) -> None:
    stages.answers["campaign"] = KeyboardInterrupt("what is done is kept")
    assert call("run", "e.yaml").stderr == "interrupted: what is done is kept\n"


def test_a_file_system_that_takes_nothing_is_one_line(call, stages) -> None:
    stages.answers["plan"] = OSError(errno.EROFS, os.strerror(errno.EROFS), "kept/notes.txt")
    result = call("plan", "e.yaml")
    assert (result.exit_code, result.stderr) == (5, "error: kept/notes.txt: Read-only file system\n")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no full device to write to")
def test_a_full_standard_output(tmp_path: Path) -> None:
    with Path("/dev/full").open("w") as full:
        process = child("print('x' * 100000)", "plan", "e.yaml", cwd=tmp_path, stdout=full)
        _, err = process.communicate(timeout=20)
    assert (process.returncode, err) == (5, "error: standard output: No space left on device\n")
