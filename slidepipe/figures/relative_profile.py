"""Fig. 6: the relative motion of one coordinate over the slide."""

from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from slidepipe.figures import style
from slidepipe.figures.paper import mark_phases, new_figure
from slidepipe.series import FloatArray


@dataclass(frozen=True, slots=True)
class RelativePicture:
    """Relative motion along the way to the goal: (T,) distance, speed and acceleration, m and s.

    ``edges_s`` are the start of the motion, of the slide, of its second half, its end, and the end of the motion.
    """

    time_s: FloatArray
    distance: FloatArray
    speed: FloatArray
    acceleration: FloatArray
    edges_s: tuple[float, ...]


def draw_relative_profile(data: RelativePicture) -> Figure:
    """Draw acceleration, speed and distance."""
    with style.applied():
        figure = new_figure(4.6, 4.6)
        panels = figure.subplots(3, 1, sharex=True)
        rows = (
            (data.acceleration, r"$\ddot{r}_f^b$ (m/s²)"),
            (data.speed, r"$\dot{r}_f^b$ (m/s)"),
            (1e3 * data.distance, "$r_f^b$ (mm)"),
        )
        for axes, (values, label) in zip(panels, rows, strict=True):
            axes.axvspan(data.edges_s[1], data.edges_s[3], **style.SLIDING)
            drawn = "steps-post" if values is data.acceleration else "default"
            axes.plot(data.time_s, values, color=style.AXES[0], linewidth=1.7, drawstyle=drawn, zorder=4)
            axes.set_ylabel(label)
            mark_phases(axes, data.edges_s[1:4], ("$T_2$", "$T_3$") if axes is panels[0] else ())
        room = 0.12 * (data.edges_s[3] - data.edges_s[1])
        panels[0].set_xlim(data.edges_s[1] - 4 * room, min(data.edges_s[3] + 4 * room, float(np.max(data.time_s))))
        panels[-1].set_xlabel("time (s)")
        figure.align_ylabels(panels)
    return figure
