"""Tables and numbers as every view shows them: lengths in mm, angles in mrad, times in s."""

import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from rich import box
from rich.table import Table
from rich.text import Text

if TYPE_CHECKING:
    from slidepipe.artifacts.values import Planar

NONE = "-"
"""What stands where there is no value."""
BARE = ("1", "of 1")
"""Units of numbers without a dimension."""


def facts(rows: Iterable[tuple[str, str]]) -> Table:
    """Names and what belongs to them, two columns without a frame."""
    table = Table.grid(padding=(0, 2, 0, 0))
    table.add_column(no_wrap=True, style="bold")
    table.add_column(overflow="fold")
    for name, value in rows:
        table.add_row(name, value)
    return table


def columns(*names: str, numbers: Sequence[str] = ()) -> Table:
    """Empty table with these columns; those named in ``numbers`` are set flush right."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False, padding=(0, 1, 0, 0), header_style="bold")
    for name in names:
        table.add_column(name, justify="right" if name in numbers else "left", no_wrap=True)
    return table


def heading(text: str, *more: str) -> Text:
    """First line of a view: its name in bold, and what else is worth a word there."""
    return Text.assemble((text, "bold"), *(f"  {word}" for word in more))


def length_mm(value_m: float) -> str:
    """Length in mm.

    Examples
    --------
    >>> length_mm(-1e-9), length_mm(0.0123456)
    ('0.00', '12.35')
    """
    return fixed(1e3 * value_m, 2)


def angle_mrad(value_rad: float) -> str:
    """Angle in mrad."""
    return fixed(1e3 * value_rad, 1)


def fixed(value: float, digits: int) -> str:
    """Return a number with so many digits after the point, and no minus sign before a zero."""
    return f"{round(value, digits) + 0.0:.{digits}f}"


def number(value: float | None, unit: str = "1") -> str:
    """Return a number with four significant digits and its unit, if it has one.

    Examples
    --------
    >>> number(0.00012346, "m"), number(0.5), number(None)
    ('0.0001235 m', '0.5', '-')
    """
    if value is None:
        return NONE
    return f"{value:.4g}" if unit in BARE else f"{value:.4g} {unit}"


def interval(ends: tuple[float, float], unit: str) -> str:
    """Both ends of an interval, and the unit."""
    return f"[{ends[0]:.4g}, {ends[1]:.4g}] {unit}"


def friction(value: float | None) -> str:
    """Coefficient of friction."""
    return NONE if value is None else fixed(value, 4)


def friction_interval(ends: tuple[float, float] | None) -> str:
    """Both ends of an interval of the coefficient of friction.

    Examples
    --------
    >>> friction_interval((0.4156, 0.434))
    '[0.4156, 0.4340]'
    """
    return NONE if ends is None else f"[{fixed(ends[0], 4)}, {fixed(ends[1], 4)}]"


def planar(vector: "Planar") -> tuple[str, str, str]:
    """Return x and y in mm, theta in mrad."""
    return length_mm(vector[0]), length_mm(vector[1]), angle_mrad(vector[2])


def near(vector: "Planar", reference: "Planar") -> "Planar":
    """Pose with its angle in the turn that is nearest to a reference's.

    Examples
    --------
    >>> near((0.0, 0.0, -3.0), (0.0, 0.0, 3.0))[2].__round__(3)
    3.283
    """
    turns = round((reference[2] - vector[2]) / (2.0 * math.pi))
    return vector[0], vector[1], vector[2] + 2.0 * math.pi * turns


def share(part: int, whole: int) -> str:
    """Return a count and its share of the whole."""
    return f"{part} ({100.0 * part / whole:.1f} %)" if whole else str(part)


def size(count: int) -> str:
    """Return a number of bytes as a person reads it.

    Examples
    --------
    >>> size(999), size(203_400)
    ('999 B', '203.4 kB')
    """
    if count < 1000:
        return f"{count} B"
    return f"{count / 1e3:.1f} kB" if count < 1_000_000 else f"{count / 1e6:.1f} MB"
