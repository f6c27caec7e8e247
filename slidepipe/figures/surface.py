"""Limit surfaces in the space of forces and moments."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

from slidepipe.figures import style
from slidepipe.series import FloatArray, IntArray

VIEW = (24.0, -52.0)
"""Elevation and azimuth, degrees, from which every surface is seen."""
WIRES = 12


def bare_axes(figure: Any, place: Any, labels: Sequence[str], half_width: FloatArray, *, size: float = 1.0) -> Any:
    """Axes in space without boxes and panes: three arrows through the origin, in equal scale.

    Parameters
    ----------
    figure : Figure or SubFigure
    place : SubplotSpec, or four numbers
        Where in the figure.
    labels : three of str
        At the arrows' tips.
    half_width : (3,)
        What must be seen, on either side of the origin.
    size : float
        Zoom.
    """
    make = figure.add_axes if isinstance(place, tuple) else figure.add_subplot
    axes = make(place, projection="3d", proj_type="ortho", computed_zorder=False)
    axes.set_axis_off()
    axes.patch.set_alpha(0.0)
    axes.view_init(*VIEW)
    reach = 1.22 * np.asarray(half_width, dtype=float)
    for axis, label in enumerate(labels):
        tip = np.zeros(3)
        tip[axis] = reach[axis]
        axes.plot(*np.stack([-tip, tip]).T, color="#555555", linewidth=0.7, zorder=1)
        axes.text(*(1.12 * tip), label, ha="center", va="center", zorder=20)
    for setter, value in zip((axes.set_xlim, axes.set_ylim, axes.set_zlim), reach, strict=True):
        setter(-value, value)
    axes.set_box_aspect(tuple(reach), zoom=size)
    return axes


def draw_ellipsoid(axes: Any, semi_axes: FloatArray, alpha: float = 0.22) -> None:
    """Draw an ellipsoid about the origin: a clear skin, and its circles of latitude and longitude."""
    u, v = np.linspace(0.0, 2.0 * np.pi, 73), np.linspace(-0.5 * np.pi, 0.5 * np.pi, 37)
    axes.plot_surface(
        *_ellipsoid(u, v, semi_axes), color=style.SURFACE, alpha=alpha, linewidth=0.0, shade=True, zorder=2
    )
    for longitude in np.linspace(0.0, np.pi, WIRES // 2, endpoint=False):
        ring = _ellipsoid(np.array([longitude, longitude + np.pi]), v, semi_axes)
        for half in range(2):
            axes.plot(*(part[half] for part in ring), color="#6b7480", linewidth=0.35, zorder=3)
    for latitude in np.linspace(-0.5 * np.pi, 0.5 * np.pi, WIRES // 2 + 1)[1:-1]:
        line = _ellipsoid(u, np.array([latitude]), semi_axes)
        axes.plot(*(part[:, 0] for part in line), color="#6b7480", linewidth=0.35, zorder=3)


def draw_mesh(axes: Any, vertices: FloatArray, faces: IntArray) -> None:
    """Draw a triangle mesh (V, 3), (F, 3) in space, lit from the upper left."""
    corner = vertices[faces]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    light = np.array([-0.35, -0.55, 0.75])
    shade = 0.7 + 0.3 * np.clip((normal / np.where(length > 0.0, length, 1.0)) @ light, -1.0, 1.0)
    colour = np.clip(shade[:, None] * np.array([0.74, 0.79, 0.84]) / 0.85, 0.0, 1.0)
    axes.add_collection3d(Poly3DCollection(corner, facecolors=colour, edgecolors="#5c6670", linewidths=0.12, zorder=2))


def draw_arrow(axes: Any, start: FloatArray, vector: FloatArray, *, color: str, width: float = 1.6) -> None:
    """Draw an arrow in space; its head lies in the plane of the picture as well as it can."""
    start, vector = np.asarray(start, dtype=float), np.asarray(vector, dtype=float)
    tip, size = start + vector, 0.16 * float(np.linalg.norm(vector))
    if size == 0.0:
        return
    elevation, azimuth = np.radians(VIEW)
    sight = np.array([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)])
    along = vector / np.linalg.norm(vector)
    side = np.cross(along, sight)
    side = side / max(float(np.linalg.norm(side)), 1e-9)
    base = tip - size * along
    head = np.array([tip, base + 0.38 * size * side, base - 0.38 * size * side])
    shaft = Line3DCollection([np.array([start, base])], colors=[color], linewidths=width, zorder=12)
    point = Poly3DCollection([head], facecolors=color, edgecolors=color, linewidths=0.4, zorder=13)
    for part in (shaft, point):
        axes.add_collection3d(part)
        part.set_clip_on(False)


def _ellipsoid(u: FloatArray, v: FloatArray, semi_axes: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    x, y, z = (float(value) for value in semi_axes)
    return (
        x * np.outer(np.cos(u), np.cos(v)),
        y * np.outer(np.sin(u), np.cos(v)),
        z * np.outer(np.ones_like(u), np.sin(v)),
    )
