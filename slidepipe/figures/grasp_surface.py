"""Fig. 5: the limit surfaces of four fingers, each in its own frame and in {b}, and that of the grasp."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from slidepipe.figures import style
from slidepipe.figures.scene import draw_block
from slidepipe.figures.surface import bare_axes, draw_mesh
from slidepipe.series import FloatArray, IntArray

AXES = ("$f_x$", "$f_y$", "$m_z$")


@dataclass(frozen=True, slots=True)
class SurfacePanel:
    """A triangle mesh in wrench space: (V, 3) in N and, divided by the lever of the figure, N; (F, 3)."""

    title: str
    vertices: FloatArray
    faces: IntArray


@dataclass(frozen=True, slots=True)
class GraspPicture:
    """Four fingers on a block, and eight panels' worth of their surfaces.

    Attributes
    ----------
    block_size_m : (2,)
    positions_m : (4, 2)
        Fingers in {b}; the last one is alone on its side.
    radius_m : (4,)
        Of their patches.
    panels : tuple of SurfacePanel
        (b) to (h), in the paper's order.
    """

    block_size_m: FloatArray
    positions_m: FloatArray
    radius_m: FloatArray
    panels: tuple[SurfacePanel, ...]


def draw_grasp_surface(data: GraspPicture) -> Figure:
    """Draw the grasp and its surfaces; all are in one scale, but the last, which is the largest, has its own."""
    with style.applied():
        figure = Figure(figsize=(9.0, 4.9))
        grid = figure.add_gridspec(2, 4, left=0.03, right=0.965, top=0.9, bottom=0.03, wspace=0.05, hspace=0.12)
        _draw_grasp(figure.add_subplot(grid[0, 0]), data)
        own = np.max([np.abs(panel.vertices).max(axis=0) for panel in data.panels[:-1]], axis=0)
        for index, panel in enumerate(data.panels, start=1):
            last = index == len(data.panels)
            reach = np.abs(panel.vertices).max(axis=0) if last else own
            axes = bare_axes(figure, grid[divmod(index, 4)], AXES, 1.25 * reach, size=1.8)
            axes.set_title(f"({chr(ord('a') + index)}) {panel.title}", y=0.98, fontsize=8.5)
            draw_mesh(axes, panel.vertices, panel.faces)
    return figure


def _draw_grasp(axes: Any, data: GraspPicture) -> None:
    axes.set_title("(a) fingers on the object, in {b}", fontsize=8.5)
    draw_block(axes, np.zeros(3), data.block_size_m, zorder=1)
    for index, (place, radius) in enumerate(zip(data.positions_m, data.radius_m, strict=True)):
        behind = index == len(data.positions_m) - 1
        angle = np.linspace(0.0, 2.0 * np.pi, 60)
        ring = place[:, None] + radius * np.stack([np.cos(angle), np.sin(angle)])
        axes.fill(*ring, facecolor="#c9d8ea" if not behind else "#f1c9a5", edgecolor="#333333", linewidth=0.8, zorder=3)
        if behind:
            axes.plot(*ring, color="white", linewidth=0.8, linestyle=(0, (3, 3)), zorder=4)
        axes.text(*place, str(index + 1), ha="center", va="center", zorder=5, fontsize=8.5)
    axes.set_aspect("equal")
    axes.margins(0.08)
    axes.set_axis_off()
