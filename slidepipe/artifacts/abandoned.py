"""Runs in the making whose process was killed: they stay in their staging directories until somebody publishes them."""

from collections.abc import Callable
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path

from slidepipe.artifacts.draft import Draft, Request
from slidepipe.artifacts.draft_document import DraftDocument, read_draft
from slidepipe.artifacts.manifest import ErrorNote, Manifest, RunState
from slidepipe.artifacts.run import Run
from slidepipe.artifacts.run_id import STAGING, day_of
from slidepipe.errors import InputError, NotFoundError

REASON = "its process was killed"


@dataclass(slots=True, kw_only=True)
class Abandoned(Draft):
    """A run that was never published, and whose process is gone: all that can be done with it is to publish it."""

    document: DraftDocument
    state: RunState = RunState.INTERRUPTED
    _ended: datetime = field(init=False)

    def __post_init__(self) -> None:
        self.run_id, self.recipe = self.document.run, self.request.recipe
        self._roles.update(self.document.roles)
        times = [path.stat().st_mtime for path in self.staging.iterdir()]
        self._ended = datetime.fromtimestamp(max(times), UTC)

    def as_run(self) -> Run:
        """The run as it would be published, where it is now."""
        return Run(self.staging, self._manifest(_note(REASON)))

    def publish(self, reason: str = REASON) -> Run:
        """Publish it as interrupted, with what it has."""
        self._publish(_note(reason))
        return self.run

    def _manifest(self, note: ErrorNote | None) -> Manifest:
        """The manifest with what was then: the code, what it ran on, and when its last file was written."""
        now = super(Abandoned, self)._manifest(note)
        then = now.times.model_copy(update={"finished": f"{self._ended:%Y-%m-%dT%H:%M:%S.%fZ}"})
        told = self.document
        return now.model_copy(update={"code": told.code, "environment": told.environment, "times": then})


def find_abandoned(runs: Path, prepare: Callable[[], None]) -> tuple[Abandoned, ...]:
    """Find them below the directory that holds the days, the oldest first; one that says nothing is passed over."""
    found = []
    for directory in sorted(runs.glob(f"*/{STAGING}*")):
        if day_of(directory.name.removeprefix(STAGING)) != directory.parent.name:
            continue
        try:
            document = read_draft(directory)
            if document.gone:
                found.append(_adopted(runs, document, prepare))
        except (NotFoundError, InputError, FileNotFoundError):  # just begun, or just published
            continue
    return tuple(found)


def _adopted(runs: Path, document: DraftDocument, prepare: Callable[[], None]) -> Abandoned:
    request = Request(
        stage=document.stage,
        stage_version=document.stage_version,
        experiment=document.experiment,
        parameters=document.parameters,
        inputs=document.inputs,
        seed=document.seed,
        command=document.command,
    )
    return Abandoned(runs=runs, request=request, prepare=prepare, begun=document.begun_at, document=document)


def _note(reason: str) -> ErrorNote:
    return ErrorNote(type="Interrupted", message=reason)
