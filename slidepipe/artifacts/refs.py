"""Names that people give to runs: ``refs/EXPERIMENT/NAME``, a file of one line, replaced as a whole."""

import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from slidepipe.artifacts.durable import folder, sync, whole
from slidepipe.artifacts.run_id import day_of
from slidepipe.artifacts.wording import instead, one_of
from slidepipe.errors import InputError, NotFoundError, StoreError

if TYPE_CHECKING:
    from slidepipe.artifacts.run import Run

LATEST = "latest"
_NAME = re.compile(r"[a-z0-9][a-z0-9._-]{0,63}")


@dataclass(frozen=True, slots=True)
class Ref:
    """A name within an experiment, and the run that it means."""

    experiment: str
    name: str
    run: str


@dataclass(frozen=True, slots=True)
class Refs:
    """The names below a directory; it comes to be with the first of them."""

    directory: Path

    def all(self) -> tuple[Ref, ...]:
        """Every name, in order.

        Raises
        ------
        StoreError
            A file does not hold a run id.
        """
        return tuple(self.read(path) for path in self.paths())

    def set(self, name: str, run: "Run") -> Ref:
        """Give a run a name within its experiment; the name may have meant another run before.

        Raises
        ------
        InputError
            The name is not one.
        """
        _check(name)
        path = self.directory / run.manifest.experiment / name
        folder(path.parent, StoreError)
        with whole(path, StoreError) as draft:
            draft.write_text(f"{run.id}\n", encoding="utf-8")
            sync([draft])
        return self.read(path)

    def delete(self, reference: str) -> Ref:
        """Take a name away, ``NAME`` or ``EXPERIMENT/NAME``; the run stays.

        Raises
        ------
        NotFoundError
            There is no such name, or several experiments have it.
        """
        ref = self.find(reference)
        (self.directory / ref.experiment / ref.name).unlink(missing_ok=True)
        return ref

    def resolve(self, reference: str) -> str:
        """Run id that ``@NAME`` or ``@EXPERIMENT/NAME`` means."""
        return self.find(reference).run

    def find(self, reference: str) -> Ref:
        """Find a name: ``NAME`` or ``EXPERIMENT/NAME``, with or without ``@``.

        Raises
        ------
        NotFoundError
            There is no such name, or several experiments have it.
        """
        experiment, _, name = reference.removeprefix("@").rpartition("/")
        paths = [path for path in self.paths(experiment or "*") if path.name == name]
        if not paths:
            known = [f"@{LATEST}", f"@{LATEST}:STAGE", *(f"@{path.name}" for path in self.paths())]
            raise NotFoundError(f"run {reference}: no such name, {instead(reference, known)}")
        if len(paths) > 1:
            raise NotFoundError(f"run {reference}: may be {one_of([f'@{path.parent.name}/{name}' for path in paths])}")
        return self.read(paths[0])

    def paths(self, experiment: str = "*") -> list[Path]:
        """Files of the names, whether or not they hold what they should."""
        if not re.fullmatch(r"\*|[a-z0-9_-]+", experiment):
            return []
        return sorted(path for path in self.directory.glob(f"{experiment}/*") if not path.name.startswith("."))

    @staticmethod
    def read(path: Path) -> Ref:
        """Read the file of a name."""
        try:
            run = path.read_bytes().decode("utf-8", "replace").strip()
        except FileNotFoundError:
            raise NotFoundError(f"{path}: no such name") from None
        except OSError as error:
            raise StoreError(f"{path}: cannot be read: {error.strerror}") from None
        if day_of(run) is None:
            raise StoreError(f"{path}: must hold one line, a run id, got {run[:60]!r}")
        return Ref(path.parent.name, path.name, run)


def _check(name: str) -> None:
    if name == LATEST or not _NAME.fullmatch(name):
        raise InputError(f"name {name!r}: must begin with a-z or 0-9, then a-z 0-9 . _ -, and not be {LATEST!r}")
