"""The run store: one directory for each run, published by one rename, and never changed after.

Files are the truth. ``.tmp-*`` directories are drafts in the making, or of processes that were killed.
"""

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from slidepipe.artifacts.abandoned import Abandoned, find_abandoned
from slidepipe.artifacts.draft import STAGING, Draft, Request
from slidepipe.artifacts.manifest import InputRef, RunState
from slidepipe.artifacts.run import MANIFEST, Run, one_of, read_run
from slidepipe.artifacts.run_id import day_of
from slidepipe.artifacts.schema import Artifact, dump_model, parse
from slidepipe.artifacts.strict_yaml import load
from slidepipe.errors import InputError, NotFoundError, StoreError

_ENDED = (RunState.COMPLETE, RunState.LOST)


class StoreDocument(Artifact):
    """What is written as ``store.yaml``: the version of the layout."""

    SCHEMA: ClassVar[str] = "slidepipe.store"


@dataclass(frozen=True, slots=True)
class Survey:
    """Runs that can be read, the oldest first, and one line for each that cannot."""

    runs: tuple[Run, ...]
    faults: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Store:
    """The store below a directory; it comes to be when the first run is published.

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

    def __post_init__(self) -> None:
        if self.root.exists() and not self.root.is_dir():
            raise InputError(f"{self.root}: is a file, the store is a directory")
        try:
            parse(StoreDocument, load(self._layout))
        except NotFoundError:
            pass
        except InputError as error:
            raise StoreError(error.lines[0]) from None

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
        return Draft(self._runs, request, prepare=self._write_layout)

    def survey(self) -> Survey:
        """Read every run's manifest."""
        runs, faults = [], []
        for directory in self._directories():
            try:
                runs.append(_read(directory))
            except (NotFoundError, StoreError) as error:
                if directory.exists():  # else it was moved away meanwhile
                    faults.append(str(error))
        return Survey(tuple(sorted(runs, key=lambda run: (run.manifest.times.finished, run.id))), tuple(faults))

    def abandoned(self) -> tuple[Abandoned, ...]:
        """Find runs in the making whose process is gone."""
        return find_abandoned(self._runs, self._write_layout)

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
            A run id or the beginning of one (of its random part, too), the path of a run's directory, ``@latest``, or
            ``@latest:STAGE`` for the latest of a stage that ran to its end.

        Raises
        ------
        NotFoundError
            There is none, or more than one.
        """
        if reference.startswith("@"):
            return self._latest(reference)
        path = Path(reference)
        if os.sep in reference or (path / MANIFEST).exists():
            return read_run(path.resolve())
        found = [one for one in self._directories() if reference in _beginnings(one.name, len(reference))]
        if not found or not reference:
            raise NotFoundError(f"run {reference}: there is none in {self.root}")
        if len(found) > 1:
            raise NotFoundError(f"run {reference}: may be {one_of([one.name for one in found])}")
        return _read(found[0])

    def find_recipe(self, recipe: str) -> Run | None:
        """Find the latest complete run with this recipe."""
        same = (run for run in reversed(self.runs()) if run.manifest.recipe == recipe)
        return next((run for run in same if run.manifest.state is RunState.COMPLETE), None)

    @property
    def _runs(self) -> Path:
        return self.root / "runs"

    @property
    def _layout(self) -> Path:
        return self.root / "store.yaml"

    def _latest(self, reference: str) -> Run:
        name, _, stage = reference.partition(":")
        if name != "@latest":
            raise NotFoundError(f"run {reference}: unknown reference, there are @latest and @latest:STAGE")
        runs = [run for run in self.runs(stage=stage or None) if not stage or run.manifest.state in _ENDED]
        if not runs:
            raise NotFoundError(f"run {reference}: there is none in {self.root}")
        return runs[-1]

    def _directories(self) -> Iterator[Path]:
        """Directories of published runs, by name."""
        if not self._runs.is_dir():
            return
        for day in sorted(self._runs.iterdir()):
            for directory in sorted(day.iterdir()) if day.is_dir() else ():
                if day_of(directory.name) == day.name:
                    yield directory

    def _write_layout(self) -> None:
        """Say which layout this is, where nobody has said so yet."""
        if self._layout.exists():
            return
        draft = self._layout.with_name(f"{STAGING}store-{os.getpid()}.yaml")
        draft.write_text(dump_model(StoreDocument()), encoding="utf-8")
        draft.replace(self._layout)


def _read(directory: Path) -> Run:
    run = read_run(directory)
    if run.id != directory.name:
        raise StoreError(f"{directory / MANIFEST}: run: must be {directory.name} as its directory, got {run.id}")
    return run


def _beginnings(run_id: str, length: int) -> tuple[str, str]:
    """Beginnings of this length that a run may be called by: of its id, and of its random part."""
    return run_id[:length], run_id.partition("-")[2][:length]
