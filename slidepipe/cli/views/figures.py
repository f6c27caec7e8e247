"""Figures that were drawn, as a person reads it."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import RenderableType

from slidepipe.cli.views.tables import columns
from slidepipe.stages.figure_names import CAPTIONS

if TYPE_CHECKING:
    from slidepipe.stages.figures import FigureWritten


def figures_view(written: Sequence["FigureWritten"], table: Path | None) -> list[RenderableType]:
    """One line for each figure, and where the captions and the numbers are."""
    shown = columns("figure", "shows", "files")
    for one in written:
        shown.add_row(one.name, one.title, f"{one.paths[0].with_suffix('')}.[pdf|svg|png]")
    captions = str(written[0].paths[0].with_name(CAPTIONS)) if written else ""
    return [shown, "", f"captions  {captions}", *([f"numbers   {table}"] if table else [])]
