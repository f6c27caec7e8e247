"""Dynamic in-hand sliding: plan, execute, estimate, iterate.

In a notebook, the stages are functions of this package, and runs are pandas DataFrames: see :mod:`slidepipe.notebook`.
They are loaded when they are first used.
"""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from slidepipe.notebook import (
        Run,
        Store,
        Trial,
        estimate,
        execute,
        iterate,
        open_store,
        plan,
        read_trial,
        run,
        runs,
    )

__version__ = "0.1.0"

__all__ = [
    "Run",
    "Store",
    "Trial",
    "__version__",
    "estimate",
    "execute",
    "iterate",
    "open_store",
    "plan",
    "read_trial",
    "run",
    "runs",
]


def __getattr__(name: str) -> object:
    """Load what a notebook uses when it is used: the command line must not wait for it."""
    if name not in __all__:
        raise AttributeError(f"module 'slidepipe' has no attribute {name!r}")
    from slidepipe import notebook  # noqa: PLC0415  # it loads everything that computes

    return getattr(notebook, name)


def __dir__() -> list[str]:
    """Names that a notebook completes."""
    return list(__all__)
