"""Pictures for print: sizes, panel letters, and the three files that each is written to."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from slidepipe.figures import style

FORMATS = ("pdf", "svg", "png")
_NO_DATE = {"pdf": {"CreationDate": None}, "svg": {"Date": None}, "png": {"Software": None}}
PNG_DPI = 220


def new_figure(width_in: float, height_in: float) -> Figure:
    """Empty figure of a size in inches, whose panels are laid out by themselves."""
    return Figure(figsize=(width_in, height_in), layout="constrained")


def save_figure(figure: Figure, directory: Path, name: str) -> tuple[Path, ...]:
    """Write a figure as PDF, SVG and PNG; the same content makes the same bytes.

    Returns
    -------
    tuple of Path
        In the order of :data:`FORMATS`.
    """
    paths = tuple(directory / f"{name}.{kind}" for kind in FORMATS)
    with style.applied():
        for kind, path in zip(FORMATS, paths, strict=True):
            figure.savefig(path, format=kind, dpi=PNG_DPI, metadata=_NO_DATE[kind])
    return paths


def letter(axes: Iterable[Any]) -> None:
    """Put (a), (b) ... at the upper left of the panels."""
    for index, one in enumerate(axes):
        one.set_title(f"({chr(ord('a') + index)})", loc="left", fontweight="bold", fontsize=9.0)


def mark_phases(axes: Any, edges_s: Iterable[float], names: Iterable[str]) -> None:
    """Draw lines at the edges between phases, and the phases' names above the panel."""
    edges, words = tuple(edges_s), tuple(names)
    for edge in edges:
        axes.axvline(edge, color="#8b949e", linewidth=0.6, linestyle=(0, (2, 2)), zorder=1)
    for start, stop, word in zip(edges, edges[1:], words, strict=False):
        place = {"xytext": (0, 3), "textcoords": "offset points", "xycoords": axes.get_xaxis_transform()}
        axes.annotate(word, (0.5 * (start + stop), 1.0), ha="center", va="bottom", fontsize=8.0, **place)
