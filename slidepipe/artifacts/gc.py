"""What nobody needs any more, and moving it to the trash.

Kept is everything that a name, a note or an experiment reaches: every trial that ran to its end, the latest run of
each stage of each experiment that did, and all that these were made from. What is left are runs that failed, plans
that were never executed, and results that were computed anew.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from slidepipe.artifacts.ancestry import ancestry
from slidepipe.artifacts.draft_document import read_draft
from slidepipe.artifacts.manifest import RunState
from slidepipe.artifacts.query import Query
from slidepipe.artifacts.run import Run
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.trash import Trash
from slidepipe.errors import SlidepipeError

ENDED = (RunState.COMPLETE, RunState.LOST)
TRIAL = "execute"
RECORDINGS = "*.mcap"


@dataclass(frozen=True, slots=True)
class Garbage:
    """Something that nobody needs: what it is called, where it lies, why, and how many bytes it has."""

    name: str
    directory: Path
    reason: str
    size: int


@dataclass(frozen=True, slots=True)
class Sweep:
    """What may go, and how many runs stay."""

    garbage: tuple[Garbage, ...]
    kept: int


def find_garbage(store: Store, *, before: datetime) -> Sweep:
    """Find what nobody needs of what ended before a time, in UTC; nothing is moved.

    Raises
    ------
    StoreError
        A run is damaged: what it reaches is not known, so nothing can be said.
    """
    runs = store.runs()
    reached = ancestry(store, _roots(store, runs)).keys()
    old = [
        run for run in runs if run.id not in reached and run.manifest.times.finished < f"{before:%Y-%m-%dT%H:%M:%S.%fZ}"
    ]
    garbage = [Garbage(run.id, run.directory, _reason(run), _size(run.directory)) for run in old]
    return Sweep((*garbage, *_drafts(store, before)), len(runs) - len(old))


def sweep(store: Store, found: Sweep) -> tuple[Path, ...]:
    """Move garbage to the trash, and tell where it is now; what a run took as its input meanwhile comes back."""
    trash = Trash(store.root)
    moved = {one.name: (one.directory, trash.take(one.directory)) for one in found.garbage}
    needed = {name for entry in store.find(Query()).entries for name in entry.inputs} & moved.keys()
    for name in needed:
        was, now = moved.pop(name)
        now.rename(was)
    return tuple(now for _, now in moved.values())


def _roots(store: Store, runs: Iterable[Run]) -> Iterator[Run]:
    marked = {ref.run for ref in store.refs.all()} | {note.run for note in store.annotations.all()}
    latest: dict[tuple[str, str], Run] = {}
    for run in runs:  # the earliest finished first
        told = run.manifest
        if told.state in ENDED:
            latest[told.experiment, told.stage] = run
        if run.id in marked or (told.stage == TRIAL and told.state in ENDED):
            yield run
    yield from latest.values()


def _reason(run: Run) -> str:
    told = run.manifest
    if told.state not in ENDED:
        return f"{told.stage} {told.state.value}"
    return f"{told.stage} that no name, note, trial or later result reaches"


def _drafts(store: Store, before: datetime) -> Iterator[Garbage]:
    """Drafts of processes that are gone; those with a recording in them are left, it may be the only one."""
    for staging in store.find(Query(limit=0)).drafts:
        try:
            old = staging.stat().st_mtime < before.timestamp()
        except FileNotFoundError:  # published meanwhile
            continue
        if old and _left(staging) and not any(staging.glob(RECORDINGS)):
            yield Garbage(staging.name, staging, "draft of a process that was killed", _size(staging))


def _left(staging: Path) -> bool:
    """Whether the process that made a draft is known to be gone."""
    try:
        return read_draft(staging).gone
    except (SlidepipeError, OSError):
        return False


def _size(directory: Path) -> int:
    return sum(path.stat().st_size for path in directory.iterdir() if path.is_file())
