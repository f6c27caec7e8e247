"""A run in the making: it stays out of sight until one rename makes it a run."""

import math
import os
import platform
import re
import shutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from functools import cache
from pathlib import Path
from types import TracebackType

from slidepipe.artifacts.draft_document import DraftDocument, add_role, write_draft
from slidepipe.artifacts.durable import sync
from slidepipe.artifacts.entry import MANIFEST, SEAL
from slidepipe.artifacts.manifest import (
    Code,
    Environment,
    ErrorNote,
    InputRef,
    Manifest,
    OutputRef,
    Result,
    RunState,
    Times,
)
from slidepipe.artifacts.provenance import code_state, environment, recipe_of, sha256_of
from slidepipe.artifacts.run import Run
from slidepipe.artifacts.run_id import STAGING, new_run_id
from slidepipe.artifacts.schema import dump_model, parse
from slidepipe.artifacts.seal import seal_of
from slidepipe.artifacts.strict_yaml import dump, loads
from slidepipe.errors import UNWRITABLE, InputError, StoreError

_PATCH = "diff.patch"
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]*")


@dataclass(frozen=True, slots=True, kw_only=True)
class Request:
    """What a run is asked to do; its recipe is the hash of what decides the result."""

    stage: str
    stage_version: int
    experiment: str
    parameters: Mapping[str, object]
    inputs: Sequence[InputRef] = ()
    seed: int | None = None
    command: Sequence[str] = ()

    @property
    def recipe(self) -> str:
        """Hash over stage, version, parameters, inputs and seed."""
        return recipe_of(
            stage=self.stage,
            stage_version=self.stage_version,
            parameters=self.parameters,
            inputs=self.inputs,
            seed=self.seed,
        )


@dataclass(slots=True)
class Draft:
    """Where a run is put together; leaving the ``with`` block publishes it.

    An :class:`~slidepipe.errors.InputError` leaves nothing behind. Where a file cannot be written, what was made is
    kept for ``recover``: it may be a trial that nobody can make again. Any other error, Ctrl-C included, publishes
    what there is, with its state and the error, and goes on.

    Attributes
    ----------
    runs : Path
        Directory of the store that holds the days.
    request : Request
    prepare : Callable[[], None]
        Called just before the run is published.
    state : RunState
        Set it where the run ended otherwise than complete.
    """

    runs: Path
    request: Request
    prepare: Callable[[], None]
    state: RunState = RunState.COMPLETE
    begun: datetime = field(default_factory=lambda: datetime.now(UTC))
    run_id: str = field(init=False)
    recipe: str = field(init=False)
    _roles: dict[str, str] = field(default_factory=dict)
    _results: list[Result] = field(default_factory=list)
    _made: list[Path] = field(default_factory=list)
    _run: Run | None = None

    def __post_init__(self) -> None:
        self.run_id = new_run_id(self.begun)
        self.recipe = self.request.recipe

    @property
    def final(self) -> Path:
        """Directory that the run gets when it is published."""
        return self.runs / f"{self.begun:%Y-%m-%d}" / self.run_id

    @property
    def staging(self) -> Path:
        """Directory that it has until then."""
        return self.final.with_name(STAGING + self.run_id)

    @property
    def run(self) -> Run:
        """The published run."""
        if self._run is None:
            raise StoreError(f"run {self.run_id}: is not published yet")
        return self._run

    def path(self, name: str) -> Path:
        """Where to write a file of the run."""
        if not _NAME.fullmatch(name) or name in (MANIFEST, SEAL, _PATCH):
            raise StoreError(f"run {self.run_id}: {name!r} cannot be the name of a run's file")
        return self.staging / name

    def add(self, role: str, name: str) -> Path:
        """Give a file of the run its role, and return where to write it."""
        path = self.path(name)
        if role in self._roles.values() or name in self._roles:
            raise StoreError(f"run {self.run_id}: {role} and {name}: each role is for one file")
        self._roles[name] = role
        if self.staging.is_dir():
            add_role(self.staging, name, role)
        return path

    def report(self, name: str, value: float, *, std: float | None = None, unit: str) -> None:
        """Put a number into the manifest's summary; dimensionless numbers have the unit ``1``."""
        if not math.isfinite(value) or not math.isfinite(std or 0.0):
            raise StoreError(f"run {self.run_id}: result {name} must be finite, got {value} +- {std}")
        self._results.append(Result(name=name, value=float(value), std=None if std is None else float(std), unit=unit))

    def __enter__(self) -> "Draft":
        self._make_staging()
        try:
            self._write_draft()
            if code_state().patch:
                (self.staging / _PATCH).write_bytes(code_state().patch)
        except OSError as error:
            self.discard()
            raise self._unwritten(error) from None
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if isinstance(error, InputError):
            self.discard()
            return
        try:
            if isinstance(error, OSError) and error.errno in UNWRITABLE:
                raise error
            self._end(error)
        except OSError as fault:
            raise self._put_off(fault) from None

    def _end(self, error: BaseException | None) -> None:
        """Publish what there is."""
        missing = self._missing() if error is None and self.state is RunState.COMPLETE else None
        if missing:
            missing_file = StoreError(f"run {self.run_id}: {missing} was announced and never written")
            self._fail(missing_file)
            raise missing_file
        if error is None:
            self._publish(None)
        else:
            self._fail(error)

    def _unwritten(self, error: OSError) -> StoreError:
        """Name the store for what is in the draft, which nobody sees."""
        name = str(error.filename or self.staging)
        place = self.runs.parent if name.startswith(str(self.staging)) else name
        return StoreError(f"{place}: {error.strerror}")

    def _put_off(self, error: OSError) -> StoreError:
        """Where a run cannot be published, keep what was made for ``recover``; where nothing was made, keep nothing."""
        made = [self.staging / name for name in self._roles]
        if not any(path.is_file() and path.stat().st_size for path in made):
            self.discard()
            return self._unwritten(error)
        for name in (MANIFEST, SEAL):
            (self.staging / name).unlink(missing_ok=True)
        return StoreError(f"{self._unwritten(error)}; what was made is kept: slidepipe recover publishes it")

    def discard(self) -> None:
        """Remove everything that the draft made."""
        shutil.rmtree(self.staging, ignore_errors=True)
        for directory in self._made:
            try:
                directory.rmdir()
            except OSError:  # another run lives there by now
                return

    def _make_staging(self) -> None:
        parents = [self.staging.parent, *self.staging.parent.parents]
        self._made = [directory for directory in parents if not directory.exists()]
        try:
            self.staging.mkdir(parents=True)
        except OSError as error:
            raise self._unwritten(error) from None

    def _write_draft(self) -> None:
        """Say who makes this run, and of what: should the process be killed, it can be published all the same."""
        asked = self.request
        document = DraftDocument(
            run=self.run_id,
            pid=os.getpid(),
            host=platform.node(),
            begun=_instant(self.begun),
            stage=asked.stage,
            stage_version=asked.stage_version,
            experiment=asked.experiment,
            seed=asked.seed,
            parameters=dict(asked.parameters),
            inputs=tuple(asked.inputs),
            command=tuple(asked.command),
            code=code_state().code,
            environment=environment(),
            roles=dict(self._roles),
        )
        write_draft(self.staging, document, _written(document.code, document.environment))

    def _fail(self, error: BaseException) -> None:
        self.state = RunState.FAILED if isinstance(error, Exception) else RunState.INTERRUPTED
        self._publish(ErrorNote(type=type(error).__name__, message=str(error)))

    def _publish(self, note: ErrorNote | None) -> None:
        told = self._manifest(note)
        staging, final = self.staging, self.final
        text = dump_model(told, _written(told.code, told.environment))
        manifest = parse(Manifest, loads(text, str(final / MANIFEST)))
        self.prepare()
        (staging / MANIFEST).write_text(text, encoding="utf-8")
        (staging / SEAL).write_text(seal_of(Run(staging, manifest)), encoding="utf-8")
        for path in staging.glob(".*"):  # who makes the run, and what a killed process had only begun
            path.unlink()
        sync([*self._files(), staging])
        staging.rename(final)
        sync([final.parent, *(made.parent for made in self._made)])
        self._run = Run(final, manifest)

    def _manifest(self, note: ErrorNote | None) -> Manifest:
        asked = self.request
        return Manifest(
            run=self.run_id,
            stage=asked.stage,
            stage_version=asked.stage_version,
            experiment=asked.experiment,
            state=self.state,
            times=Times(started=_instant(self.begun), finished=_instant(datetime.now(UTC))),
            recipe=self.recipe,
            seed=asked.seed,
            parameters=dict(asked.parameters),
            inputs=tuple(asked.inputs),
            outputs=tuple(self._outputs()),
            results=tuple(self._results),
            error=note,
            code=code_state().code,
            environment=environment(),
            command=tuple(asked.command),
        )

    def _missing(self) -> str | None:
        return next((name for name in self._roles if not (self.staging / name).is_file()), None)

    def _files(self) -> list[Path]:
        return sorted(path for path in self.staging.iterdir() if path.is_file() and not path.name.startswith("."))

    def _outputs(self) -> Iterator[OutputRef]:
        """Files in the order in which they got their roles, then those that got none."""
        files = {path.name: path for path in self._files()}
        others = [name for name in files if name not in self._roles]
        roles = self._roles | {name: f"other-{number}" for number, name in enumerate(others, start=1)}
        for name, role in roles.items():
            if name in files:
                size = files[name].stat().st_size
                yield OutputRef(role=role, file=name, sha256=sha256_of(files[name]), size=size)


def _written(code: Code, its_environment: Environment) -> Mapping[str, str]:
    """What is the same in every manifest of this process, as it stands in each: most of its lines."""
    same = code is code_state().code and its_environment is environment()
    return _of_this_process() if same else {}


@cache
def _of_this_process() -> Mapping[str, str]:
    told = {"code": code_state().code, "environment": environment()}
    return {key: dump({key: value.model_dump()}) for key, value in told.items()}


def _instant(when: datetime) -> str:
    return f"{when:%Y-%m-%dT%H:%M:%S.%fZ}"
