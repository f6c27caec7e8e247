"""Two runs beside each other."""

from collections.abc import Iterable

from rich.console import RenderableType
from rich.table import Table

from slidepipe.artifacts.difference import Change, Difference, ResultPair
from slidepipe.artifacts.manifest import Result
from slidepipe.artifacts.run import Run
from slidepipe.cli.views.tables import BARE, NONE, columns, facts, number


def difference_view(before: Run, after: Run, found: Difference) -> list[RenderableType]:
    """What was asked, the code and what came out, where they differ; results always."""
    parts: list[RenderableType] = [facts([("before", _name(before)), ("after", _name(after))])]
    if found.same_recipe:
        parts += ["", "the same recipe: equal stage, parameters, inputs and seed"]
    if found.task:
        parts += ["", _changes("asked", found.task)]
    if found.code:
        parts += ["", _changes("code", found.code)]
    if found.results:
        parts += ["", _results(found.results)]
    return parts


def result_line(pair: ResultPair) -> dict[str, object]:
    """One result as JSON holds it."""
    old, new = pair.before, pair.after
    return {
        "name": pair.name,
        "unit": pair.unit,
        "before": None if old is None else {"value": old.value, "std": old.std},
        "after": None if new is None else {"value": new.value, "std": new.std},
        "change": pair.change,
    }


def _name(run: Run) -> str:
    return f"{run.id}  {run.manifest.stage} {run.manifest.experiment}"


def _changes(title: str, changes: Iterable[Change]) -> Table:
    table = columns(title, "before", "after")
    for column in table.columns:
        column.no_wrap, column.overflow = False, "fold"
    for one in changes:
        table.add_row(one.name, _value(one.before), _value(one.after))
    return table


def _results(results: Iterable[ResultPair]) -> Table:
    names = ("before", "after", "change")
    table = columns("result", *names, "unit", numbers=names)
    for one in results:
        unit = "" if one.unit in BARE else one.unit
        table.add_row(one.name, _result(one.before), _result(one.after), _change(one.change), unit)
    return table


def _result(one: Result | None) -> str:
    if one is None:
        return NONE
    return number(one.value) if one.std is None else f"{number(one.value)} ± {one.std:.2g}"


def _change(value: float | None) -> str:
    return NONE if value is None else f"{value:+.4g}"


def _value(value: object) -> str:
    if value is None:
        return NONE
    return str(value).lower() if isinstance(value, bool) else str(value)
