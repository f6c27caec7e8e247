"""How the joints followed their commands."""

from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from slidepipe.figures import style
from slidepipe.figures.paper import new_figure
from slidepipe.series import FloatArray

MOST = 400
"""Samples of a line; more cannot be seen."""


@dataclass(frozen=True, slots=True)
class JointsPicture:
    """Joint angles (T, n) over the time since the motion began, (T,), rad and s; when it was planned to slide."""

    time_s: FloatArray
    commanded: FloatArray
    measured: FloatArray
    slide_s: tuple[float, float]


def draw_joints(data: JointsPicture) -> Figure:
    """Draw a panel for each joint: the angle, and below it how far it was from its command."""
    with style.applied():
        every = max(1, len(data.time_s) // MOST)
        time_s, wanted, seen = data.time_s[::every], data.commanded[::every], data.measured[::every]
        count = wanted.shape[1]
        figure = new_figure(8.6, 4.4)
        grid = figure.subplots(2, count, sharex=True, height_ratios=(1.5, 1.0), sharey="row", squeeze=False)
        for joint in range(count):
            above, below = grid[:, joint]
            start = wanted[0, joint]
            above.plot(time_s, np.degrees(wanted[:, joint] - start), **style.WANTED)
            above.plot(time_s, np.degrees(seen[:, joint] - start), **style.MEASURED)
            below.plot(time_s, 1e3 * (seen[:, joint] - wanted[:, joint]), **{**style.MEASURED, "linewidth": 0.9})
            rms = 1e3 * float(np.sqrt(np.mean((data.measured[:, joint] - data.commanded[:, joint]) ** 2)))
            above.set_title(f"joint {joint + 1}", fontsize=8.5)
            below.set_title(f"rms {rms:.2f}", fontsize=7.5, pad=2.0)
            for axes in (above, below):
                axes.axvspan(*data.slide_s, **style.SLIDING)
                axes.tick_params(labelsize=7.0)
        grid[0, 0].set_ylabel("change (°)")
        grid[1, 0].set_ylabel("error (mrad)")
        figure.supxlabel("time (s)", fontsize=9.0)
    return figure
