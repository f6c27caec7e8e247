"""Where the trials of an experiment began and ended in relative displacement space: the paper's Fig. 12."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Patch
from matplotlib.ticker import MaxNLocator

from slidepipe.errors import InputError
from slidepipe.figures import style
from slidepipe.series import BoolArray, FloatArray

MM, DEGREES = 1e3, float(np.degrees(1.0))
WANTED = "#c1121f"
"""The paper draws the desired values in red."""
PLANE = "#6e7781"
LEAST_TURN = 5.0
"""Degrees above and below no turn that are worth a whole scale."""


@dataclass(frozen=True, slots=True)
class RepeatabilityPicture:
    """K trials; relative poses r_f_b of the finger in {b}, ``[x, y, theta]`` in m and rad, NaN where there is none.

    Attributes
    ----------
    start, goal : (K, 3)
        What was planned.
    initial, final : (K, 3)
        What was measured at rest before and after.
    outlying : (K,) bool
        Trials that stand out.
    """

    start: FloatArray
    goal: FloatArray
    initial: FloatArray
    final: FloatArray
    outlying: BoolArray
    position_tolerance_m: float

    def __post_init__(self) -> None:
        count = len(self.final)
        if not count:
            raise InputError("figure: there are no trials to draw, at least one is needed")
        for name in ("start", "goal", "initial", "final"):
            if np.shape(getattr(self, name)) != (count, 3):
                raise InputError(f"figure: {name} must be ({count}, 3), got {np.shape(getattr(self, name))}")
        if np.shape(self.outlying) != (count,):
            raise InputError(f"figure: outlying must be ({count},), got {np.shape(self.outlying)}")

    def shown(self, poses: FloatArray) -> FloatArray:
        """Poses as they are drawn: x and y in mm, and the turn since the planned start in degrees, within 180."""
        turn = poses[:, 2] - self.start[:, 2]
        turn = np.arctan2(np.sin(turn), np.cos(turn))
        return np.column_stack([poses[:, :2] * MM, turn * DEGREES])

    @property
    def colours(self) -> Any:
        """One colour for each trial, from the first to the last."""
        return mpl.colormaps["viridis"](np.linspace(0.0, 0.88, len(self.final)))


def draw_repeatability(picture: RepeatabilityPicture, path: Path) -> None:
    """Draw the trials in space as the paper does, and flat beside it: in space nobody can read a distance off.

    Raises
    ------
    InputError
        There are no trials.
    """
    with mpl.rc_context(dict(style.SETTINGS)):
        figure = Figure(figsize=(13.0, 4.9), layout="constrained")
        count = len(picture.final)
        figure.suptitle(
            f"Repeatability over {count} {'trial' if count == 1 else 'trials'}: finger in the body frame, $r_f^b$",
            fontsize=11.0,
        )
        grid = figure.add_gridspec(1, 3, width_ratios=(1.25, 0.85, 0.9))
        _draw_space(figure.add_subplot(grid[0], projection="3d"), picture)
        _draw_plane(figure.add_subplot(grid[1]), picture)
        _draw_errors(figure.add_subplot(grid[2]), picture)
        figure.legend(handles=_legend(picture), loc="outside lower center", ncols=6)
        figure.savefig(path, format="png", metadata={"Software": None})


def _draw_space(axes: Any, picture: RepeatabilityPicture) -> None:
    start, goal, initial, final = (
        picture.shown(poses) for poses in (picture.start, picture.goal, picture.initial, picture.final)
    )
    for before, after, colour in zip(initial, final, picture.colours, strict=True):
        axes.plot(*np.stack([before, after]).T, color=colour, linewidth=0.6, alpha=0.5)
    axes.scatter(*initial.T, c=picture.colours, marker="^", s=26.0, depthshade=False)
    axes.scatter(*final.T, c=picture.colours, marker="o", s=26.0, depthshade=False)
    axes.scatter(*start.T, c=WANTED, marker="^", s=44.0, depthshade=False)
    axes.scatter(*goal.T, c=WANTED, marker="o", s=44.0, depthshade=False)
    across = np.array(np.meshgrid(*(_reach(column) for column in np.concatenate([start, goal, initial, final]).T[:2])))
    axes.plot_surface(*across, np.zeros_like(across[0]), color=PLANE, alpha=0.22, linewidth=0.0)
    low, high = axes.get_zlim()
    axes.set(xlabel="$x$ (mm)", ylabel="$y$ (mm)", zlabel="turn (°)")
    axes.set_zlim(min(low, -LEAST_TURN), max(high, LEAST_TURN))
    axes.view_init(elev=22.0, azim=-58.0)
    axes.set_box_aspect(None, zoom=0.92)
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        axis.set_major_locator(MaxNLocator(5))


def _draw_plane(axes: Any, picture: RepeatabilityPicture) -> None:
    start, goal, initial, final = (
        picture.shown(poses) for poses in (picture.start, picture.goal, picture.initial, picture.final)
    )
    for centre in np.unique(goal[:, :2], axis=0):
        axes.add_patch(Circle(tuple(centre), picture.position_tolerance_m * MM, **style.BAND))
    for before, after, colour in zip(initial, final, picture.colours, strict=True):
        axes.plot(*np.stack([before, after])[:, :2].T, color=colour, linewidth=0.6, alpha=0.5, zorder=2)
    axes.scatter(*initial.T[:2], c=picture.colours, marker="^", s=22.0, zorder=3)
    axes.scatter(*final.T[:2], c=picture.colours, marker="o", s=22.0, zorder=3)
    axes.scatter(*start.T[:2], c=WANTED, marker="^", s=40.0, zorder=4)
    axes.scatter(*goal.T[:2], c=WANTED, marker="o", s=40.0, zorder=4)
    out = final[picture.outlying]
    axes.scatter(*out.T[:2], facecolors="none", edgecolors="black", marker="o", s=110.0, zorder=5)
    axes.set(xlabel="$x$ (mm)", ylabel="$y$ (mm)", aspect="equal", adjustable="box")
    axes.margins(0.12)
    axes.set_title("along the plane's normal")


def _draw_errors(axes: Any, picture: RepeatabilityPicture) -> None:
    """Final errors over the trials: x and y in mm on the left scale, the turn in degrees on the right."""
    error = picture.shown(picture.final) - picture.shown(picture.goal)
    trials = np.arange(1, len(error) + 1)
    angles = axes.twinx()
    axes.plot(trials, error[:, 0], "s-", color="#1f5fa8", linewidth=0.9, markersize=3.5, label="$x$")
    axes.plot(trials, error[:, 1], "D--", color="#2e7d32", linewidth=0.9, markersize=3.5, label="$y$")
    angles.plot(trials, error[:, 2], "o:", color="#d9730d", linewidth=0.9, markersize=3.5)
    axes.plot([], [], "o:", color="#d9730d", linewidth=0.9, markersize=3.5, label="turn (right)")
    for one in (axes, angles):
        reach = 1.15 * max(abs(value) for value in (*one.get_ylim(), 1e-3))
        one.set_ylim(-reach, reach)
    angles.grid(visible=False)
    angles.spines["right"].set_visible(True)
    axes.axhline(0.0, color="black", linewidth=0.6)
    axes.set(xlabel="trial", ylabel="final error (mm)")
    angles.set_ylabel("final error (°)")
    axes.xaxis.get_major_locator().set_params(integer=True, min_n_ticks=1)
    axes.set_xlim(0.6, len(error) + 0.4)
    axes.set_title("final minus desired")
    axes.legend(loc="best", frameon=True, framealpha=0.8, edgecolor="none")


def _reach(values: FloatArray) -> FloatArray:
    values = values[np.isfinite(values)]
    room = 0.1 * max(float(np.ptp(values)), 1.0)
    return np.array([values.min() - room, values.max() + room])


def _legend(picture: RepeatabilityPicture) -> list[Any]:
    grey: dict[str, Any] = {"color": "#5c6570", "linestyle": "none", "markersize": 5.5}
    red: dict[str, Any] = {"color": WANTED, "linestyle": "none", "markersize": 6.5}
    handles: list[Any] = [
        Line2D([], [], marker="^", label="initial", **grey),
        Line2D([], [], marker="o", label="final", **grey),
        Line2D([], [], marker="^", label="desired initial", **red),
        Line2D([], [], marker="o", label="desired final", **red),
        Patch(facecolor=PLANE, alpha=0.3, label="no turn"),
    ]
    if picture.outlying.any():
        handles.append(
            Line2D([], [], marker="o", markersize=9.0, markerfacecolor="none", color="black", linestyle="none",
                   label="stands out")
        )  # fmt: skip
    return handles
