"""A sheet of panels: one column for each trial, one row for each quantity, one legend below them all."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from slidepipe.errors import InputError
from slidepipe.figures import style
from slidepipe.series import FloatArray

MARGIN = 0.06
"""Room above and below what a scale shows, as a share of it."""


@dataclass(frozen=True, slots=True)
class Row:
    """One row of a sheet.

    Attributes
    ----------
    label : str
        Quantity and unit.
    factor : float
        From the SI unit to the one that is shown.
    least_span : float
        Smallest range of values that is worth a whole scale, in the SI unit.
    height : float
        Beside the other rows' heights.
    """

    label: str
    factor: float
    least_span: float
    height: float = 1.0


def pose_rows(least_span_m: float, least_span_rad: float) -> tuple[Row, Row, Row]:
    """Make the three rows of a planar pose; an angle is shown in degrees."""
    return (
        Row("$x$ (mm)", 1e3, least_span_m),
        Row("$y$ (mm)", 1e3, least_span_m),
        Row("$θ$ (°)", float(np.degrees(1.0)), least_span_rad),
    )


@dataclass(frozen=True, slots=True)
class Sheet:
    """A figure in the making, with ``axes[row][column]``."""

    figure: Figure
    rows: tuple[Row, ...]
    axes: tuple[tuple[Any, ...], ...]

    def shade(self, column: int, slide_s: tuple[float, float] | None) -> None:
        """Shade the time in which the object slides."""
        if slide_s is not None:
            for line in self.axes:
                line[column].axvspan(*slide_s, **style.SLIDING)

    def scale(self, row: int, values: Sequence[FloatArray]) -> None:
        """Let a row's scale show all these values, given in the SI unit."""
        flat = np.concatenate([np.ravel(one) for one in values])
        flat = flat[np.isfinite(flat)]
        if not len(flat):
            return
        low, high = float(flat.min()), float(flat.max())
        missing = max(self.rows[row].least_span - (high - low), 0.0)
        low, high = low - missing / 2, high + missing / 2
        room = MARGIN * (high - low)
        self.axes[row][0].set_ylim((low - room) * self.rows[row].factor, (high + room) * self.rows[row].factor)

    def add_legend(self, lines: Sequence[tuple[str, style.Look]], areas: Sequence[tuple[str, style.Look]]) -> None:
        """Put the legend under the panels, where it hides nothing."""
        handles: list[Any] = [Line2D([], [], label=label, **_in_legend(look)) for label, look in lines]
        handles += [Patch(label=label, **look) for label, look in areas]
        columns = len(handles) if len(self.axes[0]) > 1 else min(len(handles), 3)
        with mpl.rc_context(dict(style.SETTINGS)):
            self.figure.legend(handles=handles, loc="outside lower center", ncols=columns, handlelength=3.0)

    def save(self, path: Path) -> None:
        """Write the picture as PNG; the same content makes the same bytes."""
        with mpl.rc_context(dict(style.SETTINGS)):
            self.figure.savefig(path, format="png", metadata={"Software": None})


def new_sheet(title: str, titles: Sequence[str], rows: Sequence[Row]) -> Sheet:
    """Empty panels with their titles and labels.

    A row has one scale in all columns, so that trials can be compared at a glance; a column has one time.

    Raises
    ------
    InputError
        There are no panels to draw.
    """
    if not titles:
        raise InputError("figure: there are no panels to draw, at least one is needed")
    heights = [row.height for row in rows]
    size = (0.8 + style.PANEL_WIDTH_IN * len(titles), 1.3 + style.ROW_HEIGHT_IN * sum(heights))
    with mpl.rc_context(dict(style.SETTINGS)):
        figure = Figure(figsize=size, layout="constrained")
        figure.suptitle(title, fontsize=11.0)
        grid = figure.subplots(len(rows), len(titles), sharex="col", sharey="row", squeeze=False, height_ratios=heights)
    for axes, text in zip(grid[0], titles, strict=True):
        axes.set_title(text, pad=6.0)
    for axes, row in zip(grid[:, 0], rows, strict=True):
        axes.set_ylabel(row.label)
    for axes in grid[-1]:
        axes.set_xlabel("time (s)")
    figure.align_ylabels(grid[:, 0])
    return Sheet(figure, tuple(rows), tuple(tuple(line) for line in grid))


def _in_legend(look: style.Look) -> dict[str, Any]:
    """Look of a line in the legend, where single dots would be too small to see."""
    return {**look, "markersize": 6.0} if "marker" in look else dict(look)
