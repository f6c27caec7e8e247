"""Waiting until what was written is on the disk."""

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

AT_ONCE = 8


def sync(paths: Sequence[Path]) -> None:
    """Wait until files and directories are on the disk.

    All are asked for at once: a journalling file system then commits them together, in a fraction of the time.
    """
    if len(paths) == 1:
        _sync(paths[0])
        return
    with ThreadPoolExecutor(min(AT_ONCE, len(paths))) as pool:
        list(pool.map(_sync, paths))


def _sync(path: Path) -> None:
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
