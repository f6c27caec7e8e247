"""Fig. 7: friction forces on the limit surface during the slide, and the velocities that belong to them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from slidepipe.figures import style
from slidepipe.figures.limit_surface import FORCES
from slidepipe.figures.surface import bare_axes, draw_arrow, draw_ellipsoid
from slidepipe.series import FloatArray

ARROWS = 7


@dataclass(frozen=True, slots=True)
class FrictionPanel:
    """One slide in {f}: moments divided by ``a``, turning multiplied by it.

    Attributes
    ----------
    title : str
    semi_axes : (3,)
        N.
    f, dv : (T, 3)
        Friction, N, and sliding velocity, m/s, of any length.
    """

    title: str
    semi_axes: FloatArray
    f: FloatArray
    dv: FloatArray


def draw_friction_path(panels: Sequence[FrictionPanel]) -> Figure:
    """Draw one surface for each slide."""
    with style.applied():
        figure = Figure(figsize=(4.0 * len(panels), 3.9))
        for index, panel in enumerate(panels):
            place = (index / len(panels), 0.07, 1.0 / len(panels), 0.86)
            axes = bare_axes(figure, place, FORCES, 1.1 * panel.semi_axes, size=1.5)
            figure.text(place[0] + 0.5 / len(panels), 0.955, f"({chr(ord('a') + index)}) {panel.title}", ha="center")
            _draw_panel(axes, panel)
        handles = [
            Line2D([], [], color=style.FORCE, linewidth=1.8, label="friction $f$"),
            Line2D([], [], color=style.VELOCITY, linewidth=1.8, label="sliding velocity $Δv$"),
            Line2D([], [], color="black", linewidth=1.8, label="path of $f$ over the slide"),
        ]
        figure.legend(handles=handles, loc="lower center", ncols=3, handlelength=2.2)
    return figure


def _draw_panel(axes: object, panel: FrictionPanel) -> None:
    draw_ellipsoid(axes, panel.semi_axes)
    chosen = np.unique(np.linspace(0, len(panel.f) - 1, ARROWS).round().astype(int))
    spread = float(np.ptp(panel.f, axis=0).max())
    for index in chosen if spread > 1e-6 * panel.semi_axes[0] else chosen[:1]:
        f, dv = panel.f[index], panel.dv[index]
        draw_arrow(axes, np.zeros(3), f, color=style.FORCE, width=1.5)
        draw_arrow(axes, f, 0.55 * panel.semi_axes[0] * dv / np.linalg.norm(dv), color=style.VELOCITY, width=1.5)
    axes.plot(*panel.f.T, color="black", linewidth=2.2, marker=".", markersize=2.0, zorder=15)  # type: ignore[attr-defined]
