"""How every picture looks: one meaning, one line, told apart in grey as well as in colour."""

from collections.abc import Mapping
from contextlib import AbstractContextManager
from types import MappingProxyType
from typing import Any

import matplotlib as mpl

DPI = 180
PANEL_WIDTH_IN = 5.0
"""Width of one column of a picture, inches."""

ROW_HEIGHT_IN = 1.75
"""Height of one row of a picture, inches."""

Look = Mapping[str, Any]
"""Keyword arguments of one kind of line or area."""


def _look(**keywords: Any) -> Look:
    return MappingProxyType(keywords)


WANTED = _look(color="black", linestyle=(0, (4.5, 2.5)), linewidth=1.1, zorder=5)
"""What was planned or commanded."""
MEASURED = _look(color="#1f5fa8", linestyle="-", linewidth=1.6, zorder=4)
"""What was measured, or estimated from it."""
TRUE = _look(color="#d9730d", linestyle=(0, (6, 1.6, 1, 1.6)), linewidth=1.1, zorder=6)
"""What was true in a simulated lab."""
RAW = _look(color="#8b949e", linestyle="none", marker=".", markersize=2.6, markeredgewidth=0.0, zorder=2)
"""Single samples as the cameras gave them."""
GOAL = _look(color="#8a1c3c", linestyle=(0, (1, 1.4)), linewidth=1.3, zorder=3)
BAND = _look(facecolor="#8a1c3c", alpha=0.13, linewidth=0.0, zorder=1)
"""What the goal's tolerance allows."""
SLIDING = _look(facecolor="#cfeacb", edgecolor="#5b9a55", linewidth=0.5, zorder=0)
"""When the object slides in the fingers."""

PHASES: Mapping[str, Look] = MappingProxyType(
    {
        "stick": _look(color="#1f5fa8", linestyle="-", linewidth=1.5),
        "slide": _look(color="#2e7d32", linestyle="-", linewidth=3.2),
        "settle": _look(color="#6b7480", linestyle=(0, (5, 2)), linewidth=1.5),
    }
)
"""Paths in the three kinds of phases: in grey they differ in weight and dash."""
BLOCK = _look(facecolor="#efe9dc", edgecolor="#4a4a4a", linewidth=0.9)
"""The object, and {b} on it."""
CONTACT = _look(facecolor="#b3261e", edgecolor="white", linewidth=0.5)
"""Where the finger touches."""
FINGER = _look(color="#8b4513", linewidth=1.6, solid_capstyle="round")
"""Which way the finger points."""
FORCE, VELOCITY = "#8b4513", "#2fb0cc"
"""Friction, and the sliding velocity that belongs to it."""
SURFACE = "#9aa7b4"
"""Limit surfaces."""
AXES = ("#1f5fa8", "#d9730d", "#2e7d32")
"""x, y and theta where they share a panel; their lines are :data:`DASHES`."""
DASHES = ("-", (0, (5, 1.8)), (0, (1.2, 1.2)))

SETTINGS = MappingProxyType(
    {
        "font.family": "DejaVu Sans",
        "font.size": 9.0,
        "axes.titlesize": 10.0,
        "axes.labelsize": 9.0,
        "axes.linewidth": 0.6,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.formatter.useoffset": False,
        "axes.xmargin": 0.015,
        "axes.grid": True,
        "axes.axisbelow": True,
        "grid.color": "#d8dce0",
        "grid.linewidth": 0.4,
        "xtick.labelsize": 8.0,
        "ytick.labelsize": 8.0,
        "legend.frameon": False,
        "legend.fontsize": 9.0,
        "figure.facecolor": "white",
        "figure.dpi": DPI,
        "savefig.dpi": DPI,
        "pdf.fonttype": 42,
        "svg.hashsalt": "slidepipe",
    }
)
"""Settings of matplotlib that hold for every picture."""


def applied() -> AbstractContextManager[None]:
    """Context in which pictures are made and written."""
    context: AbstractContextManager[None] = mpl.rc_context(dict(SETTINGS))
    return context
