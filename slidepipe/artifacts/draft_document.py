"""Who is making a run, and what of: enough to publish it for a process that was killed."""

import os
import platform
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, ClassVar

from pydantic import BeforeValidator, Field

from slidepipe.artifacts.manifest import Code, Environment, InputRef, Instant
from slidepipe.artifacts.schema import Artifact, dump_model, parse
from slidepipe.artifacts.strict_yaml import load
from slidepipe.artifacts.values import Count, RunId, Slug

OWNER = ".owner.yaml"
_BEFORE_S = 2.0
"""A process that began this much after the run did is another one with the same number."""
_NO_ROLES, _ROLES = "\nroles: {}\n", "\nroles:\n"
_DEAD = ("Z", "X")
"""States of a process that has died and whose parent has not noticed yet."""


class DraftDocument(Artifact):
    """What stands beside the files of a run in the making; ``roles`` by file name, last, so that they can grow."""

    SCHEMA: ClassVar[str] = "slidepipe.draft"

    run: RunId
    pid: Annotated[int, Field(ge=1)]
    host: str
    begun: Instant
    stage: Slug
    stage_version: Annotated[int, Field(ge=1)]
    experiment: Slug
    seed: Count | None
    parameters: dict[str, object]
    inputs: tuple[InputRef, ...]
    command: tuple[str, ...]
    code: Code
    environment: Environment
    roles: Annotated[dict[str, str], BeforeValidator(lambda value: value or {})]

    @property
    def begun_at(self) -> datetime:
        """When the run began, in UTC."""
        return datetime.strptime(self.begun, "%Y-%m-%dT%H:%M:%S.%fZ").replace(tzinfo=UTC)

    @property
    def gone(self) -> bool:
        """Whether its process is gone; of another host nobody knows, and it counts as there."""
        if self.host != platform.node():
            return False
        try:
            os.kill(self.pid, 0)
        except ProcessLookupError:
            return True
        except PermissionError:
            pass
        now = _look_up(self.pid)
        if now is None:  # the system does not tell more
            return False
        return now.state in _DEAD or now.began_s > self.begun_at.timestamp() + _BEFORE_S


def read_draft(staging: Path) -> DraftDocument:
    """Read who makes the run in a staging directory.

    Raises
    ------
    NotFoundError
        Nobody says.
    InputError
        It is damaged.
    """
    return parse(DraftDocument, load(staging / OWNER))


def write_draft(staging: Path, draft: DraftDocument, written: Mapping[str, str] = MappingProxyType({})) -> None:
    """Say who makes the run, in place of what was said before; ``written`` as in :func:`dump_model`."""
    made = staging / f"{OWNER}.new"
    made.write_text(dump_model(draft, written).replace(_NO_ROLES, _ROLES), encoding="utf-8")
    made.replace(staging / OWNER)


def add_role(staging: Path, name: str, role: str) -> None:
    """Say which role a file has: one line more, since a file that is put in the place of another waits for the disk."""
    with (staging / OWNER).open("a", encoding="utf-8") as stream:
        stream.write(f"  '{name}': '{role}'\n")


@dataclass(frozen=True, slots=True)
class _Process:
    state: str
    began_s: float


def _look_up(pid: int) -> _Process | None:
    """State of a process and when it began, in seconds since 1970; None where the system does not tell."""
    with suppress(OSError, ValueError, IndexError, StopIteration):
        fields = Path(f"/proc/{pid}/stat").read_text(encoding="ascii", errors="replace").rpartition(")")[2].split()
        lines = Path("/proc/stat").read_text(encoding="ascii").splitlines()
        boot_s = next(float(line.split()[1]) for line in lines if line.startswith("btime "))
        return _Process(fields[0], boot_s + int(fields[19]) / os.sysconf("SC_CLK_TCK"))
    return None
