"""The seal of a run: ``run.sha256``, the hashes of its manifest and of every other file, in the format of sha256sum.

An edit of the manifest breaks it, and ``sha256sum --check run.sha256`` tells so on a machine without slidepipe.
"""

import re
from collections.abc import Iterator, Mapping
from pathlib import Path

from slidepipe.artifacts.entry import MANIFEST, SEAL
from slidepipe.artifacts.provenance import sha256_of
from slidepipe.artifacts.run import Run
from slidepipe.errors import NotFoundError, StoreError

_LINE = re.compile(r"([0-9a-f]{64})  ([^/\0]+)")


def seal_text(hashes: Mapping[str, str]) -> str:
    r"""Seal over files, by name.

    Examples
    --------
    >>> seal_text({"run.yaml": "ab" * 32})[-11:]
    '  run.yaml\n'
    """
    return "".join(f"{digest}  {name}\n" for name, digest in hashes.items())


def seal_of(run: Run) -> str:
    """Seal that a run should have: over its manifest as it is now, and the outputs as it names them."""
    hashes = {MANIFEST: sha256_of(run.directory / MANIFEST)}
    return seal_text(hashes | {output.file: output.sha256 for output in run.manifest.outputs})


def read_seal(directory: Path) -> dict[str, str]:
    """Hashes by file name, as they were when the run was published.

    Raises
    ------
    NotFoundError
        The run has no seal.
    StoreError
        A line of it is damaged.
    """
    path = directory / SEAL
    try:
        lines = path.read_bytes().decode("utf-8", "replace").splitlines()
    except OSError:
        raise NotFoundError(f"{path}: no such file") from None
    return dict(_entries(path, lines))


def _entries(path: Path, lines: list[str]) -> Iterator[tuple[str, str]]:
    for number, line in enumerate(lines, start=1):
        match = _LINE.fullmatch(line)
        if match is None:
            raise StoreError(f"{path}:{number}: must read SHA256, two spaces, file name")
        yield match[2], match[1]
