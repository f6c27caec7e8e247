"""A laboratory in another process, over real sockets on this machine."""

import json
import os
import re
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from slidepipe.artifacts.trial import TrialDocument

LABS = Path(__file__).resolve().parents[2] / "experiments" / "labs"
PATIENCE_S = 60.0
SLIDEPIPE = [sys.executable, "-m", "slidepipe"]
COARSE = ("--set", "lab.contact.timestep_s=1e-4", "--set", "lab.contact.solref_s=4e-4")
"""A world that is played at half the cost."""
PATIENT = {
    "driver_timeout_s__0.02": "driver_timeout_s: 0.5",
    "arm_s__0.02": "arm_s: 0.5",
    "cameras_s__0.1": "cameras_s: 1.0",
    "object_s__0.15": "object_s: 1.0",
}
"""For :func:`lab_file`: a lab that forgives a machine which does other things, where it is not about keeping time."""
LATE_S = 0.006
"""Commands are followed three ticks after they came: what is later than these is seen by the block."""


def free_ports(count: int) -> list[int]:
    sockets = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(count)]
    try:
        for one in sockets:
            one.bind(("127.0.0.1", 0))
        return [one.getsockname()[1] for one in sockets]
    finally:
        for one in sockets:
            one.close()


def lab_file(directory: Path, **changes: str) -> Path:
    """The shipped loopback lab on ports that are free here, with other text in the place of some of it."""
    text = (LABS / "loopback.yaml").read_text()
    local, remote, command, data = free_ports(4)
    ports = {"port: 5555": f"port: {local}", "port: 5556": f"port: {remote}", "command_port: 1510":
             f"command_port: {command}", "data_port: 1511": f"data_port: {data}"}  # fmt: skip
    new = ports | {key.replace("__", ": "): value for key, value in changes.items()}
    assert all(old in text for old in new)
    path = directory / "lab.yaml"
    # All at once: a free port may be 55561.
    path.write_text(re.sub("|".join(map(re.escape, new)), lambda old: new[old[0]], text))
    return path


def until(done: Callable[[], bool]) -> None:
    """Wait until something is so."""
    deadline = time.monotonic() + PATIENCE_S
    while not done():
        assert time.monotonic() < deadline, "it never happened"
        time.sleep(0.01)


def kept_time(document: TrialDocument, emulator_late_s: float) -> str | None:
    """Why a run shows nothing; None where the machine kept time."""
    assert document.stream is not None
    if document.invalid is not None or document.stream.longest_gap_s > LATE_S:
        return f"the loop was late: a gap of {1e3 * document.stream.longest_gap_s:.1f} ms"
    return f"the emulator was late by {1e3 * emulator_late_s:.1f} ms" if emulator_late_s > LATE_S else None


@dataclass
class Served:
    """A lab that is played by another process."""

    process: subprocess.Popen[str]
    report: dict[str, object] | None = None

    def end(self) -> dict[str, object]:
        """Have it end, and return what it says of how it kept time."""
        if self.report is None:
            self.process.send_signal(signal.SIGINT)
            out, _ = self.process.communicate(timeout=PATIENCE_S)
            self.report = json.loads(out)
        return self.report


@contextmanager
def serving(experiment: Path, lab: Path, *options: str):
    """Play a lab until the block is left."""
    command = [*SLIDEPIPE, "lab", "serve", str(experiment), "--lab", str(lab), "--json", *options]
    environment = os.environ | {"OMP_NUM_THREADS": "1"}
    process = subprocess.Popen(  # noqa: S603  # ourselves
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment
    )
    served = Served(process)
    try:
        assert process.stderr is not None
        line = process.stderr.readline()
        assert line.startswith("serving lab "), line + process.stderr.read()
        time.sleep(0.1)
        yield served
    finally:
        process.kill()
        process.communicate()
