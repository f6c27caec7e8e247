"""Repetitions of one plan as a person reads them."""

from rich.console import RenderableType
from rich.table import Table

from slidepipe.artifacts.repeat import Repeatability, RepeatDocument
from slidepipe.artifacts.run import Run
from slidepipe.artifacts.values import Pose
from slidepipe.cli.views.tables import NONE, columns, heading, planar

_NUMBERS = ("repetition", "x mm", "y mm", "theta mrad", "true x mm", "true y mm", "true mrad")


def repeat_view(repeat: RepeatDocument, run: Run) -> list[RenderableType]:
    """Error of every repetition, and their mean and standard deviation."""
    table = columns(*_NUMBERS, numbers=_NUMBERS)
    for row in repeat.rows:
        table.add_row(str(row.repetition), *_pose(row.error, "lost"), *_pose(row.true_error, NONE))
    _add_spread(table, repeat.estimated, repeat.true)
    return [
        heading(f"run {run.id}", repeat.experiment),
        f"error of the final pose from the goal; plan {repeat.plan}",
        table,
        "",
        f"{len(repeat.rows)} repetitions, {repeat.lost} lost the object",
        str(run.directory / "repeat.yaml"),
    ]


def _add_spread(table: Table, estimated: Repeatability | None, true: Repeatability | None) -> None:
    table.add_section()
    for name in ("mean", "std"):
        values = [getattr(one, name) if one is not None else None for one in (estimated, true)]
        cells = [cell for value in values for cell in (planar(value) if value is not None else (NONE,) * 3)]
        table.add_row(name, *cells)


def _pose(pose: Pose | None, missing: str) -> tuple[str, str, str]:
    return (missing, NONE, NONE) if pose is None else planar(pose.vector)
