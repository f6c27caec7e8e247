"""The run store: one directory for each run, published by one rename, and never changed after.

Files are the truth. ``.tmp-*`` directories are drafts in the making, or of processes that were killed.
"""

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from slidepipe.artifacts.abandoned import Abandoned, find_abandoned
from slidepipe.artifacts.annotations import Annotations
from slidepipe.artifacts.draft import Draft, Request
from slidepipe.artifacts.entry import MANIFEST, Entry
from slidepipe.artifacts.index import Index
from slidepipe.artifacts.layout import check_layout, write_layout
from slidepipe.artifacts.manifest import InputRef, RunState
from slidepipe.artifacts.query import Page, Query
from slidepipe.artifacts.refs import LATEST, Refs
from slidepipe.artifacts.run import Run, is_whole, read_run
from slidepipe.artifacts.run_id import day_of
from slidepipe.artifacts.wording import instead, one_of
from slidepipe.errors import NotFoundError, StoreError

_ENDED = (RunState.COMPLETE, RunState.LOST)


class Damaged(NamedTuple):
    """A run that cannot be read, and why."""

    directory: Path
    fault: str


@dataclass(frozen=True, slots=True)
class Survey:
    """Runs that can be read, the oldest first, and one line for each that cannot."""

    runs: tuple[Run, ...]
    damaged: tuple[Damaged, ...]

    @property
    def faults(self) -> tuple[str, ...]:
        """What is wrong with the damaged ones."""
        return tuple(one.fault for one in self.damaged)


def _unheard(_: str) -> None:
    """Nobody listens."""


@dataclass(frozen=True, slots=True)
class Store:
    """The store below a directory; it comes to be when the first run is published.

    Attributes
    ----------
    root : Path
    notice : Callable
        Told, in a line, what a person may not expect of an answer.

    Raises
    ------
    InputError
        The directory is a file.
    NewerSchemaError
        A newer slidepipe made the store.
    StoreError
        ``store.yaml`` is damaged.
    """

    root: Path
    notice: Callable[[str], None] = field(default=_unheard, compare=False, repr=False)

    def __post_init__(self) -> None:
        check_layout(self.root)

    def draft(
        self,
        *,
        stage: str,
        stage_version: int,
        experiment: str,
        parameters: Mapping[str, object],
        inputs: Sequence[InputRef] = (),
        seed: int | None = None,
        command: Sequence[str] = (),
    ) -> Draft:
        """Begin a run; to be used in a ``with`` statement, at whose end it is published."""
        request = Request(
            stage=stage,
            stage_version=stage_version,
            experiment=experiment,
            parameters=parameters,
            inputs=tuple(inputs),
            seed=seed,
            command=tuple(command),
        )
        return Draft(self._runs, request, prepare=lambda: write_layout(self.root))

    def survey(self) -> Survey:
        """Read every run's manifest."""
        runs, damaged = [], []
        for directory in self._directories():
            try:
                runs.append(_read(directory))
            except (NotFoundError, StoreError) as error:
                if directory.exists():  # else it was moved away meanwhile
                    damaged.append(Damaged(directory, str(error)))
        return Survey(tuple(sorted(runs, key=lambda run: (run.manifest.times.finished, run.id))), tuple(damaged))

    def abandoned(self) -> tuple[Abandoned, ...]:
        """Find runs in the making whose process is gone."""
        return find_abandoned(self._runs, lambda: write_layout(self.root))

    def runs(self, *, experiment: str | None = None, stage: str | None = None) -> list[Run]:
        """List the runs in the order in which they were finished.

        Raises
        ------
        StoreError
            A run is damaged; :meth:`survey` tells the others all the same.
        """
        found = self.survey()
        if found.faults:
            raise StoreError(f"{found.faults[0]} ({len(found.faults)} damaged: repair or move away)")
        return [
            run
            for run in found.runs
            if experiment in (None, run.manifest.experiment) and stage in (None, run.manifest.stage)
        ]

    def get(self, reference: str) -> Run:
        """Find the one run that a reference means.

        Parameters
        ----------
        reference : str
            A run id or the beginning of one (of its random part, too), the path of a run's directory, ``@latest``,
            ``@latest:STAGE`` for the latest of a stage that ran to its end, or a name that was given: ``@NAME``, or
            ``@EXPERIMENT/NAME`` where several experiments have it.

        Raises
        ------
        NotFoundError
            There is none, or more than one.
        """
        if reference.startswith("@"):
            return self._named(reference)
        path = Path(reference)
        if os.sep in reference or (path / MANIFEST).exists():
            return read_run(path.resolve())
        if day_of(reference):
            return self.get_exactly(reference)
        page = self.find(Query(begins=reference))
        found = [one.directory for one in (*page.entries, *page.damaged) if _may_be(one.run, reference)]
        if not found or not reference:
            raise NotFoundError(f"run {reference}: there is none in {self.root}{self._hint(reference)}")
        if len(found) > 1:
            raise NotFoundError(f"run {reference}: may be {one_of(sorted(path.name for path in found))}")
        return _read(found[0])

    def find(self, query: Query) -> Page:
        """Find runs by the index, which is brought up to the store before."""
        return self.index.find(query)

    def find_recipe(self, recipe: str) -> Run | None:
        """Find the latest complete run with this recipe, of those whose files are whole."""
        for entry in reversed(self.find(Query(recipe=recipe, states=(RunState.COMPLETE,))).entries):
            run = _read(entry.directory)
            if all(is_whole(run.directory / output.file, output) for output in run.manifest.outputs):
                return run
        return None

    @property
    def index(self) -> Index:
        """The index, which may be thrown away at any time."""
        return Index(self.root)

    @property
    def refs(self) -> Refs:
        """Names that people gave to runs."""
        return Refs(self.root / "refs")

    @property
    def annotations(self) -> Annotations:
        """What people noted on runs."""
        return Annotations(self.root / "annotations.jsonl")

    @property
    def _runs(self) -> Path:
        return self.root / "runs"

    def _named(self, reference: str) -> Run:
        """Find the run that ``@latest``, ``@latest:STAGE`` or a name that was given means."""
        name, colon, stage = reference.removeprefix("@").partition(":")
        if name != LATEST:
            return self.get_exactly(self.refs.resolve(reference))
        states = _ENDED if stage else ()
        page = self.find(Query(stage=stage if colon else None, states=states, limit=1))
        newest = self.find(Query(stage=stage, limit=1)).entries if states else page.entries
        if not page.entries:
            raise NotFoundError(
                f"run {reference}: there is none in {self.root}{self._instead(stage, newest, page.damaged)}"
            )
        latest = page.entries[-1]
        if newest[-1].run != latest.run:
            self.notice(f"{reference}: {latest.run}; after it came {newest[-1].run}, which is {newest[-1].state}")
        hidden = [one for one in page.damaged if one.run > latest.run]
        if hidden:
            raise StoreError(
                f"{hidden[-1].fault} ({len(hidden)} damaged after {latest.run}: name the run that you mean)"
            )
        return _read(latest.directory)

    def get_exactly(self, run_id: str) -> Run:
        """Find the run of this id, without the index.

        Raises
        ------
        NotFoundError
            There is none.
        """
        day = day_of(run_id)
        if day is None or not (self._runs / day / run_id).is_dir():
            raise NotFoundError(f"run {run_id}: there is none in {self.root}")
        return _read(self._runs / day / run_id)

    def _hint(self, reference: str) -> str:
        """What a name is, where it is not that of a run."""
        if Path(reference).is_file():
            return "; it is a file: slidepipe plan makes a run of an experiment file"
        if self.find(Query(experiment=reference, limit=1)).entries:
            return f"; it is an experiment: slidepipe ls --experiment {reference} lists its runs"
        return ""

    def _instead(self, stage: str, newest: Sequence[Entry], damaged: Sequence[Entry]) -> str:
        """What there is where no run, or none of a stage, ran to its end."""
        if newest:
            return f" that ran to its end; {newest[-1].run} is {newest[-1].state}: name it by its id"
        beside = f", beside {len(damaged)} that cannot be read" if damaged else ""
        stages = sorted({entry.stage for entry in self.find(Query()).entries})
        return f"{beside}; of the stages {instead(stage, stages)}" if stage and stages else beside

    def _directories(self) -> Iterator[Path]:
        """Directories of published runs, by name."""
        if not self._runs.is_dir():
            return
        for day in sorted(self._runs.iterdir()):
            for directory in sorted(day.iterdir()) if day.is_dir() else ():
                if day_of(directory.name) == day.name:
                    yield directory


def _read(directory: Path) -> Run:
    run = read_run(directory)
    if run.id != directory.name:
        raise StoreError(f"{directory / MANIFEST}: run: must be {directory.name} as its directory, got {run.id}")
    return run


def _may_be(run_id: str, beginning: str) -> bool:
    """Whether a run may be called by this: the beginning of its id, or of its random part."""
    return run_id.startswith(beginning) or run_id.partition("-")[2].startswith(beginning)
