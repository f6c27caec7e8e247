"""How fast trials converge, for each way to iterate, beside what a single shot leaves."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from slidepipe.errors import InputError
from slidepipe.figures import style
from slidepipe.series import FloatArray

LOOKS: tuple[dict[str, Any], ...] = (
    {"color": "#8b949e", "marker": "s", "linestyle": (0, (1, 1.4))},
    {"color": "#1f5fa8", "marker": "o", "linestyle": "-"},
    {"color": "#d9730d", "marker": "D", "linestyle": (0, (6, 1.6))},
)


@dataclass(frozen=True, slots=True)
class Converging:
    """One way to iterate: its name, and the share of worlds within tolerance after each trial, (N,)."""

    name: str
    shares: FloatArray


@dataclass(frozen=True, slots=True)
class SingleShots:
    """Errors (K, 3) of first trials that held the object, m and rad, out of so many worlds, and what is allowed."""

    errors: FloatArray
    worlds: int
    position_tolerance_m: float
    angle_tolerance_rad: float


def draw_iteration(ways: Sequence[Converging], shots: SingleShots, path: Path) -> None:
    """Draw the shares over the trials, and two clouds of what one open-loop shot leaves.

    Raises
    ------
    InputError
        There is no way to draw, or more than there are looks for.
    """
    if not 1 <= len(ways) <= len(LOOKS):
        raise InputError(f"iteration figure: it takes 1 to {len(LOOKS)} ways, got {len(ways)}")
    with mpl.rc_context(dict(style.SETTINGS)):
        figure = Figure(figsize=(2.2 * style.PANEL_WIDTH_IN, 2.0 * style.ROW_HEIGHT_IN), layout="constrained")
        shares, place, turn = figure.subplots(1, 3, width_ratios=(1.25, 1.0, 0.8))
        _draw_shares(shares, ways, shots.worlds)
        _draw_place(place, shots)
        _draw_turn(turn, shots)
        handles, names = shares.get_legend_handles_labels()
        figure.legend(handles, names, loc="outside lower left", ncols=len(ways))
        figure.savefig(path)


def _draw_shares(axes: Any, ways: Sequence[Converging], worlds: int) -> None:
    for way, look in zip(ways, LOOKS, strict=False):
        trials = np.arange(1, len(way.shares) + 1)
        axes.plot(trials, 100.0 * way.shares, linewidth=1.6, markersize=5, label=way.name, clip_on=False, **look)
    axes.set(xlabel="trials", ylabel=f"within tolerance (% of {worlds} worlds)", ylim=(0.0, 100.0))
    axes.set_xticks(np.arange(1, max(len(way.shares) for way in ways) + 1))
    axes.set_title("converged")


def _draw_place(axes: Any, shots: SingleShots) -> None:
    x, y = 1e3 * shots.errors[:, 0], 1e3 * shots.errors[:, 1]
    axes.plot(x, y, **_dots())
    around = np.linspace(0.0, 2.0 * np.pi, 100)
    radius = 1e3 * shots.position_tolerance_m
    axes.fill(radius * np.cos(around), radius * np.sin(around), **style.BAND)
    axes.plot(radius * np.cos(around), radius * np.sin(around), **style.GOAL)
    axes.set(xlabel="error along $x$ (mm)", ylabel="error along $y$ (mm)")
    axes.set_aspect("equal", adjustable="datalim")
    lost = shots.worlds - len(shots.errors)
    axes.set_title(f"after one shot ({lost} lost)")


def _draw_turn(axes: Any, shots: SingleShots) -> None:
    axes.plot(1e3 * np.hypot(shots.errors[:, 0], shots.errors[:, 1]), 1e3 * shots.errors[:, 2], **_dots())
    allowed = 1e3 * shots.angle_tolerance_rad
    axes.axhspan(-allowed, allowed, **style.BAND)
    axes.set(xlabel="distance (mm)", ylabel="error of $θ$ (mrad)")
    axes.set_xlim(left=0.0)
    axes.margins(x=0.05)
    axes.set_title("and its turning")


def _dots() -> dict[str, Any]:
    return {"color": style.MEASURED["color"], "linestyle": "none", "marker": "o", "markersize": 3.2, "alpha": 0.7}
