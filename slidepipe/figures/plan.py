"""A planned motion at a glance: its way in the plane and over time, its friction, and what wrong friction does."""

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from slidepipe.errors import InputError
from slidepipe.figures import style
from slidepipe.figures.scene import draw_block, draw_finger
from slidepipe.figures.surface import bare_axes, draw_ellipsoid
from slidepipe.figures.traces import check_poses, near
from slidepipe.series import FloatArray

ROUNDING_S = 1e-9
"""Times that differ by less are the same."""
LABELS: tuple[dict[str, Any], ...] = ({"xytext": (-7, -11), "ha": "right"}, {"xytext": (7, 5), "ha": "left"})
"""Where the time stands beside a finger, in turn, so that neighbours do not hide each other."""
PhaseKind = Literal["stick", "slide", "settle"]


@dataclass(frozen=True, slots=True)
class PhaseSpan:
    """One phase of a motion, s: ``stick`` before a slide, ``slide``, and ``settle`` after the last one."""

    kind: PhaseKind
    start_s: float
    stop_s: float


@dataclass(frozen=True, slots=True)
class Robustness:
    """Where the motion ends for other frictions than the believed one.

    Attributes
    ----------
    mu_ratio : (K,)
        True over believed friction, rising.
    error_m, error_rad : (K,)
        Distance of the final relative pose from the goal, m, and turn away from it, rad; NaN where the object is lost.
    eps_low, eps_high : float
        The motion survives every ratio from ``1 - eps_low`` to ``1 + eps_high``.
    """

    mu_ratio: FloatArray
    error_m: FloatArray
    error_rad: FloatArray
    eps_low: float
    eps_high: float


@dataclass(frozen=True, slots=True)
class PlanPicture:
    """A planned motion, sampled over its time; poses ``[x, y, theta]`` and their rates in m, rad and s.

    Attributes
    ----------
    title : str
    phases : tuple of PhaseSpan
        One after the other, from the first sample to the last.
    time_s : (T,)
    q_o, q_f : (T, 3)
        Object and finger in {w}.
    r_f_b : (T, 3)
        The finger in {b}.
    ddq_o, ddq_f : (T, 3)
        Accelerations in {w}.
    f_f : (T, 3)
        Friction on the object about the contact, in {f}: ``[f_x, f_y, m_z]`` in N and N m.
    semi_axes : (3,)
        Of the limit surface: ``mu f_N`` twice, N, and ``c a mu f_N``, N m.
    patch_radius_m : float
        ``a``, by which moments are divided to be drawn beside forces.
    block_size_m : (2,)
        Sides of the object along x_b and y_b.
    robustness : Robustness, optional

    Raises
    ------
    InputError
        The series do not belong together, or there is no phase.
    """

    title: str
    phases: tuple[PhaseSpan, ...]
    time_s: FloatArray
    q_o: FloatArray
    q_f: FloatArray
    r_f_b: FloatArray
    ddq_o: FloatArray
    ddq_f: FloatArray
    f_f: FloatArray
    semi_axes: FloatArray
    patch_radius_m: float
    block_size_m: FloatArray
    robustness: Robustness | None = None

    def __post_init__(self) -> None:
        for name in ("q_o", "q_f", "r_f_b", "ddq_o", "ddq_f", "f_f"):
            check_poses(f"{name} of {self.title}", self.time_s, getattr(self, name), at_least=2)
        if not self.phases:
            raise InputError(f"figure: {self.title}: a plan has one phase at least, got none")

    def during(self, phase: PhaseSpan) -> slice:
        """Samples of a phase without its last moment, from which on forces are those of the next."""
        start, stop = np.searchsorted(self.time_s, np.array([phase.start_s, phase.stop_s]) - ROUNDING_S)
        return slice(int(start), int(stop))

    def path(self, phase: PhaseSpan) -> slice:
        """Samples of a phase and the one after, at which poses join those of the next."""
        part = self.during(phase)
        return slice(part.start, part.stop + 1)


def draw_plan(data: PlanPicture) -> Figure:
    """Draw a plan on one sheet, the panels (a) to (c), and (d) where its robustness is known."""
    with style.applied():
        figure = Figure(figsize=(12.4, 6.8))
        figure.suptitle(data.title, fontsize=11.0, y=0.985)
        grid = figure.add_gridspec(1, 3, width_ratios=(1.1, 1.05, 0.95), left=0.06, right=0.985, top=0.9, bottom=0.13)
        grid.update(wspace=0.25)
        _draw_plane(figure.add_subplot(grid[0]), data)
        rows = grid[1].subgridspec(4, 1, hspace=0.16)
        _draw_time([figure.add_subplot(rows[index]) for index in range(4)], data)
        right = grid[2].subgridspec(2, 1, hspace=0.3) if data.robustness is not None else [grid[2]]
        _draw_friction(figure, right[0], data)
        if data.robustness is not None:
            _draw_robustness(figure.add_subplot(right[1]), data.robustness)
        _add_legend(figure)
    return figure


def _draw_plane(axes: Any, data: PlanPicture) -> None:
    axes.set_title("(a) hand and block in the plane {w}")
    moments = [data.phases[0].start_s, *(phase.stop_s for phase in data.phases)]
    finger_m = 0.4 * float(max(data.block_size_m))
    for number, moment in enumerate(moments):
        index = int(np.argmin(np.abs(data.time_s - moment)))
        draw_block(axes, data.q_o[index], data.block_size_m, alpha=0.75, zorder=1)
        draw_finger(axes, data.q_f[index], finger_m, zorder=6)
        look = LABELS[number % len(LABELS)]
        axes.annotate(f"{moment:.2f} s", data.q_f[index, :2], textcoords="offset points", zorder=9, fontsize=8, **look)
    for phase in data.phases:
        part = data.path(phase)
        axes.plot(data.q_o[part, 0], data.q_o[part, 1], **style.PHASES[phase.kind], zorder=4)
        axes.plot(data.q_f[part, 0], data.q_f[part, 1], color="#b3261e", linewidth=0.7, zorder=5)
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.08)
    axes.set_xlabel("$x$ (m)")
    axes.set_ylabel("$y$ (m)")


def _draw_time(panels: list[Any], data: PlanPicture) -> None:
    panels[0].set_title("(b) relative pose and accelerations")
    moved = near(data.r_f_b, data.r_f_b) - near(data.r_f_b, data.r_f_b)[0]
    _lines(panels[0], data.time_s, 1e3 * moved[:, :2], ("$x$", "$y$"), "$Δr_f^b$ (mm)")
    _lines(panels[1], data.time_s, np.degrees(moved[:, 2:]), ("$θ$",), "$Δr_f^b$ (°)")
    names = ("hand $x$", "hand $y$", "block $x$", "block $y$")
    linear = np.column_stack([data.ddq_f[:, :2], data.ddq_o[:, :2]])
    _lines(panels[2], data.time_s, linear, names, "acc. (m/s²)")
    turning = np.column_stack([data.ddq_f[:, 2], data.ddq_o[:, 2]])
    _lines(panels[3], data.time_s, turning, ("hand $θ$", "block $θ$"), "acc. (rad/s²)")
    for axes in panels:
        for phase in data.phases:
            if phase.kind == "slide":
                axes.axvspan(phase.start_s, phase.stop_s, **style.SLIDING)
        axes.set_xlim(data.time_s[0], data.time_s[-1])
        _widen(axes)
        axes.tick_params(labelbottom=axes is panels[-1])
    panels[-1].set_xlabel("time (s)")
    panels[0].figure.align_ylabels(panels)


def _widen(axes: Any, least: float = 1.0) -> None:
    """Let a scale span so much at least, so that rounding does not fill it."""
    low, high = axes.get_ylim()
    if high - low < least:
        axes.set_ylim(0.5 * (low + high - least), 0.5 * (low + high + least))


def _lines(axes: Any, time_s: FloatArray, columns: FloatArray, names: tuple[str, ...], label: str) -> None:
    colours = (*style.AXES[:2], "#7fa8d6", "#f0b27a") if len(names) == 4 else style.AXES
    for index, name in enumerate(names):
        dash = style.DASHES[index % 2]
        axes.plot(time_s, columns[:, index], color=colours[index], linestyle=dash, linewidth=1.3, label=name, zorder=3)
    axes.set_ylabel(label)
    axes.legend(loc="best", fontsize=7.0, ncols=2, handlelength=2.0, borderpad=0.1, labelspacing=0.2, columnspacing=1.0)


def _draw_friction(figure: Figure, place: Any, data: PlanPicture) -> None:
    scale = np.array([1.0, 1.0, 1.0 / data.patch_radius_m])
    shape = data.semi_axes * scale
    labels = ("$f_x$", "$f_y$", "$m_z/a$")
    axes = bare_axes(figure, place, labels, shape, size=1.6)
    axes.set_title(f"(c) friction and its limit surface in {{f}}\n$μ f_N$ = {shape[0]:.3g} N", y=1.0)
    draw_ellipsoid(axes, shape)
    for phase in data.phases:
        path, look = data.f_f[data.during(phase)] * scale, style.PHASES[phase.kind]
        axes.plot(*path.T, **{**look, "linewidth": 2.2}, zorder=8)
        axes.plot(*path[:1].T, color=look["color"], linestyle="none", marker="o", markersize=4.0, zorder=9)


def _draw_robustness(axes: Any, told: Robustness) -> None:
    axes.set_title("(d) where it ends if the friction is another")
    axes.axvspan(1.0 - told.eps_low, 1.0 + told.eps_high, **style.SLIDING)
    axes.axvline(1.0, color="black", linewidth=0.7, zorder=2)
    axes.plot(told.mu_ratio, 1e3 * told.error_m, color=style.AXES[0], linewidth=1.5, label="distance (mm)", zorder=3)
    turned = np.degrees(told.error_rad)
    look = {"color": style.AXES[1], "linestyle": style.DASHES[1], "linewidth": 1.5, "zorder": 3}
    axes.plot(told.mu_ratio, turned, label="turn (°)", **look)
    axes.set_xlim(told.mu_ratio[0], told.mu_ratio[-1])
    axes.set_ylim(bottom=min(0.0, 1.05 * float(np.nanmin(turned, initial=0.0))))
    axes.set_xlabel("true over believed friction, $μ/μ_0$")
    axes.set_ylabel("final error (mm, °)")
    survived = f"survived: {1 - told.eps_low:.3g} to {1 + told.eps_high:.3g}"
    axes.legend(loc="upper left", title=survived, title_fontsize=8.0, fontsize=8.0, alignment="left")


def _add_legend(figure: Figure) -> None:
    names = {"stick": "sticking", "slide": "sliding", "settle": "sticking, to rest"}
    handles: list[Any] = [Line2D([], [], label=names[kind], **look) for kind, look in style.PHASES.items()]
    handles.append(Line2D([], [], color="#b3261e", linewidth=0.7, marker="o", markersize=4, label="finger"))
    figure.legend(handles=handles, loc="lower center", ncols=4, handlelength=3.5, bbox_to_anchor=(0.5, 0.005))
