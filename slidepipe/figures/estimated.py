"""What one estimate rests on: raw and smoothed poses, the slide, what smoothing left, and the posterior of friction."""

import textwrap
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from scipy.stats import lognorm, norm

from slidepipe.errors import InputError
from slidepipe.figures import style
from slidepipe.figures.sheet import pose_rows
from slidepipe.figures.traces import check_poses
from slidepipe.series import FloatArray

POSE = pose_rows(0.002, 0.02)
AXES = (("$x$", "#1f5fa8", "."), ("$y$", "#2e7d32", "x"), ("$θ$", "#d9730d", "+"))
"""Name, colour and mark of each axis's residuals."""
MOST_SIGMAS = 5.0
"""Residuals beyond this are drawn at the edge of their panel."""
MOST_FRAMES = (0.5, 99.5)
"""Percentiles of the frames that a scale shows."""
BINS = 41
AROUND = 4.5
"""Standard deviations of the posterior that are shown to each side."""


@dataclass(frozen=True, slots=True)
class Trace:
    """One thing that moves: T planar poses ``[x, y, theta]``, m and rad.

    Attributes
    ----------
    title : str
    raw : (T, 3)
        As measured; NaN where it was not seen or not believed.
    smoothed : (T, 3)
    noise : (3,)
        Standard deviation of one measurement.
    """

    title: str
    raw: FloatArray
    smoothed: FloatArray
    noise: FloatArray

    @property
    def residual(self) -> FloatArray:
        """(T, 3) raw minus smoothed, in standard deviations of a measurement."""
        return np.asarray((self.raw - self.smoothed) / self.noise)


@dataclass(frozen=True, slots=True)
class Posterior:
    """What is known of kappa after the trial: log-normal, m/s^2; and what was believed before."""

    value: float
    std: float
    interval_95: tuple[float, float]
    believed: float


@dataclass(frozen=True, slots=True)
class EstimatePicture:
    """One estimate.

    Attributes
    ----------
    title : str
    time_s : (T,)
        Of the frames, since the start of the motion.
    traces : tuple of Trace
        Hand and object in {w}, and the finger in {b}.
    slide_s : tuple of float, optional
        When the object began to slide, and when it stopped.
    posterior : Posterior or None
    missing_because : str or None
        Why there is no posterior.
    """

    title: str
    time_s: FloatArray
    traces: tuple[Trace, Trace, Trace]
    slide_s: tuple[float, float] | None
    posterior: Posterior | None
    missing_because: str | None

    def __post_init__(self) -> None:
        for trace in self.traces:
            check_poses(f"raw poses of {trace.title}", self.time_s, trace.raw, at_least=2)
            check_poses(f"smoothed poses of {trace.title}", self.time_s, trace.smoothed, at_least=2)
        if (self.posterior is None) == (self.missing_because is None):
            raise InputError("figure: an estimate needs either a posterior or the reason why there is none")


def draw_estimate(picture: EstimatePicture, path: Path) -> None:
    """Draw hand, object and relative pose over time, their residuals below, and beside them the posterior."""
    with mpl.rc_context(dict(style.SETTINGS)):
        figure = Figure(figsize=(15.0, 8.6), layout="constrained")
        figure.suptitle(picture.title, fontsize=11.0)
        grid = figure.add_gridspec(4, 4, width_ratios=(1.0, 1.0, 1.0, 0.85))
        for column, trace in enumerate(picture.traces):
            panels = [figure.add_subplot(grid[row, column]) for row in range(4)]
            _draw_trace(panels, picture, trace)
            figure.align_ylabels(panels)
        _draw_posterior(figure.add_subplot(grid[:2, 3]), picture)
        _draw_spread(figure.add_subplot(grid[2:, 3]), picture)
        figure.legend(handles=_legend(), loc="outside lower center", ncols=7)
        figure.savefig(path, format="png", metadata={"Software": None})


def _draw_trace(panels: list[Any], picture: EstimatePicture, trace: Trace) -> None:
    """One column: x, y and theta, and their residuals."""
    panels[0].set_title(trace.title)
    for axes in panels[1:]:
        axes.sharex(panels[0])
    for axes in panels:
        if picture.slide_s is not None:
            axes.axvspan(*picture.slide_s, **style.SLIDING)
    for row, axes in enumerate(panels[:3]):
        _draw_pose(axes, picture.time_s, trace, row)
    _draw_residual(panels[3], picture.time_s, trace)


def _draw_pose(axes: Any, time_s: FloatArray, trace: Trace, row: int) -> None:
    look = POSE[row]
    axes.plot(time_s, trace.raw[:, row] * look.factor, **style.RAW)
    axes.plot(time_s, trace.smoothed[:, row] * look.factor, **style.MEASURED)
    seen = trace.raw[np.isfinite(trace.raw[:, row]), row]
    shown = np.concatenate([trace.smoothed[:, row], np.percentile(seen, MOST_FRAMES) if len(seen) else []])
    low, high = float(shown.min()), float(shown.max())
    missing = max(look.least_span - (high - low), 0.0)
    room = 0.08 * (high - low + missing)
    axes.set_ylim((low - missing / 2 - room) * look.factor, (high + missing / 2 + room) * look.factor)
    axes.set_ylabel(look.label)
    axes.tick_params(labelbottom=False)


def _draw_residual(axes: Any, time_s: FloatArray, trace: Trace) -> None:
    residual = np.clip(trace.residual, -MOST_SIGMAS, MOST_SIGMAS)
    for column, (_, colour, mark) in zip(residual.T, AXES, strict=True):
        axes.plot(time_s, column, linestyle="none", marker=mark, color=colour, markersize=2.2, markeredgewidth=0.5)
    for level in (-1.96, 1.96):
        axes.axhline(level, color="black", linewidth=0.6, linestyle=(0, (4, 3)))
    axes.set(ylim=(-MOST_SIGMAS - 0.3, MOST_SIGMAS + 0.3), ylabel="residual (σ)", xlabel="time (s)")


def _draw_posterior(axes: Any, picture: EstimatePicture) -> None:
    told = picture.posterior
    if told is None:
        axes.set_axis_off()
        axes.set_title("friction")
        words = textwrap.fill(f"not estimated: {picture.missing_because}", 38)
        axes.text(0.02, 0.5, words, transform=axes.transAxes, va="center", fontsize=9.0)
        return
    shape = told.std / told.value
    kappa = told.value * np.exp(shape * np.linspace(-AROUND, AROUND, 400))
    density = lognorm.pdf(kappa, shape, scale=told.value)
    inside = (kappa >= told.interval_95[0]) & (kappa <= told.interval_95[1])
    axes.fill_between(kappa[inside], density[inside], color=style.MEASURED["color"], alpha=0.22, linewidth=0.0)
    axes.plot(kappa, density, **style.MEASURED)
    axes.axvline(told.value, color=style.MEASURED["color"], linewidth=0.8)
    low, high = axes.get_xlim()
    if low < told.believed < high:
        axes.axvline(told.believed, **style.WANTED)
    ends, share = told.interval_95, 100.0 * (told.value / told.believed - 1.0)
    axes.set_title(
        f"$κ = μ f_N / m$: {told.value:.4g} ± {told.std:.2g} m/s²\n95 % interval [{ends[0]:#.4g}, {ends[1]:#.4g}]\n"
        f"{share:+.2f} % from the believed {told.believed:.4g}"
    )
    axes.set(xlabel="$κ$ (m/s²)", ylabel="posterior density", ylim=(0.0, None))
    axes.set_yticks([])


def _draw_spread(axes: Any, picture: EstimatePicture) -> None:
    """Residuals of hand and object beside the unit normal that they are smoothed as."""
    axes.set_title("residuals of hand and object")
    edges = np.linspace(-MOST_SIGMAS, MOST_SIGMAS, BINS)
    for column, (name, colour, _) in enumerate(AXES):
        values = np.concatenate([trace.residual[:, column] for trace in picture.traces[:2]])
        values = np.clip(values[np.isfinite(values)], edges[0], edges[-1])
        axes.hist(values, bins=edges, density=True, histtype="step", color=colour, linewidth=1.2, label=name)
    axes.plot(edges, norm.pdf(edges), color="black", linewidth=0.9, linestyle=(0, (4, 3)), label="normal")
    axes.set(xlabel="residual (σ)", ylabel="density")
    axes.set_yticks([])
    axes.legend(loc="upper right")


def _legend() -> list[Any]:
    marks: list[Any] = [
        Line2D([], [], label=f"residual of {name}", color=colour, marker=mark, linestyle="none", markersize=6.0)
        for name, colour, mark in AXES
    ]
    raw = {**style.RAW, "markersize": 6.0}
    return [
        Line2D([], [], label="cameras", **raw),
        Line2D([], [], label="smoothed", **style.MEASURED),
        Patch(label="sliding", **style.SLIDING),
        *marks,
        Line2D([], [], label="believed before", **style.WANTED),
    ]
