"""Fig. 8: the object and the finger along the whole motion, and the slide in detail."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from slidepipe.figures import style
from slidepipe.figures.paper import letter, new_figure
from slidepipe.figures.scene import draw_block, draw_finger
from slidepipe.series import FloatArray

ARROW = {"arrowstyle": "-|>", "color": "black", "shrinkA": 0.0, "shrinkB": 0.0}


ACCELERATION: style.Look = {"color": "#d9730d", "linewidth": 1.4}


@dataclass(frozen=True, slots=True)
class TrajectoryPanel:
    """One motion: (T,) times, (T, 3) poses of object and finger and acceleration of the object in {w}, the slide."""

    title: str
    time_s: FloatArray
    q_o: FloatArray
    q_f: FloatArray
    ddq_o: FloatArray
    slide_s: tuple[float, float]
    block_size_m: FloatArray

    @property
    def sliding(self) -> slice:
        """Samples of the slide."""
        start, stop = np.searchsorted(self.time_s, np.array(self.slide_s) - 1e-9)
        return slice(int(start), int(stop) + 1)


def draw_trajectories(panels: Sequence[TrajectoryPanel]) -> Figure:
    """Draw a row for each motion: the whole, and the slide."""
    with style.applied():
        figure = new_figure(7.6, 3.9 * len(panels))
        grid = figure.subplots(len(panels), 2, squeeze=False)
        for row, panel in zip(grid, panels, strict=True):
            _draw_whole(row[0], panel)
            _draw_slide(row[1], panel)
        letter(grid.ravel())
        handles = [
            Line2D([], [], color="#8b949e", linewidth=1.5, label="object's centre"),
            Line2D([], [], color="black", linewidth=3.0, label="while it slides"),
            Line2D([], [], color="#b3261e", linewidth=0.9, marker="o", markersize=4, label="finger"),
            Line2D([], [], **ACCELERATION, marker=">", markersize=4, label="object's acceleration"),
        ]
        figure.legend(handles=handles, loc="outside lower center", ncols=4)
    return figure


def _draw_whole(axes: Any, panel: TrajectoryPanel) -> None:
    moments = np.unique(np.concatenate([[0.0], panel.slide_s, [panel.time_s[-1]]]))
    for index in np.searchsorted(panel.time_s, moments - 1e-9):
        draw_block(axes, panel.q_o[index], panel.block_size_m, alpha=0.7, zorder=1)
        draw_finger(axes, panel.q_f[index], 0.03, zorder=6)
    axes.plot(*panel.q_o[:, :2].T, color="#8b949e", linewidth=1.3, zorder=3)
    axes.plot(*panel.q_f[:, :2].T, color="#b3261e", linewidth=0.7, zorder=4)
    axes.plot(*panel.q_o[panel.sliding, :2].T, color="black", linewidth=3.0, zorder=5)
    for begin, end in ((0.0, panel.slide_s[0]), (panel.slide_s[1], float(panel.time_s[-1]))):
        _draw_way(axes, panel, 0.5 * (begin + end))
    axes.set_title(panel.title)
    _finish(axes)


def _draw_way(axes: Any, panel: TrajectoryPanel, moment_s: float) -> None:
    """Thick arrow beside the path, along which the object moves at this moment."""
    index = int(np.searchsorted(panel.time_s, moment_s))
    here, way = panel.q_o[index, :2], panel.q_o[index + 10, :2] - panel.q_o[index - 10, :2]
    way = way / max(float(np.linalg.norm(way)), 1e-9)
    start = here + 0.022 * np.array([way[1], -way[0]])
    axes.annotate("", start + 0.055 * way, start, arrowprops={**ARROW, "linewidth": 2.4}, zorder=8)


def _draw_slide(axes: Any, panel: TrajectoryPanel) -> None:
    part = panel.sliding
    indices = np.linspace(part.start, part.stop - 2, 5).round().astype(int)
    for index in indices:
        draw_block(axes, panel.q_o[index], panel.block_size_m, alpha=0.45, zorder=1)
        draw_finger(axes, panel.q_f[index], 0.03, zorder=6)
    axes.plot(*panel.q_f[part, :2].T, color="#b3261e", linewidth=0.9, zorder=4)
    axes.plot(*panel.q_o[part, :2].T, color="black", linewidth=3.0, zorder=5)
    peak = float(np.max(np.linalg.norm(panel.ddq_o[indices, :2], axis=1)))
    for index in indices:
        tip = panel.q_o[index, :2] + 0.06 * panel.ddq_o[index, :2] / peak
        axes.annotate("", tip, panel.q_o[index, :2], arrowprops={**ARROW, **ACCELERATION}, zorder=7)
    axes.set_title(f"slide, {panel.slide_s[0]:.1f} to {panel.slide_s[1]:.1f} s, up to {peak:.1f} m/s²", fontsize=9.0)
    _finish(axes)


def _finish(axes: Any) -> None:
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.08)
    axes.set_xlabel("$x$ (m)")
    axes.set_ylabel("$y$ (m)")
