"""Where compiled kernels are kept: beside the code or in the user's cache; where neither can be written, for a run."""

import atexit
import logging
import shutil
import tempfile
import warnings
from pathlib import Path

import numba
from numba.core import event

LOG = logging.getLogger("slidepipe.kernels")
"""Says once in a process that kernels are compiled, which takes up to two minutes at the very first use."""


def keep_compiled_code() -> None:
    """Make sure that kernels can be cached: without a place for it numba refuses to load them.

    Where neither the code's directory nor the user's cache can be written, a directory for this process alone is
    taken, and a warning says so.
    """
    try:
        _probe()
    except RuntimeError:
        numba.config.CACHE_DIR = tempfile.mkdtemp(prefix="slidepipe-")
        atexit.register(shutil.rmtree, numba.config.CACHE_DIR, ignore_errors=True)
        warnings.warn(
            f"compiled code cannot be kept in {Path(__file__).parent} or in the user's cache directory: every run "
            "compiles again; set NUMBA_CACHE_DIR to a directory that can be written",
            RuntimeWarning,
            stacklevel=2,
        )


class Compiling(event.Listener):  # type: ignore[misc]  # numba has no types
    """Waits for the first kernel that is not found in the cache."""

    def __init__(self) -> None:
        self._told = False

    def on_start(self, _: event.Event) -> None:
        """Say so, once."""
        if not self._told:
            LOG.info("compiling what is compiled once, at the first use: this may take two minutes")
        self._told = True

    def on_end(self, _: event.Event) -> None:
        """Nothing is said at the end."""


def tell_compiling() -> None:
    """Let :data:`LOG` know when kernels are compiled."""
    event.register("numba:compile", Compiling())


def _probe() -> None:
    """Let numba look for a place; it raises RuntimeError if there is none."""
    numba.njit(cache=True)(_nothing)


def _nothing() -> None:
    return None
