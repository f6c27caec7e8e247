"""Fig. 3: an object in a two-fingered pinch, its frames and the vectors between them."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from slidepipe.figures import style
from slidepipe.figures.paper import letter, new_figure
from slidepipe.figures.scene import draw_block, draw_finger
from slidepipe.series import FloatArray

ARROW = {"arrowstyle": "-|>", "shrinkA": 0.0, "shrinkB": 0.0, "linewidth": 1.1}


@dataclass(frozen=True, slots=True)
class Name:
    """A frame's name and where it stands beside its origin, m."""

    text: str
    offset_m: tuple[float, float]


@dataclass(frozen=True, slots=True)
class PinchPicture:
    """A pinched block: poses (3,) in {w}, sides (2,) along x_b and y_b, thickness, m; force of each finger, N."""

    q_o: FloatArray
    q_f: FloatArray
    block_size_m: FloatArray
    thickness_m: float
    patch_radius_m: float
    normal_force_per_finger_n: float


def draw_pinch(data: PinchPicture) -> Figure:
    """Draw it in the plane of motion, and along it with both fingers."""
    with style.applied():
        figure = new_figure(7.0, 3.9)
        plane, across = figure.subplots(1, 2, width_ratios=(1.75, 1.0))
        _draw_plane(plane, data)
        _draw_across(across, data)
        letter((plane, across))
    return figure


def _draw_plane(axes: Any, data: PinchPicture) -> None:
    length = 0.038
    draw_block(axes, data.q_o, data.block_size_m, zorder=1)
    draw_finger(axes, data.q_f, 0.05, zorder=6)
    _frame(axes, np.zeros(3), length, Name("{w}", (-0.018, -0.012)))
    _frame(axes, data.q_o, length, Name("{b}", (0.018, -0.012)))
    _frame(axes, data.q_f, length, Name("{f}", (-0.024, 0.012)))
    _vector(axes, np.zeros(2), data.q_o[:2], "$q_o$", side=1.0)
    _vector(axes, np.zeros(2), data.q_f[:2], "$q_f$", side=-1.0)
    _vector(axes, data.q_o[:2], data.q_f[:2], "$r_f$", side=1.0)
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.14)
    axes.set_xlabel("$x$ (m)")
    axes.set_ylabel("$y$ (m)")


def _frame(axes: Any, pose: FloatArray, length: float, name: Name) -> None:
    x, y, theta = (float(value) for value in pose)
    for turn, axis in ((0.0, "x"), (0.5 * np.pi, "y")):
        way = np.array([np.cos(theta + turn), np.sin(theta + turn)])
        tip = np.array([x, y]) + length * way
        axes.annotate("", tip, (x, y), arrowprops={**ARROW, "color": "#222222"}, zorder=8)
        axes.text(*(tip + 0.008 * way), axis, fontsize=7.5, ha="center", va="center", zorder=8)
        axes.plot(*tip[:, None], linewidth=0.0)
    away = np.array([x, y]) + name.offset_m
    axes.text(*away, name.text, ha="center", va="center", fontsize=9.0, fontweight="bold", zorder=9)


def _vector(axes: Any, start: FloatArray, stop: FloatArray, name: str, *, side: float) -> None:
    axes.annotate("", stop, start, arrowprops={**ARROW, "color": style.AXES[0], "linestyle": "-"}, zorder=7)
    axes.plot(*np.stack([start, stop]).T, linewidth=0.0)
    across = side * np.array([start[1] - stop[1], stop[0] - start[0]])
    place = start + 0.55 * (stop - start) + 0.012 * across / np.linalg.norm(across)
    axes.text(*place, name, color=style.AXES[0], ha="center", va="center", fontsize=10.0, zorder=9)


def _draw_across(axes: Any, data: PinchPicture) -> None:
    half, tall, patch = 0.5 * data.thickness_m, float(data.block_size_m[1]), data.patch_radius_m
    axes.add_patch(Rectangle((-half, -0.5 * tall), 2.0 * half, tall, **style.BLOCK))
    pad, arm = 0.006, 0.022
    for side in (-1.0, 1.0):
        left = half if side > 0 else -half - pad
        axes.add_patch(Rectangle((left, -patch), pad, 2.0 * patch, facecolor="#b3261e", edgecolor="none"))
        start = side * (half + pad + arm)
        axes.annotate(
            "", (side * (half + pad), 0.0), (start, 0.0), arrowprops={**ARROW, "color": style.FORCE, "linewidth": 1.8}
        )
        axes.text(start + side * 0.002, 0.007, f"$f_{{N{1 if side < 0 else 2}}}$", ha="center", color=style.FORCE)
    axes.annotate(
        "",
        (half + pad + 0.004, patch),
        (half + pad + 0.004, 0.0),
        arrowprops={**ARROW, "arrowstyle": "|-|", "mutation_scale": 3},
    )
    axes.text(half + pad + 0.008, 0.6 * patch, "$a$", va="center")
    told = f"{data.normal_force_per_finger_n:g} N each"
    axes.text(0.0, -0.5 * tall - 0.012, told, ha="center", fontsize=8.5)
    axes.set_xlim(-0.06, 0.06)
    axes.set_xticks([-0.04, 0.0, 0.04])
    axes.set_ylim(-0.5 * tall - 0.02, 0.5 * tall + 0.01)
    axes.set_aspect("equal")
    axes.set_xlabel("across the plane (m)")
