"""One published run."""

from dataclasses import dataclass
from pathlib import Path

from slidepipe.artifacts.entry import MANIFEST
from slidepipe.artifacts.manifest import InputRef, Manifest, OutputRef
from slidepipe.artifacts.provenance import sha256_of
from slidepipe.artifacts.schema import parse
from slidepipe.artifacts.strict_yaml import load
from slidepipe.errors import InputError, NotFoundError, StoreError


@dataclass(frozen=True, slots=True)
class Run:
    """A directory of the store and its manifest; neither changes any more."""

    directory: Path
    manifest: Manifest

    @property
    def id(self) -> str:
        """The run's name."""
        return self.manifest.run

    def file(self, role: str) -> Path:
        """Path of the output that has a role, ``plan`` say.

        Raises
        ------
        NotFoundError
            The run has no such output; names those it has.
        """
        return self.directory / self._output(role).file

    def sha256(self, role: str) -> str:
        """Hash of the output that has a role, as it was when the run was published."""
        return self._output(role).sha256

    def input(self, role: str) -> InputRef:
        """Return the output as an input of another run."""
        output = self._output(role)
        return InputRef(role=role, sha256=output.sha256, size=output.size, run=self.id, file=output.file)

    def whole_input(self, role: str) -> InputRef:
        """Return the output as an input of another run, which must be made from what was published.

        Raises
        ------
        NotFoundError
            The run has no such output, or its file is missing.
        StoreError
            The file was changed since.
        """
        path = self.file(role)
        if not path.exists():
            raise NotFoundError(f"{path}: is missing (slidepipe repair restores it where there is a copy)")
        if not is_whole(path, self._output(role)):
            raise StoreError(f"{path}: was changed after it was published: nothing is made from it (slidepipe verify)")
        return self.input(role)

    def _output(self, role: str) -> OutputRef:
        for output in self.manifest.outputs:
            if output.role == role:
                return output
        there = ", ".join(one.role for one in self.manifest.outputs if not one.role.startswith("other-")) or "none"
        raise NotFoundError(f"run {self.id} of stage {self.manifest.stage}: has no {role}, its files are: {there}")


def read_run(directory: Path) -> Run:
    """Read a published run.

    Raises
    ------
    NotFoundError
        There is no such directory, or no manifest in it.
    StoreError
        The manifest is damaged.
    NewerSchemaError
        A newer slidepipe wrote it.
    """
    try:
        return Run(directory, parse(Manifest, load(directory / MANIFEST)))
    except InputError as error:
        raise StoreError(error.lines[0]) from None


def outside_input(role: str, path: Path) -> InputRef:
    """Make a reference to a file that is not in the store, such as an experiment file."""
    return InputRef(role=role, sha256=sha256_of(path), size=path.stat().st_size, run=None, file=str(path))


def is_whole(path: Path, output: OutputRef) -> bool:
    """Whether a file has the bytes with which an output was published."""
    return path.is_file() and path.stat().st_size == output.size and sha256_of(path) == output.sha256
