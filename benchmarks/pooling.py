"""Do intervals over few trials hold: ours, and those of DerSimonian and Laird and of Hartung and Knapp beside them."""

import argparse
import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.stats import t as student_t

from slidepipe.estimation.pooled import pool
from slidepipe.series import FloatArray

TRIALS, SPREADS, NOISE = (2, 3, 5, 10), (0.0, 0.01, 0.03, 0.05, 0.1), 0.004
"""Trials of an experiment, true spread between them, and noise of one estimate, as shares of the value."""
NOMINAL = 0.95


@dataclass(frozen=True, slots=True)
class Held:
    """Shares of intervals that held the truth, and the median width of ours over that of Hartung and Knapp."""

    ours: float
    predictive: float
    dersimonian_laird: float
    hartung_knapp: float
    width: float
    flagged: float


def main() -> None:
    """Print the table; write the JSON where it is asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the figures as one flat object")
    parser.add_argument("--experiments", type=int, default=300, help="for each line of the table")
    asked = parser.parse_args()
    print(f"share of nominal {NOMINAL:.0%} intervals that hold the truth, noise of one estimate {NOISE:.1%}")
    print("trials  spread    ours  next trial  DerSimonian-Laird  Hartung-Knapp  ours / H-K wide  any flagged")
    figures: dict[str, float] = {}
    for count in TRIALS:
        for spread in SPREADS:
            held = measure(count, spread, asked.experiments)
            print(
                f"{count:6d}  {spread:6.1%}  {held.ours:6.3f}  {held.predictive:10.3f}  {held.dersimonian_laird:17.3f}"
                f"  {held.hartung_knapp:13.3f}  {held.width:15.2f}  {held.flagged:11.3f}"
            )
            figures[f"coverage_pooled_{count}_{round(1000 * spread)}"] = held.ours
    if asked.json:
        asked.json.write_text(json.dumps(figures, indent=2) + "\n", encoding="utf-8")


def measure(count: int, spread: float, experiments: int) -> Held:
    """Draw experiments and count which intervals hold."""
    random = np.random.default_rng([count, round(1000 * spread)])
    rows = np.array([_experiment(random, count, spread) for _ in range(experiments)])
    shares = rows.mean(axis=0)
    return Held(*(float(one) for one in shares[:4]), float(np.median(rows[:, 4])), float(shares[5]))


def _experiment(random: np.random.Generator, count: int, spread: float) -> list[float]:
    noise = NOISE * random.uniform(0.7, 1.4, count)
    y = spread * random.normal(size=count) + noise * random.normal(size=count)
    told, following = pool(np.exp(y), noise * np.exp(y)), np.exp(spread * random.normal())
    centre, weight = _dersimonian_laird(y, noise)
    error = 1.0 / np.sqrt(weight.sum())
    spread_error = np.sqrt(weight @ (y - centre) ** 2 / (count - 1) / weight.sum())
    reach = float(student_t.ppf(0.5 + NOMINAL / 2.0, count - 1)) * spread_error
    low, high = told.interval_95
    return [
        low < 1.0 < high,
        told.predictive_interval_95[0] < following < told.predictive_interval_95[1],
        abs(centre) < 1.959964 * error,
        abs(centre) < reach,
        np.log(high / low) / (2.0 * reach),
        bool(told.outlying.any()),
    ]


def _dersimonian_laird(y: FloatArray, noise: FloatArray) -> tuple[float, FloatArray]:
    """Mean and weights of the usual moment estimate of the spread."""
    weight = noise**-2
    misfit = weight @ (y - weight @ y / weight.sum()) ** 2
    spare = weight.sum() - (weight**2).sum() / weight.sum()
    weight = 1.0 / (noise**2 + max(0.0, (misfit - len(y) + 1) / spare))
    return float(weight @ y / weight.sum()), weight


if __name__ == "__main__":
    main()
