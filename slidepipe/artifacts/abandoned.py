"""Runs in the making whose process was killed: they stay in their staging directories until somebody publishes them."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from slidepipe.artifacts.draft import STAGING, Draft
from slidepipe.artifacts.owner import OwnerDocument, read_owner
from slidepipe.artifacts.run import Run
from slidepipe.artifacts.run_id import day_of
from slidepipe.errors import InputError, NotFoundError

REASON = "its process was killed"


@dataclass(frozen=True, slots=True)
class Abandoned:
    """A run that was never published, and whose process is gone."""

    directory: Path
    owner: OwnerDocument
    _draft: Draft

    @property
    def id(self) -> str:
        """The run's name."""
        return self.owner.run

    def as_run(self) -> Run:
        """The run as it would be published, where it is now."""
        return self._draft.as_interrupted(REASON)

    def publish(self, reason: str = REASON) -> Run:
        """Publish it as interrupted, with what it has."""
        return self._draft.publish_interrupted(reason)


def find_abandoned(runs: Path, prepare: Callable[[], None]) -> tuple[Abandoned, ...]:
    """Find them below the directory that holds the days, the oldest first; one that says nothing is passed over."""
    found = []
    for directory in sorted(runs.glob(f"*/{STAGING}*")):
        if day_of(directory.name.removeprefix(STAGING)) != directory.parent.name:
            continue
        try:
            owner = read_owner(directory)
        except (NotFoundError, InputError):  # just begun, or just published
            continue
        if owner.gone:
            found.append(Abandoned(directory, owner, Draft.adopt(runs, owner, prepare)))
    return tuple(found)
