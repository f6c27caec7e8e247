"""Fig. 12: where repeated trials begin and end, in the space of the relative pose."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.figure import Figure

from slidepipe.figures import style
from slidepipe.figures.surface import VIEW
from slidepipe.series import FloatArray

MARKERS = {"start": "^", "end": "o"}
WANTED = "#c62828"


HOLLOW: Mapping[str, Any] = MappingProxyType(
    {"color": WANTED, "markerfacecolor": "none", "markeredgewidth": 1.8, "markersize": 10}
)
"""What is wanted: a ring about what was reached, which shows in grey as well."""


@dataclass(frozen=True, slots=True)
class Repeat:
    """One trial: relative pose (3,) before and after, ``[x, y, theta]``, m and rad."""

    start: FloatArray
    end: FloatArray


@dataclass(frozen=True, slots=True)
class RepeatsPicture:
    """Trials of one plan, those with the least friction first; ``start`` and ``goal`` (3,) as it wants them.

    ``paper_end`` and ``paper_sd`` (3,) are the mean end that the paper reports, and its standard deviation.
    """

    repeats: Sequence[Repeat]
    start: FloatArray
    goal: FloatArray
    paper_end: FloatArray
    paper_sd: FloatArray


def draw_repeats(data: RepeatsPicture) -> Figure:
    """Draw them in space, and beside it where they end in the plane, with the ellipse of the paper's mean and s.d."""
    with style.applied():
        figure = Figure(figsize=(8.6, 4.2))
        space = figure.add_axes((0.0, 0.02, 0.5, 0.96), projection="3d", proj_type="ortho")
        _draw_space(space, data)
        plane = figure.add_axes((0.585, 0.2, 0.395, 0.7))
        _draw_plane(plane, data)
        handles, labels = plane.get_legend_handles_labels()
        figure.legend(handles, labels, loc="lower center", ncols=5, handletextpad=0.3, columnspacing=1.2)
        figure.text(0.02, 0.93, "(a)", fontweight="bold")
        figure.text(0.54, 0.93, "(b)", fontweight="bold")
    return figure


def shades(count: int) -> list[Any]:
    """Colours from dark to light, one for each trial: told apart in grey as well."""
    return [colormaps["viridis"](value) for value in np.linspace(0.05, 0.92, count)]


def _draw_space(axes: Any, data: RepeatsPicture) -> None:
    scale, turn = np.array([1e3, 1e3, np.degrees(1.0)]), np.array([0.0, 0.0, float(data.start[2])])
    points = {"start": [(one.start - turn) * scale for one in data.repeats]}
    points["end"] = [(one.end - turn) * scale for one in data.repeats]
    wanted = [(data.start - turn) * scale, (data.goal - turn) * scale]
    for index, colour in enumerate(shades(len(data.repeats))):
        start, end = points["start"][index], points["end"][index]
        axes.plot(*np.stack([start, end]).T, color=colour, linewidth=0.6, alpha=0.7)
        axes.plot(*np.stack([end, [end[0], end[1], 0.0]]).T, color="#8b949e", linewidth=0.6)
        axes.plot(*end[:, None], marker=MARKERS["end"], color=colour, markersize=5, markeredgecolor="black", mew=0.3)
        axes.plot(
            *start[:, None], marker=MARKERS["start"], color=colour, markersize=5, markeredgecolor="black", mew=0.3
        )
    axes.plot(*np.stack(wanted).T, color=WANTED, linewidth=1.0, linestyle=(0, (4, 2)))
    axes.plot(*wanted[0][:, None], marker=MARKERS["start"], **HOLLOW)
    axes.plot(*wanted[1][:, None], marker=MARKERS["end"], **HOLLOW)
    everything = np.array([*points["start"], *points["end"], *wanted])
    low, high = everything.min(axis=0) - 4.0, everything.max(axis=0) + 4.0
    grid = np.meshgrid([low[0], high[0]], [low[1], high[1]])
    axes.plot_surface(*grid, np.zeros((2, 2)), color="#9aa7b4", alpha=0.3)
    axes.set(xlabel="$x$ (mm)", ylabel="$y$ (mm)", zlabel="$θ$ (°)")
    axes.view_init(VIEW[0], -60.0)
    axes.set_box_aspect(None, zoom=0.88)


def _draw_plane(axes: Any, data: RepeatsPicture) -> None:
    angle = np.linspace(0.0, 2.0 * np.pi, 90)
    ring = 1e3 * (data.paper_end[:2, None] + data.paper_sd[:2, None] * np.stack([np.cos(angle), np.sin(angle)]))
    look = {"edgecolor": "#555555", "linewidth": 0.8, "linestyle": (0, (3, 2)), "facecolor": "#e3e6ea", "zorder": 1}
    axes.fill(*ring, label="paper's end, mean ± s.d.", **look)
    for index, (colour, one) in enumerate(zip(shades(len(data.repeats)), data.repeats, strict=True)):
        edge = {"markeredgecolor": "black", "mew": 0.3, "linestyle": "none", "color": colour, "zorder": 4}
        named = {"start": "start", "end": "end"} if index == len(data.repeats) // 2 else {}
        axes.plot(*(1e3 * one.start[:2, None]), marker="^", markersize=5, label=named.get("start"), **edge)
        axes.plot(*(1e3 * one.end[:2, None]), marker="o", markersize=6, label=named.get("end"), **edge)
    wanted = {**HOLLOW, "linestyle": "none", "zorder": 5}
    axes.plot(*(1e3 * data.start[:2, None]), marker="^", label="start wanted", **wanted)
    axes.plot(*(1e3 * data.goal[:2, None]), marker="o", label="goal", **wanted)
    axes.plot(*(1e3 * np.stack([data.start[:2], data.goal[:2]]).T), color=WANTED, linewidth=0.8, zorder=2)
    axes.set(xlabel="$x$ of $r_f^b$ (mm)", ylabel="$y$ of $r_f^b$ (mm)")
    axes.set_aspect("equal", adjustable="datalim")
