"""Judge the estimators on recordings that this project did not make; with ``--page FILE`` write it down as Markdown."""

import argparse
import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from support.public_data import (
    FOLDER,
    PUBLISHED_MU,
    PULL_N,
    PUSH_LOGS,
    Sampling,
    Stream,
    push_pairs,
    push_supports,
    read_stream,
    toss_friction,
)

from slidepipe.errors import EstimationError
from slidepipe.estimation.surface_fit import SurfaceFit, fit_surface

STREAMS = (*(f"pos{number}" for number in range(1, 10)), "pos_s")
LARGEST_OFF = 0.10
"""How far from the pulling force the friction of the pushes may be."""

HEAD = """\
# Recordings that this project did not make

`make real-data` writes this page: `benchmarks/real_data.py` reads the recordings and lets the estimators loose on them.
They are public, and no part of the repository.
"""

PUSHES = """\
## Pushes with a force sensor

50 pushes of a 1.518 kg block on hardboard in each log (CMU), on three known points or on its whole face. The authors
pulled the block with {pull:g} N. Wrench and displacement go into `fit_surface` of `slidepipe.estimation.surface_fit`,
which `slidepipe surface` calls, with the known shares of the load; the face is cut into 144 cells of equal pressure.
The force of a push is the mean of the samples after its first 30 % that exceed their own mean, since a finger that is
settling or losing the block tells little of friction. This choice adds about 5 %: the last column is without it.

{table}

How far the direction of sliding that belongs to a measured wrench is from the one that was seen (turning counts by the
surface's own arm; the median, and what nine of ten pushes are below):

{directions}

On three points the exact surface tells the direction better than the paper's ellipsoid, the more so the nearer to each
other the points are: its flat pieces and sharp bends are what the ellipsoid smooths over. On the whole face the
ellipsoid, which is free to choose its arm, does better than even pressure, and chooses a longer one, as if the block
bore more on its rim.
"""

TOSSES = """\
## Tossed cubes

{slides} of 200 tosses of a 0.37 kg cube (ContactNets) end in a flat slide of at least 12 frames without much turning.
The bend of the path of each gives a coefficient of friction:

| | mu |
| --- | --- |
| median of the slides | {median:.3f} |
| 5 to 95 % of the slides | {low:.3f} to {high:.3f} |
| pooled over the slides, 95 % interval | {pooled_low:.3f} to {pooled_high:.3f} |
| noise within a slide | {within:.4f} |
| spread between slides | {between:.3f} |
| published: the authors' parameter file | {parameter:g} |
| published: deceleration of the flat slides, median | {deceleration:g} |

The median is {above_parameter:.0f} % above the authors' parameter, which {outside} what nine of ten slides give, and
{above_deceleration:+.1f} % from the published deceleration, within the spread of the slides. Which of the two is right
the recordings cannot tell: that would take a third measurement, by another method. The slides differ by several times
their own noise, so that no single mu is the whole truth of this table.
"""

TRACKS = """\
## Motion capture with faults

Streams of a pushed block at 60 Hz (CMU). A frame is believed if its quaternion is one, the block stands on the table,
and it is no farther from the last believed pose than it can have gone: the cameras lose the block, and now and then
mistake one marker for another and turn it by 90, 120 or 180 degrees. What is left is smoothed as a trial is. A step is
from one frame to the next.

{table}
"""


def main() -> None:
    """Print the tables; write the page and the JSON where they are asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--page", type=Path, metavar="FILE", help="write the page as Markdown")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the figures as one flat object")
    asked = parser.parse_args()
    if not FOLDER.is_dir():
        print(f"real_data: the recordings are not there ({FOLDER.name} beside the checkout): nothing measured")
        return
    figures: dict[str, float] = {}
    parts = [HEAD, _pushes(figures), _tosses(figures), _streams(figures)]
    page = "\n".join(parts)
    print(page)
    if asked.page:
        asked.page.write_text(page, encoding="utf-8")
    if asked.json:
        asked.json.write_text(json.dumps(figures, indent=2) + "\n", encoding="utf-8")


def _pushes(figures: dict[str, float]) -> str:
    fits = {log: fit_surface(push_pairs(log), push_supports(log)) for log in PUSH_LOGS}
    rows, directions = [], []
    for log, fit in fits.items():
        everything = fit_surface(push_pairs(log, Sampling(larger_only=False)), push_supports(log))
        off = fit.friction_n / PULL_N - 1.0
        verdict = "yes" if abs(off) <= LARGEST_OFF else "no"
        rows.append(
            (log, f"{fit.friction_n:.2f} ± {fit.friction_std_n:.2f}", f"{100 * off:+.1f} %", verdict,
             f"{fit.rms_force_n:.2f}", f"{everything.friction_n:.2f}")
        )  # fmt: skip
        directions.append((log, *_angles(fit)))
        figures[f"friction_{log}_n"] = fit.friction_n
        figures[f"direction_exact_{log}_deg"] = float(np.degrees(fit.exact_error.median))
        figures[f"direction_ellipsoid_{log}_deg"] = float(np.degrees(fit.ellipsoid_error.median))
    head = ("log", "mu m g (N)", f"from {PULL_N:g} N", "within 10 %", "left of the force (N)", "all samples (N)")
    names = ("log", "surface of the contacts", "ellipsoid", "one beside the other", "arm: surface, ellipsoid (mm)")
    return PUSHES.format(pull=PULL_N, table=_table(head, rows), directions=_table(names, directions))


def _angles(fit: SurfaceFit) -> Iterator[str]:
    for error in (fit.exact_error, fit.ellipsoid_error, fit.models_apart):
        yield f"{np.degrees(error.median):.1f}°, {np.degrees(error.ninth_decile):.1f}°"
    yield f"{1e3 * fit.arm_m:.1f}, {1e3 * fit.ellipsoid.a:.1f}"


def _tosses(figures: dict[str, float]) -> str:
    found = toss_friction()
    median = float(np.median(found.mu))
    low, high = np.percentile(found.mu, [5.0, 95.0])
    figures |= {"toss_mu_median": median, "toss_mu_low": float(low), "toss_mu_high": float(high)}
    parameter, deceleration = PUBLISHED_MU
    return TOSSES.format(
        slides=len(found.mu), median=median, low=low, high=high,
        pooled_low=found.pooled.interval_95[0], pooled_high=found.pooled.interval_95[1],
        within=found.pooled.within_std, between=found.pooled.between_std,
        parameter=parameter, deceleration=deceleration,
        above_parameter=100.0 * (median / parameter - 1.0), above_deceleration=100.0 * (median / deceleration - 1.0),
        outside="lies below" if parameter < low else "lies within",
    )  # fmt: skip


def _streams(figures: dict[str, float]) -> str:
    rows = [_stream(name, figures) for name in STREAMS]
    head = (
        "stream",
        "frames",
        "not believed",
        "longest step as sent (mm, °)",
        "longest step smoothed (mm, °)",
        "and beside a loss (mm)",
    )
    return TRACKS.format(table=_table(head, rows))


def _stream(name: str, figures: dict[str, float]) -> tuple[str, ...]:
    try:
        stream: Stream = read_stream(name)
    except EstimationError as refusal:
        return name, "", "", "", "", f"refused: {str(refusal).partition(': ')[2]}"
    figures[f"smoothed_step_{name}_m"] = stream.smoothed_jump_m
    return (
        name,
        str(len(stream.time_s)),
        str(stream.lost),
        f"{1e3 * stream.raw_jump_m:.2f}, {np.degrees(stream.raw_jump_rad):.1f}",
        f"{1e3 * stream.smoothed_jump_m:.2f}, {np.degrees(stream.smoothed_jump_rad):.1f}",
        f"{1e3 * stream.loss_jump_m:.2f}" if stream.lost else "",
    )


def _table(head: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    return "\n".join("| " + " | ".join(row) + " |" for row in (head, ("---",) * len(head), *rows))


if __name__ == "__main__":
    main()
