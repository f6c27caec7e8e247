"""What a person does wrong is told in one line, with exit code 3, and leaves nothing behind."""

import resource
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from slidepipe.cli.main import cli

ROOT = Path(__file__).resolve().parents[1]
RECORDED = ROOT / "data" / "recorded" / "linear-3800-seed103" / "trial.mcap"


@pytest.fixture
def call(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Result]:
    monkeypatch.chdir(tmp_path)
    return lambda *arguments: CliRunner().invoke(cli, list(arguments))


def spoil(tmp_path: Path, old: str, new: str) -> None:
    text = (ROOT / "experiments" / "paper_linear.yaml").read_text()
    assert text.count(old) >= 1
    (tmp_path / "mine.yaml").write_text(text.replace(old, new, 1))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("friction: 0.38  ", "#", "mine.yaml:1:1: friction: required key is missing"),
        ("mass_kg", "colour: red, mass_kg", "mine.yaml:5:60: object.colour: unknown key, allowed are"),
        ("mass_kg: 0.023", "mass_kg: -0.023", "mine.yaml:5:60: object.mass_kg: must be > 0, got -0.023 kg"),
        ("mass_kg: 0.023", "mass_kg: 23 g", "mine.yaml:5:60: object.mass_kg: must be a number of kg, got '23 g'"),
        ("name: paper_linear", "name: my: block", "mapping values are not allowed in this context: text with a colon"),
        ("{x_m: 0.01, y_m: 0.02", "{x_m: 0.01, y_m: 0.06", "goal.relative_pose.y_m: the goal is outside the object"),
        ("slide_s: 0.2", "slide_s: 0", "motion.slide_s: must be > 0, got 0 s"),
        ("friction: 0.38", "friction: 1e-05", "friction: must be >= 0.01, got 1e-05"),
        ("friction: 0.38", "friction: 0.38\nfriction: 0.4", "friction: duplicate key, first given at line 16"),
    ],
)
def test_experiment(call: Callable, tmp_path: Path, old: str, new: str, message: str) -> None:
    spoil(tmp_path, old, new)
    for verb in ("plan", "run"):
        result = call(verb, "mine.yaml")
        assert (result.exit_code, result.stdout) == (3, "")
        assert result.stderr.startswith("error: mine.yaml:")
        assert message in result.stderr
        assert len(result.stderr.splitlines()) == 1
        assert sorted(path.name for path in tmp_path.iterdir()) == ["mine.yaml"]


def test_directory_for_a_file(call: Callable, tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    result = call("plan", "folder")
    assert (result.exit_code, result.stdout) == (3, "")
    assert result.stderr == "error: folder: is a directory, a YAML file is needed\n"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["folder"]


def test_a_file_whose_name_is_nearly_right(call: Callable, tmp_path: Path) -> None:
    (tmp_path / "robust.yaml").write_text("")
    result = call("run", "robst.yaml")
    assert (result.exit_code, result.stdout) == (4, "")
    assert result.stderr == "error: robst.yaml: no such file; did you mean robust.yaml?\n"


@pytest.mark.parametrize("limit_bytes", [1000, 8000, 40_000])
def test_a_store_that_cannot_be_written(tmp_path: Path, limit_bytes: int) -> None:
    """No file may grow beyond a limit, which ends writes as a full disk does: no run, at most what recover finds."""

    def narrow() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit_bytes, limit_bytes))

    command = [sys.executable, "-m", "slidepipe", "plan", str(ROOT / "experiments" / "paper_rotational.yaml")]
    done = subprocess.run(command, cwd=tmp_path, preexec_fn=narrow, capture_output=True, text=True, check=False)  # noqa: S603
    left = list(tmp_path.glob("data/runs/*/*"))
    kept = "; what was made is kept: slidepipe recover publishes it" if left else ""
    assert (done.returncode, done.stdout, done.stderr) == (5, "", f"error: data: File too large{kept}\n")
    assert all(path.name.startswith(".tmp-") for path in left)
    assert bool(left) == (limit_bytes > 1000)


def test_truncated_recording(call: Callable, tmp_path: Path) -> None:
    (tmp_path / "cut.mcap").write_bytes(RECORDED.read_bytes()[:100_000])
    result = call("estimate", "cut.mcap")
    assert (result.exit_code, result.stdout) == (3, "")
    assert len(result.stderr.splitlines()) == 1
    assert result.stderr.startswith("error: cut.mcap: byte 9")
    assert "cut off inside the record that begins here, 100000 bytes are there" in result.stderr
    assert "messages can be recovered" in result.stderr
    assert sorted(path.name for path in tmp_path.iterdir()) == ["cut.mcap"]


def test_truncated_recording_in_the_store(call: Callable, tmp_path: Path) -> None:
    shutil.copy(ROOT / "experiments" / "paper_rotational.yaml", tmp_path / "mine.yaml")
    assert call("plan", "mine.yaml").exit_code == 0
    assert call("execute", "@latest").exit_code == 0
    (trial,) = tmp_path.glob("data/runs/*/*/trial.mcap")
    trial.write_bytes(trial.read_bytes()[:-50_000])
    before = sorted(tmp_path.glob("data/runs/*/*"))
    result = call("estimate", "@latest")
    assert (result.exit_code, result.stdout) == (3, "")
    assert len(result.stderr.splitlines()) == 1
    assert "cut off" in result.stderr
    assert sorted(tmp_path.glob("data/runs/*/*")) == before


def test_yaml_for_a_recording(call: Callable, tmp_path: Path) -> None:
    shutil.copy(ROOT / "experiments" / "paper_linear.yaml", tmp_path / "trial.mcap")
    result = call("estimate", "trial.mcap")
    assert (result.exit_code, result.stdout, len(result.stderr.splitlines())) == (3, "", 1)


def test_recording_alone_is_enough(call: Callable, tmp_path: Path) -> None:
    shutil.copy(RECORDED, tmp_path / "trial.mcap")
    result = call("estimate", "trial.mcap")
    assert result.exit_code == 0, result.stderr
    assert "kappa" in result.stdout


def test_a_plan_that_was_edited_after_it_was_published_is_not_executed(call: Callable, tmp_path: Path) -> None:
    shutil.copy(ROOT / "experiments" / "paper_rotational.yaml", tmp_path / "mine.yaml")
    assert call("plan", "mine.yaml").exit_code == 0
    (plan,) = tmp_path.glob("data/runs/*/*/reference.mcap")
    whole = plan.read_bytes()
    plan.write_bytes(whole[:-1] + bytes([whole[-1] ^ 1]))
    result = call("execute", "@latest")
    assert (result.exit_code, result.stdout) == (5, "")
    assert result.stderr == (
        f"error: {plan.relative_to(tmp_path)}: was changed after it was published: nothing is made from it"
        " (slidepipe verify)\n"
    )
    plan.unlink()
    result = call("execute", "@latest")
    assert (result.exit_code, result.stdout) == (4, "")
    assert "is missing (slidepipe repair restores it where there is a copy)" in result.stderr


def test_slips_of_the_pen(call: Callable, tmp_path: Path) -> None:
    (tmp_path / "tab.yaml").write_text("schema: slidepipe.experiment/2\nobject:\n\tsize_x_m: 1\n")
    assert call("plan", "tab.yaml").stderr == "error: tab.yaml:3:1: a tab cannot indent YAML: use spaces\n"
    assert "No such command 'plann'. Did you mean plan?" in call("plann", "tab.yaml").stderr
    assert call("execute", "tab.yaml").stderr == (
        "error: run tab.yaml: there is none in data; it is a file: slidepipe plan makes a run of an experiment file\n"
    )


def test_figures_far_from_the_experiments(call: Callable, tmp_path: Path) -> None:
    result = call("figures", "fig03")
    assert (result.exit_code, result.stdout) == (4, "")
    assert result.stderr == (
        "error: experiments: must hold paper_linear.yaml, paper_rotational.yaml (--experiments PATH)\n"
    )
    assert not list(tmp_path.iterdir())
