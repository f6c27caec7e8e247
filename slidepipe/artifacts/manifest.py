"""The manifest of a run, ``run.yaml``: what was done, by which code, from what, and what came out."""

from collections.abc import Iterator
from enum import StrEnum
from pathlib import PurePosixPath
from typing import Annotated, ClassVar

from pydantic import BeforeValidator, Field

from slidepipe.artifacts.faults import Fault
from slidepipe.artifacts.schema import Artifact, Record
from slidepipe.artifacts.shapes import INSTANT, SHA256
from slidepipe.artifacts.values import Count, NotNegative, RunId, Slug

Sha256 = Annotated[str, Field(pattern=SHA256)]
Instant = Annotated[str, Field(pattern=INSTANT)]
"""UTC to the microsecond."""


class RunState(StrEnum):
    """How a run ended."""

    COMPLETE = "complete"
    LOST = "lost"
    """It ran to its end, and the block was lost on the way."""
    STOPPED = "stopped"
    """The arm was stopped on its way, by a person or for a reason that the trial tells."""
    FAILED = "failed"
    INTERRUPTED = "interrupted"


def _state(value: object) -> object:
    return RunState(value) if isinstance(value, str) and value in set(RunState) else value


State = Annotated[RunState, BeforeValidator(_state)]


class InputRef(Record):
    """A file that went in: from another run, or from outside the store with the path it had."""

    role: Slug
    sha256: Sha256
    size: Count
    run: RunId | None
    file: str


class OutputRef(Record):
    """A file that came out, beside the manifest."""

    role: Slug
    file: str
    sha256: Sha256
    size: Count


class Code(Record):
    """The code that ran; ``dirty`` is null where nobody knows."""

    version: str
    commit: str | None
    dirty: bool | None


class Environment(Record):
    """What it ran on."""

    python: str
    platform: str
    host: str
    packages: dict[str, str]


class Result(Record):
    """A number worth showing in a list of runs."""

    name: str
    value: float
    std: NotNegative | None
    unit: str


class ErrorNote(Record):
    """The error that ended a run."""

    type: str
    message: str


class Times(Record):
    """When it ran."""

    started: Instant
    finished: Instant


class Manifest(Artifact):
    """What is written as ``run.yaml``."""

    SCHEMA: ClassVar[str] = "slidepipe.run"

    run: RunId
    stage: Slug
    stage_version: Annotated[int, Field(ge=1)]
    experiment: Slug
    state: State
    times: Times
    recipe: Sha256
    seed: Count | None
    parameters: dict[str, object]
    inputs: tuple[InputRef, ...]
    outputs: tuple[OutputRef, ...]
    results: tuple[Result, ...]
    error: ErrorNote | None
    code: Code
    environment: Environment
    command: tuple[str, ...]

    def faults(self) -> Iterator[Fault]:
        """Find outputs that are not plain files of the run, and roles given twice."""
        seen: set[str] = set()
        for index, output in enumerate(self.outputs):
            if output.file != PurePosixPath(output.file).name or output.file.startswith("."):
                yield Fault(("outputs", index, "file"), f"must be a plain file name, got {output.file!r}")
            if output.role in seen:
                yield Fault(("outputs", index, "role"), f"role {output.role} is given twice")
            seen.add(output.role)
