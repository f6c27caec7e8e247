"""Many worlds of one experiment: what was drawn for each, what came of it, and what they come to together."""

import csv
import hashlib
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from slidepipe.artifacts.campaign import CampaignOutcome
from slidepipe.artifacts.schema import Artifact, Record
from slidepipe.artifacts.values import Count, NotNegative, Planar, Pose, Slug

WorldKind = Literal["mechanics", "lab"]
"""The project's own exact simulation with a perfect hand, first motion alone; or the simulated lab, whole loop."""
Share = Annotated[float, Field(ge=0.0, le=1.0)]


class SweepTry(Record):
    """One trial in one world: error of the true final relative pose from the goal; null where the object was lost.

    ``said_worse`` is whether the trial was told to have left more than there was before it.
    """

    error: Pose | None
    said_worse: bool = False


class SweepTrialDocument(Artifact):
    """What is written as ``sweep_trial.yaml``: one world. ``overrides`` over the experiment make it again.

    ``setting`` is the number of the combination of lists that it belongs to, ``why_ended`` what ended it early.
    """

    SCHEMA: ClassVar[str] = "slidepipe.sweep_trial"

    experiment: Slug
    index: Count
    setting: Count
    world: WorldKind
    overrides: tuple[str, ...]
    outcome: CampaignOutcome
    why_ended: str | None
    trials: tuple[SweepTry, ...]


class Spread(Record):
    """Mean and standard deviation of the error along x, y (m) and theta (rad), over the worlds that held the object."""

    worlds: Count
    mean: Planar
    std: Planar


class SweepSetting(Record):
    """One combination of the lists: how many worlds, how they ended, and the error after the first and last trial."""

    overrides: tuple[str, ...]
    worlds: Count
    lost_share: Share
    converged_share: Share
    first_trial: Spread | None
    last_trial: Spread | None


class SweepDocument(Artifact):
    """What is written as ``sweep.yaml``; ``numbers_sha256`` is of every number of every world, in order."""

    SCHEMA: ClassVar[str] = "slidepipe.sweep"

    experiment: Slug
    world: WorldKind
    sets: tuple[str, ...]
    seed: Count
    worlds: Count
    reused: Count
    workers: str
    seconds: NotNegative
    settings: tuple[SweepSetting, ...]
    numbers_sha256: str
    table_file: str


def numbers_of(trials: Iterable[SweepTrialDocument]) -> list[list[str]]:
    """Table of every world, exact to the last bit: index, setting, outcome, then x, y, theta after each trial."""
    rows = []
    for one in trials:
        row = [str(one.index), str(one.setting), one.outcome]
        for tried in one.trials:
            row += ["lost"] * 3 if tried.error is None else [repr(value) for value in tried.error.vector]
        rows.append(row)
    return rows


def write_table(rows: list[list[str]], path: Path) -> None:
    """Write the table as CSV."""
    longest = max((len(row) for row in rows), default=3)
    names = [f"{name}_{trial}" for trial in range(1, (longest - 3) // 3 + 1) for name in ("x_m", "y_m", "theta_rad")]
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["index", "setting", "outcome", *names])
        writer.writerows(rows)


def sha256_of_rows(rows: list[list[str]]) -> str:
    """Hash of a table."""
    return hashlib.sha256("\n".join(",".join(row) for row in rows).encode()).hexdigest()
