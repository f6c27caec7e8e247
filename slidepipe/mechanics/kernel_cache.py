"""Where compiled kernels are kept: beside the code or in the user's cache; where neither can be written, for a run."""

import atexit
import shutil
import tempfile
import warnings
from pathlib import Path

import numba


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


def _probe() -> None:
    """Let numba look for a place; it raises RuntimeError if there is none."""
    numba.njit(cache=True)(_nothing)


def _nothing() -> None:
    return None
