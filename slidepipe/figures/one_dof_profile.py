"""Fig. 1: finger and object over time in the one-dimensional problem of Section III."""

from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from slidepipe.figures import style
from slidepipe.figures.paper import mark_phases, new_figure
from slidepipe.series import FloatArray

FINGER: style.Look = {"color": style.AXES[0], "linewidth": 1.7, "label": "finger"}
OBJECT: style.Look = {"color": "#b3261e", "linewidth": 1.5, "linestyle": (0, (4, 2)), "label": "object"}
GAP: style.Look = {"facecolor": "#f3b26b", "edgecolor": "#a85f10", "linewidth": 0.0, "alpha": 0.75}


@dataclass(frozen=True, slots=True)
class OneDofPicture:
    """Motions along a line.

    Attributes
    ----------
    time_s : (T,)
    finger, object : (3, T)
        Position, velocity and acceleration in m and s.
    edges_s : (5,)
        The times between which T1, T2, T3 and T4 lie.
    d_goal_m : float
    """

    time_s: FloatArray
    finger: FloatArray
    object: FloatArray
    edges_s: tuple[float, ...]
    d_goal_m: float


def draw_one_dof_profile(data: OneDofPicture) -> Figure:
    """Draw acceleration, velocity and position; the shaded area is the slide."""
    with style.applied():
        figure = new_figure(4.6, 5.6)
        panels = figure.subplots(3, 1, sharex=True)
        labels = ("acceleration (m/s²)", "velocity (m/s)", "position (m)")
        for axes, order, label in zip(panels, (2, 1, 0), labels, strict=True):
            axes.plot(data.time_s, data.finger[order], **FINGER, zorder=4)
            axes.plot(data.time_s, data.object[order], **OBJECT, zorder=5)
            axes.set_ylabel(label)
            mark_phases(axes, data.edges_s, ("$T_1$", "$T_2$", "$T_3$", "$T_4$") if order == 2 else ())
        panels[1].fill_between(data.time_s, data.finger[1], data.object[1], zorder=2, **GAP)
        slide = np.searchsorted(data.time_s, 0.5 * (data.edges_s[1] + data.edges_s[3]))
        middle = 0.5 * (data.finger[1, slide] + data.object[1, slide])
        panels[1].annotate(
            f"$|d_c| = {abs(data.d_goal_m):g}$ m",
            (data.time_s[slide], middle),
            xytext=(-78, -22),
            textcoords="offset points",
            arrowprops={"arrowstyle": "-", "linewidth": 0.6},
            fontsize=8.5,
        )
        panels[0].legend(loc="lower left", ncols=1, handlelength=2.8)
        panels[-1].set_xlabel("time (s)")
        figure.align_ylabels(panels)
    return figure
