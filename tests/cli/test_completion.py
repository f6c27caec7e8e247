"""Tab in an interactive bash."""

import os
import pty
import select
import shutil
import sys
import time
from pathlib import Path

import pytest

PROMPT = b"ready> "
PATIENCE_S = 30.0


def pressed(keys: bytes, folder: Path, until: bytes) -> bytes:
    """What an interactive bash shows after some keys, once it has shown what is waited for."""
    process, terminal = pty.fork()
    if process == 0:
        os.chdir(folder)
        os.environ |= {"TERM": "dumb", "PS1": PROMPT.decode(), "INPUTRC": os.devnull, "HISTFILE": ""}
        os.environ["PATH"] = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
        os.execvp("bash", ["bash", "--norc", "--noprofile", "-i"])  # noqa: S606, S607
    try:
        read(terminal, PROMPT)
        os.write(terminal, b'eval "$(_SLIDEPIPE_COMPLETE=bash_source slidepipe)"\n')
        read(terminal, PROMPT)
        os.write(terminal, keys)
        return read(terminal, until)
    finally:
        os.close(terminal)
        os.waitpid(process, 0)


def read(terminal: int, until: bytes) -> bytes:
    shown, end = b"", time.monotonic() + PATIENCE_S
    while until not in shown and time.monotonic() < end:
        if select.select([terminal], [], [], 0.1)[0]:
            shown += os.read(terminal, 65536)
    return shown


@pytest.mark.skipif(shutil.which("bash") is None, reason="there is no bash here")
@pytest.mark.parametrize(
    ("keys", "line"),
    [
        (b"slidepipe pla\t", b"slidepipe plan "),
        (b"slidepipe show @latest:ex\t", b"slidepipe show @latest:execute "),
        (b"slidepipe run experiments/mine.yaml --lab ne\t", b"--lab nearby "),
        (b"slidepipe lab check ne\t", b"slidepipe lab check nearby "),
        (b"slidepipe run experiments/mi\t", b"slidepipe run experiments/mine.yaml "),
    ],
)
def test_tab_in_bash(tmp_path: Path, keys: bytes, line: bytes) -> None:
    for name in ("mine.yaml", "labs/nearby.yaml"):
        (tmp_path / "experiments" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "experiments" / name).touch()
    assert pressed(keys, tmp_path, line).endswith(line)
