"""The person before a real arm: asked before it moves, and shown how it goes meanwhile."""

import sys
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import click

from slidepipe.artifacts.lab_names import EXPERIMENTS
from slidepipe.cli import render

if TYPE_CHECKING:
    from collections.abc import Iterator

    from slidepipe.lab.desk import Progress
    from slidepipe.stages.on_lab import Question, RealLab
    from slidepipe.stages.streamer import Readiness

SHOWN_CHECKS = 3
NOT_ASKED = "nobody can be asked before the arm moves: answer beforehand with --yes"


@contextmanager
def watched(lab: str | None, *, yes: bool, beside: Path | None = None) -> "Iterator[RealLab | None]":
    """Make what an execution on a lab needs of the person; None where there is no such lab, but the simulated one.

    Raises
    ------
    click.UsageError
        Nobody can be asked, and nobody has answered beforehand.
    """
    if lab is None:
        yield None
        return
    if not yes and not sys.stdin.isatty():
        raise click.UsageError(NOT_ASKED)
    from slidepipe.stages.on_lab import RealLab  # noqa: PLC0415  # help must not wait for it

    person = _Person(yes=yes)
    try:
        yield RealLab(lab, person.confirm, None if yes else person.linked, person.progress, beside or EXPERIMENTS)
    finally:
        person.close()


class _Person:
    def __init__(self, *, yes: bool) -> None:
        self._yes = yes
        self._bar: _Bar | None = None

    def confirm(self, question: "Question") -> bool:
        found = question.found
        render.note(
            f"lab {question.lab.name}: {found.course_s:.1f} s in all, {found.approach_s:.1f} s to the start pose"
        )
        for check in _worth_showing(question):
            render.note(f"  {check}")
        with _ctrl_c_as_it_is():
            return self._yes or click.confirm("Move the arm?", err=True)

    def linked(self, found: "Readiness") -> None:  # noqa: ARG002  # the shape of the call
        with _ctrl_c_as_it_is():
            click.prompt("Link the arm at its console, then press Enter", default="", show_default=False, err=True)

    def progress(self, progress: "Progress") -> None:
        if not sys.stderr.isatty():
            return
        if self._bar is None:
            self._bar = _Bar()
        self._bar.show(progress)

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()


@contextmanager
def _ctrl_c_as_it_is() -> "Iterator[None]":
    """Let Ctrl-C at a question be what it is elsewhere: the trial is interrupted, not failed."""
    try:
        yield
    except click.Abort:
        raise KeyboardInterrupt from None


def _worth_showing(question: "Question") -> list[object]:
    """The checks nearest to their bounds, and always the elbow's speed and the torque nearest to the clip."""
    named = [next((one for one in question.checks if what in one.name), None) for what in ("torque", "elbow")]
    chosen = [*question.checks[:SHOWN_CHECKS], *(one for one in named if one is not None)]
    return list(dict.fromkeys(chosen))


class _Bar:
    """One line that is drawn again ten times a second, on a terminal only."""

    def __init__(self) -> None:
        from rich.console import Console  # noqa: PLC0415  # help must not wait for rich
        from rich.progress import BarColumn, TextColumn  # noqa: PLC0415
        from rich.progress import Progress as RichProgress  # noqa: PLC0415

        self._progress = RichProgress(
            TextColumn("{task.description:<9}"),
            BarColumn(bar_width=24),
            TextColumn(
                "{task.fields[error]:5.1f} mrad off  {task.fields[late]:6.0f} us late  "
                "{task.fields[rate]:3.0f} frames/s"
            ),
            console=Console(file=sys.stderr),
            transient=True,
        )
        self._task = self._progress.add_task("link", total=1.0, error=0.0, late=0.0, rate=0.0)
        self._frames, self._time_s = 0, 0.0
        self._progress.start()

    def show(self, progress: "Progress") -> None:
        elapsed_s, begun = progress.time_s - self._time_s, self._time_s > 0.0
        if elapsed_s <= 0.0:
            return
        rate = (progress.frames - self._frames) / elapsed_s if begun else 0.0
        self._frames, self._time_s = progress.frames, progress.time_s
        self._progress.update(
            self._task,
            description=progress.phase.value,
            completed=progress.done,
            error=1e3 * progress.tracking_error_rad,
            late=1e6 * progress.late_s,
            rate=rate,
        )

    def close(self) -> None:
        self._progress.stop()
