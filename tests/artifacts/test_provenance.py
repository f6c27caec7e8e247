import shutil
import subprocess
from pathlib import Path

import pytest

import slidepipe
from slidepipe.artifacts import provenance


@pytest.fixture
def repository(tmp_path, monkeypatch) -> Path:
    root = tmp_path / "repo"
    (root / "slidepipe").mkdir(parents=True)
    (root / "slidepipe" / "__init__.py").write_text("a = 1\n")
    monkeypatch.setattr(slidepipe, "__file__", str(root / "slidepipe" / "__init__.py"))
    monkeypatch.setenv("GIT_CONFIG_GLOBAL", "/dev/null")
    provenance.code_state.cache_clear()
    yield root
    provenance.code_state.cache_clear()


def git(root: Path, *arguments: str) -> str:
    command = ["git", "-c", "user.name=a", "-c", "user.email=a@b.c", "-C", str(root), *arguments]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip()  # noqa: S603


def commit(root: Path) -> str:
    git(root, "init", "-q")
    git(root, "add", ".")
    git(root, "commit", "-qm", "first")
    return git(root, "rev-parse", "HEAD")


def test_a_clean_commit(repository):
    head = commit(repository)
    (repository / "notes.txt").write_text("not code")
    state = provenance.code_state()
    assert (state.code.commit, state.code.dirty, state.patch) == (head, False, b"")
    assert state.code.version == slidepipe.__version__


def test_the_patch_of_dirty_code_restores_it(repository, tmp_path):
    commit(repository)
    clone = tmp_path / "clone"
    git(tmp_path, "clone", "-q", str(repository), str(clone))
    (repository / "slidepipe" / "__init__.py").write_text("a = 2\n")
    (repository / "slidepipe" / "new file.py").write_text("b = 3\n")
    state = provenance.code_state()
    assert state.code.dirty is True
    patch = tmp_path / "diff.patch"
    patch.write_bytes(state.patch)
    git(clone, "apply", str(patch))
    assert (clone / "slidepipe" / "__init__.py").read_text() == "a = 2\n"
    assert (clone / "slidepipe" / "new file.py").read_text() == "b = 3\n"


def test_asking_changes_nothing(repository):
    commit(repository)
    (repository / "slidepipe" / "__init__.py").write_text("a = 2\n")
    before = {path: path.stat().st_mtime_ns for path in (repository / ".git").rglob("*") if path.is_file()}
    provenance.code_state()
    assert {path: path.stat().st_mtime_ns for path in (repository / ".git").rglob("*") if path.is_file()} == before


@pytest.mark.parametrize("case", ["no repository", "no commit", "somebody else's repository", "no git"])
def test_nothing_is_known(repository, monkeypatch, case):
    if case == "no commit":
        git(repository, "init", "-q")
    if case == "somebody else's repository":
        commit(repository.parent)
    if case == "no git":
        commit(repository)
        monkeypatch.setattr(shutil, "which", lambda _: None)
    state = provenance.code_state()
    assert (state.code.commit, state.code.dirty, state.patch) == (None, None, b"")


def test_environment():
    environment = provenance.environment()
    assert environment.python.startswith("3.")
    assert set(environment.packages) >= {"numpy", "mujoco", "pydantic"}
    assert "missing" not in environment.packages.values()
    assert "pytest" not in environment.packages
