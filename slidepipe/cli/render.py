"""The one place that prints: data on stdout, everything else on stderr."""

import json
import logging
import os
import shutil
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, TextIO

from slidepipe.errors import SlidepipeError

if TYPE_CHECKING:
    from rich.console import Console, RenderableType

WIDTH = 100
"""Columns that every view fits, and that are used where the terminal has fewer or there is none."""


def put(parts: Iterable["RenderableType"]) -> None:
    """Print tables and lines of text on stdout; in colour on a terminal only, and not where NO_COLOR is set."""
    from rich.text import Text  # noqa: PLC0415  # help must not wait for rich

    console = _console(sys.stdout)
    usual = console.width
    with console.capture() as printed:
        for part in parts:
            console.width = max(usual, _needed(console, part))
            console.print(part, soft_wrap=isinstance(part, str | Text), crop=False)
    for line in printed.get().splitlines():
        sys.stdout.write(line.rstrip() + "\n")


def put_json(schema: str, content: Mapping[str, object]) -> None:
    """Print one JSON object on stdout, its schema first."""
    sys.stdout.write(json.dumps({"schema": schema, **content}, indent=2, allow_nan=False) + "\n")


class _Notes(logging.Handler):
    """What the rooms below have to say while somebody watches."""

    def emit(self, record: logging.LogRecord) -> None:
        note(record.getMessage())


def hear() -> None:
    """Print what slidepipe says meanwhile on stderr, on a terminal only."""
    log = logging.getLogger("slidepipe")
    if sys.stderr.isatty() and not log.handlers:
        log.addHandler(_Notes())
        log.setLevel(logging.INFO)


def note(line: str) -> None:
    """Print a message or a step of progress on stderr, on one plain line."""
    sys.stderr.write(f"{line}\n")
    sys.stderr.flush()


def fail(error: SlidepipeError) -> None:
    """Print what is wrong on stderr: one plain line for each fault, never wrapped."""
    for line in str(error).splitlines() or [type(error).__name__]:
        note(f"error: {line}")


def forgive_encoding() -> None:
    """Let characters that the terminal cannot show be replaced, where they would otherwise end the command."""
    for stream, errors in ((sys.stdout, "replace"), (sys.stderr, "backslashreplace")):
        reconfigure = getattr(stream, "reconfigure", None)
        if reconfigure is not None:
            reconfigure(errors=errors)


def _needed(console: "Console", part: "RenderableType") -> int:
    """Columns that a table must have so that no number and no word is cut, though other cells may be wrapped."""
    from rich.table import Table  # noqa: PLC0415

    if not isinstance(part, Table):
        return 0
    needed = console.measure(part, options=console.options.update(width=10 * WIDTH))
    return needed.maximum if all(column.no_wrap for column in part.columns) else needed.minimum


def _console(stream: TextIO) -> "Console":
    from rich.console import Console  # noqa: PLC0415  # help must not wait for rich

    terminal = stream.isatty()
    coloured = terminal and not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb"
    return Console(
        file=stream,
        width=max(WIDTH, shutil.get_terminal_size().columns) if terminal else WIDTH,
        color_system="auto" if coloured else None,
        force_terminal=terminal,
        markup=False,
        emoji=False,
        highlight=False,
    )


@contextmanager
def progress(what: str) -> "Iterator[Callable[[int, int], None]]":
    """Bar on stderr, which is told how many of how many are done."""
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn  # noqa: PLC0415

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=_console(sys.stderr), transient=True) as bar:
        task = bar.add_task(what, total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)
