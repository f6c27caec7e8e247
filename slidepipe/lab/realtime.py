"""What a process does to keep time: a priority of its own, memory that stays, and no garbage collector."""

import ctypes
import gc
import os
from collections.abc import Iterator
from contextlib import contextmanager

PRIORITY = 80
"""Of SCHED_FIFO: above everything ordinary, below the kernel's own threads at 99."""
_MCL_CURRENT, _MCL_FUTURE = 1, 2


@contextmanager
def realtime(priority: int = PRIORITY) -> Iterator[tuple[str, ...]]:
    """Keep time as well as this machine permits; yields what it did not permit, a line each.

    The garbage collector is frozen and off, memory is locked, and the process is scheduled first in, first out.
    Everything is given back on leaving.
    """
    refused = [line for line in (_lock_memory(), _schedule(priority)) if line]
    gc.collect()
    gc.freeze()
    gc.disable()
    try:
        yield tuple(refused)
    finally:
        gc.enable()
        gc.unfreeze()
        _give_back()


def _lock_memory() -> str | None:
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.mlockall(_MCL_CURRENT | _MCL_FUTURE) == 0:
        return None
    return f"memory is not locked: {os.strerror(ctypes.get_errno())} (raise the limit of locked memory, ulimit -l)"


def _schedule(priority: int) -> str | None:
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(priority))
    except (OSError, AttributeError) as error:
        return f"no real-time scheduling: {error.strerror if isinstance(error, OSError) else error} (ulimit -r)"
    return None


def _give_back() -> None:
    ctypes.CDLL(None).munlockall()
    if os.sched_getscheduler(0) == os.SCHED_FIFO:
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
