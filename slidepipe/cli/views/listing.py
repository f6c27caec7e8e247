"""Runs as a person reads them in a list, a line each. Loads nothing that computes or validates."""

from collections.abc import Iterable, Sequence
from pathlib import Path

from rich.console import RenderableType

from slidepipe.artifacts.entry import Entry
from slidepipe.artifacts.query import Query
from slidepipe.artifacts.wording import instead
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


def nothing_found(query: Query, there: Sequence[Entry], data: Path) -> str:
    """Say that no run is as asked for, and of each filter that no run passes what there is instead."""
    filters = {
        "experiment": query.experiment,
        "stage": query.stage,
        "state": ", ".join(query.states) or None,
        "since": query.since and _minute(query.since),
        "until": query.until and _minute(query.until),
    }
    given = {name: value for name, value in filters.items() if value is not None}
    if not there or not given:
        return f"no runs in {data}"
    asked = " ".join(f"--{name} {value}" for name, value in given.items())
    hints = [_hint(name, value, there) for name, value in given.items()]
    return "; ".join([f"no runs with {asked} among the {len(there)} in {data}", *(hint for hint in hints if hint)])


def _hint(name: str, value: str, there: Sequence[Entry]) -> str:
    first, last = _minute(there[0].finished), _minute(there[-1].finished)
    if name in {"since", "until"}:
        return "" if first <= value <= last else f"the first ended {first}, the last {last}"
    names = sorted({getattr(entry, name) for entry in there})
    return "" if set(value.split(", ")) & set(names) else f"of {name}s {instead(value, names)}"


def _minute(time: str) -> str:
    return f"{time[:16]}Z"


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
