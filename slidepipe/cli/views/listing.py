"""Runs as a person reads them in a list, a line each. Loads nothing that computes or validates."""

from collections.abc import Iterable

from rich.console import RenderableType

from slidepipe.artifacts.entry import Entry
from slidepipe.cli.views.tables import NONE, columns, number

RESULTS = 2
"""Results that stand in the list of runs."""


def run_list(entries: Iterable[Entry]) -> list[RenderableType]:
    """Table of runs."""
    table = columns("run", "stage", "experiment", "state", "seed", numbers=["seed"])
    table.columns[2].no_wrap, table.columns[2].overflow = False, "fold"
    table.add_column("results")
    for one in entries:
        seed = NONE if one.seed is None else str(one.seed)
        results = ", ".join(f"{told['name']} {number(told['value'], told['unit'])}" for told in one.results[:RESULTS])
        table.add_row(one.run, one.stage, one.experiment, one.state, seed, results)
    return [table]


def run_line(one: Entry) -> dict[str, object]:
    """One run as the JSON list holds it."""
    return {
        "run": one.run,
        "directory": str(one.directory),
        "stage": one.stage,
        "experiment": one.experiment,
        "state": one.state,
        "started": one.started,
        "finished": one.finished,
        "seed": one.seed,
        "recipe": one.recipe,
        "inputs": list(one.inputs),
        "results": [dict(told) for told in one.results],
    }
