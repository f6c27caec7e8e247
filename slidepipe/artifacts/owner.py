"""Who makes a draft: a process on a host, which may be dead."""

import os
import platform
from dataclasses import dataclass
from pathlib import Path

from slidepipe.artifacts.strict_yaml import load
from slidepipe.errors import SlidepipeError

OWNER = ".owner.yaml"


@dataclass(frozen=True, slots=True)
class Owner:
    """A process: its number and host."""

    pid: int
    host: str


def read_owner(staging: Path) -> Owner | None:
    """Owner of a draft; None where the draft does not say."""
    try:
        data = load(staging / OWNER).data
        return Owner(int(str(data["pid"])), str(data["host"]))
    except (SlidepipeError, KeyError, ValueError):
        return None


def is_dead(owner: Owner | None) -> bool:
    """Whether the process is known to be gone; of another host's processes nothing is known."""
    if owner is None or owner.host != platform.node():
        return False
    try:
        os.kill(owner.pid, 0)
    except ProcessLookupError:
        return True
    except PermissionError:
        return False
    return False
