"""Where a result comes from: code, environment, and the hash that says whether two computations are the same."""

import hashlib
import json
import os
import platform
import re
import shutil
import subprocess
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import metadata
from pathlib import Path

import slidepipe
from slidepipe.artifacts.manifest import Code, Environment, InputRef

_TRACKED = ("slidepipe", "pyproject.toml")


@dataclass(frozen=True, slots=True)
class CodeState:
    """The code that runs: what the manifest says of it, and its changes since the commit, if any."""

    code: Code
    patch: bytes


def sha256_of(path: Path) -> str:
    """Hex digest of a file's bytes."""
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def recipe_of(
    *, stage: str, stage_version: int, parameters: Mapping[str, object], inputs: Iterable[InputRef], seed: int | None
) -> str:
    """Hash of everything that decides a result: equal recipes are the same computation.

    Which run or path an input comes from does not count, only its role and bytes.

    Examples
    --------
    >>> recipe_of(stage="plan", stage_version=1, parameters={"a": 1.0}, inputs=[], seed=None)[:12]
    '30d39173caf0'
    """
    content = {
        "stage": stage,
        "stage_version": stage_version,
        "parameters": parameters,
        "inputs": sorted([ref.role, ref.sha256] for ref in inputs),
        "seed": seed,
    }
    text = json.dumps(content, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()


@cache
def code_state() -> CodeState:
    """Version, commit and uncommitted changes of the running code; asked once, as imported code does not change.

    Without git, or outside a repository of its own, there is no commit and nothing is known of changes.
    """
    root = Path(slidepipe.__file__).resolve().parent.parent
    top = _git(root, "rev-parse", "--show-toplevel").decode().strip()
    commit = _git(root, "rev-parse", "--verify", "HEAD").decode().strip()
    if not commit or Path(top) != root:
        return CodeState(Code(version=slidepipe.__version__, commit=None, dirty=None), b"")
    dirty = bool(_git(root, "status", "--porcelain", "--", *_TRACKED))
    patch = _changes(root) if dirty else b""
    return CodeState(Code(version=slidepipe.__version__, commit=commit, dirty=dirty), patch)


@cache
def environment() -> Environment:
    """Python, host and the versions of the packages that slidepipe asks for."""
    needed = (re.split(r"[^A-Za-z0-9._-]", line, maxsplit=1)[0] for line in _requirements())
    return Environment(
        python=platform.python_version(),
        platform=platform.platform(),
        host=platform.node(),
        packages={name: _version(name) for name in sorted(needed)},
    )


def _requirements() -> list[str]:
    try:
        return [line for line in metadata.requires("slidepipe") or [] if "extra ==" not in line]
    except metadata.PackageNotFoundError:
        return []


def _version(name: str) -> str:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return "missing"


def _changes(root: Path) -> bytes:
    """Collect the changes since the commit as one patch, new files included."""
    patch = _git(root, "diff", "--binary", "HEAD", "--", *_TRACKED)
    new = _git(root, "ls-files", "-z", "--others", "--exclude-standard", "--", *_TRACKED)
    for name in filter(None, os.fsdecode(new).split("\0")):
        patch += _git(root, "diff", "--binary", "--no-index", "--", os.devnull, name)
    return patch


def _git(root: Path, *arguments: str) -> bytes:
    """Output of a git command that changes nothing; empty where git is missing or refuses."""
    git = shutil.which("git")
    if git is None:
        return b""
    ours = {key: value for key, value in os.environ.items() if not key.startswith("GIT_")}
    quiet = {**ours, "GIT_OPTIONAL_LOCKS": "0", "LC_ALL": "C"}
    done = subprocess.run([git, "-C", str(root), *arguments], capture_output=True, check=False, env=quiet)  # noqa: S603
    return done.stdout
