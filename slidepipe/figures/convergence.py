"""How trials of one goal come nearer to it, and what each told of the friction."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from slidepipe.figures import style
from slidepipe.figures.paper import new_figure
from slidepipe.series import FloatArray

MARKS = ("o", "s", "^", "D", "v", "P")


@dataclass(frozen=True, slots=True)
class Chain:
    """Trials that follow from one another.

    Attributes
    ----------
    name : str
    trial : (K,)
        Their numbers.
    error_m, error_rad : (K,)
        Distance from the goal and turn away from it; NaN where the object was lost.
    mu, mu_low, mu_high : (K,)
        Estimated friction and its 95 % interval; NaN where there is none.
    believed : (K,)
        Friction that the trial was planned with.
    """

    name: str
    trial: FloatArray
    error_m: FloatArray
    error_rad: FloatArray
    mu: FloatArray
    mu_low: FloatArray
    mu_high: FloatArray
    believed: FloatArray


def draw_convergence(chains: Sequence[Chain], tolerance: tuple[float, float], true_mu: float | None) -> Figure:
    """Draw distance, turn and friction over the trials; ``tolerance`` is of the distance in m and the turn in rad."""
    with style.applied():
        figure = new_figure(8.6, 3.0)
        distance, turn, friction = figure.subplots(1, 3)
        for index, chain in enumerate(chains):
            look = {
                "color": style.AXES[index % 3],
                "marker": MARKS[index % len(MARKS)],
                "markersize": 5,
                "linewidth": 1.2,
            }
            if len(set(chain.trial)) < len(chain.trial):  # repeats of one plan: there is no way from one to the next
                look["linestyle"] = "none"
            distance.plot(chain.trial, 1e3 * chain.error_m, **look, label=chain.name)
            turn.plot(chain.trial, 1e3 * np.abs(chain.error_rad), **look)
            _draw_friction(friction, chain, look)
        for axes, limit, label in ((distance, tolerance[0], "error (mm)"), (turn, tolerance[1], "turn (mrad)")):
            axes.axhspan(0.0, 1e3 * limit, **style.BAND)
            axes.set_ylim(bottom=0.0)
            axes.set_ylabel(label)
        if true_mu is not None:
            friction.axhline(true_mu, **{**style.TRUE, "zorder": 2})
        friction.set_ylabel("friction $μ$")
        for axes in (distance, turn, friction):
            axes.set_xlabel("trial")
            axes.xaxis.set_major_locator(MaxNLocator(integer=True, min_n_ticks=1))
            axes.margins(x=0.12)
    return figure


def _draw_friction(axes: Any, chain: Chain, look: dict[str, Any]) -> None:
    reach = np.stack([chain.mu - chain.mu_low, chain.mu_high - chain.mu])
    axes.errorbar(chain.trial, chain.mu, yerr=reach, capsize=3.0, zorder=4, **{**look, "linestyle": "none"})
    axes.plot(chain.trial, chain.believed, **{**style.WANTED, "linewidth": 0.9, "drawstyle": "steps-mid"})
