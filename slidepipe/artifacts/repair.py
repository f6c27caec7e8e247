"""Putting right what can be put right without guessing; what is replaced goes to the trash."""

import os
import secrets
import shutil
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from slidepipe.artifacts.entry import SEAL
from slidepipe.artifacts.manifest import OutputRef
from slidepipe.artifacts.run import Run, is_whole
from slidepipe.artifacts.run_id import STAGING
from slidepipe.artifacts.seal import seal_of
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.trash import Trash
from slidepipe.artifacts.verify import verify_run


@dataclass(frozen=True, slots=True)
class Fix:
    """Something that can be put right: the run, the file, what would be done, and doing it."""

    run: str
    file: Path
    action: str
    apply: Callable[[], None]


def find_fixes(store: Store) -> Iterator[Fix]:
    """Find what can be put right: files of which a whole copy is somewhere in the store, and missing seals."""
    copies = _Copies(store)
    for run in store.survey().runs:
        spoilt = [output for output in run.manifest.outputs if not is_whole(run.directory / output.file, output)]
        mended = set[Path]()
        for output in spoilt:
            path, copy = run.directory / output.file, copies.find(output)
            if copy is not None:
                mended.add(path)
                yield Fix(run.id, path, f"copy {copy}, which has its sha256", _restoring(store, path, copy))
        rest = [one for one in verify_run(store, run) if one.file not in mended]
        if [one.file.name for one in rest] == [SEAL] and not (run.directory / SEAL).exists():
            action = "seal the run as it is, with a manifest that may have been edited"
            yield Fix(run.id, run.directory / SEAL, action, _sealing(run))


class _Copies:
    """Whole copies of files, by their hash."""

    def __init__(self, store: Store) -> None:
        self._places: dict[str, list[Path]] = {}
        for run in store.survey().runs:
            for output in run.manifest.outputs:
                self._places.setdefault(output.sha256, []).append(run.directory / output.file)
            for one in run.manifest.inputs:
                if one.run is None:
                    self._places.setdefault(one.sha256, []).append(Path(one.file))

    def find(self, output: OutputRef) -> Path | None:
        return next((path for path in self._places.get(output.sha256, ()) if is_whole(path, output)), None)


def _restoring(store: Store, path: Path, copy: Path) -> Callable[[], None]:
    def restore() -> None:
        draft = path.with_name(f"{STAGING}{secrets.token_hex(8)}")
        shutil.copyfile(copy, draft)
        if path.exists():
            Trash(store.root).take(path)
        draft.replace(path)

    return restore


def _sealing(run: Run) -> Callable[[], None]:
    def seal() -> None:
        draft = run.directory / f"{STAGING}{secrets.token_hex(8)}"
        draft.write_text(seal_of(run), encoding="utf-8")
        os.replace(draft, run.directory / SEAL)  # noqa: PTH105

    return seal
