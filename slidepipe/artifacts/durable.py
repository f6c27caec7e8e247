"""Files that are there whole or not at all, and waiting until they are on the disk."""

import os
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path

from slidepipe.errors import InputError, SlidepipeError

AT_ONCE = 8


def folder(directory: Path, fault: type[SlidepipeError] = InputError) -> None:
    """Make a directory where there is none.

    Raises
    ------
    SlidepipeError
        It cannot be made: the kind that is given as ``fault``.
    """
    try:
        directory.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise fault(f"{directory}: cannot be made a folder: {error.strerror}") from None


@contextmanager
def whole(path: Path, fault: type[SlidepipeError] = InputError) -> Iterator[Path]:
    """Give a file to write that takes the other's place when all is done; that it can be made is seen to first.

    Raises
    ------
    SlidepipeError
        It cannot be written: the kind that is given as ``fault``.
    """
    draft = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        draft.touch()
        yield draft
        draft.replace(path)
    except OSError as error:
        raise fault(f"{path}: cannot be written: {error.strerror}") from None
    finally:
        with suppress(OSError):
            draft.unlink(missing_ok=True)


def sync(paths: Sequence[Path]) -> None:
    """Wait until files and directories are on the disk.

    All are asked for at once: a journalling file system then commits them together, in a fraction of the time.
    """
    if len(paths) == 1:
        _sync(paths[0])
        return
    list(_pool(os.getpid()).map(_sync, paths))


@cache
def _pool(pid: int) -> ThreadPoolExecutor:
    """Threads that wait, those of this process alone: a fork has none of its parent's."""
    return ThreadPoolExecutor(AT_ONCE, thread_name_prefix=f"sync-{pid}")


def _sync(path: Path) -> None:
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
