"""Fig. 2: how a wrong friction lengthens or shortens the slide of Section III-D."""

from dataclasses import dataclass
from typing import Any

from matplotlib.figure import Figure

from slidepipe.figures import style
from slidepipe.figures.one_dof_profile import FINGER, OBJECT
from slidepipe.figures.paper import mark_phases, new_figure
from slidepipe.series import FloatArray

LESS: style.Look = {"facecolor": "#bfe3b4", "edgecolor": "#3d7a35", "hatch": "....", "linewidth": 0.0}
MORE: style.Look = {"facecolor": "#f6c58f", "edgecolor": "#a85f10", "hatch": "////", "linewidth": 0.0}
SURE: style.Look = {"facecolor": "#d5dde6", "edgecolor": "#d5dde6", "linewidth": 0.0}


@dataclass(frozen=True, slots=True)
class FrictionErrorPicture:
    """Velocities (T,) of the finger, and of the object under the friction as estimated, less and more, m/s.

    Attributes
    ----------
    time_s : (T,)
    finger, nominal, less, more : (T,)
    eps : float
        By how much less and more, as a share.
    areas_m : three of float
        Slide with more friction, and the errors d_2 and d_3 of eqs. (5) and (6): lengths, m.
    edges_s : (5,)
        Between which T1 to T4 lie.
    """

    time_s: FloatArray
    finger: FloatArray
    nominal: FloatArray
    less: FloatArray
    more: FloatArray
    eps: float
    areas_m: tuple[float, float, float]
    edges_s: tuple[float, ...]


def draw_friction_error(data: FrictionErrorPicture) -> Figure:
    """Draw the velocities; the areas between them are lengths."""
    with style.applied():
        figure = new_figure(5.4, 3.7)
        axes = figure.subplots()
        sure, short, long = data.areas_m
        _fill(axes, data, (data.finger, data.more), SURE, f"$d_1$ = {1e3 * sure:.1f} mm")
        _fill(axes, data, (data.more, data.nominal), MORE, f"$d_2$ = {1e3 * short:.1f} mm")
        _fill(axes, data, (data.nominal, data.less), LESS, f"$d_3$ = {1e3 * long:.1f} mm")
        axes.plot(data.time_s, data.finger, **FINGER, zorder=4)
        axes.plot(data.time_s, data.nominal, **{**OBJECT, "label": "object, $μ = μ_0$"}, zorder=5)
        more = (data.more, "+", {"color": MORE["edgecolor"], "linestyle": (0, (1, 1))})
        less = (data.less, "-", {"color": LESS["edgecolor"], "linestyle": (0, (5, 1.5, 1, 1.5))})
        for values, sign, look in (more, less):
            label = f"object, $μ = μ_0(1 {sign} {data.eps:g})$"
            axes.plot(data.time_s, values, linewidth=1.2, label=label, zorder=5, **look)
        mark_phases(axes, data.edges_s, ("$T_1$", "$T_2$", "$T_3$", "$T_4$"))
        axes.set_xlabel("time (s)")
        axes.set_ylabel("velocity (m/s)")
        figure.legend(loc="outside lower center", ncols=3, handlelength=2.6)
    return figure


def _fill(axes: Any, data: FrictionErrorPicture, ends: tuple[FloatArray, FloatArray], look: Any, label: str) -> None:
    axes.fill_between(data.time_s, *ends, label=label, zorder=2, **look)
