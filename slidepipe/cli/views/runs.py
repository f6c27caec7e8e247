"""A run as a person reads it: its manifest in full."""

from collections.abc import Iterable, Sequence

from rich.console import RenderableType
from rich.table import Table

from slidepipe.artifacts.annotations import Annotation
from slidepipe.artifacts.manifest import Manifest, Result
from slidepipe.artifacts.run import Run
from slidepipe.cli.views.tables import BARE, NONE, columns, facts, heading, number, size

HASH = 16
"""Digits of a hash that are shown; the manifest and ``--json`` have them all."""


def manifest_view(run: Run, notes: Sequence[Annotation] = ()) -> list[RenderableType]:
    """What was done, when, by which code, from what, and what came out."""
    told = run.manifest
    parts: list[RenderableType] = [
        heading(f"run {run.id}"),
        facts([*_facts(run), *(("note", _note(one)) for one in notes)]),
    ]
    if told.inputs:
        parts += ["", _inputs(told)]
    if told.outputs:
        parts += ["", _outputs(told)]
    if told.results:
        parts += ["", _results(told.results)]
    return parts


def _facts(run: Run) -> list[tuple[str, str]]:
    told = run.manifest
    rows = [
        ("stage", f"{told.stage} (version {told.stage_version})"),
        ("experiment", told.experiment),
        ("state", told.state.value),
        ("started", told.times.started),
        ("finished", told.times.finished),
        ("seed", NONE if told.seed is None else str(told.seed)),
        ("code", _code(told)),
        ("recipe", told.recipe[:HASH]),
        ("command", " ".join(told.command) or NONE),
        ("directory", str(run.directory)),
    ]
    if told.error is not None:
        rows.insert(3, ("error", f"{told.error.type}: {told.error.message}"))
    return rows


def _note(one: Annotation) -> str:
    return " ".join(filter(None, (one.time, one.author, one.verdict, one.note)))


def _code(told: Manifest) -> str:
    commit = "no commit known" if told.code.commit is None else f"commit {told.code.commit[:12]}"
    state = {True: ", changed since", False: "", None: ", changed or not: not known"}[told.code.dirty]
    return f"slidepipe {told.code.version}, {commit}{state}"


def _inputs(told: Manifest) -> Table:
    table = columns("input", "from", "size", "sha256", numbers=["size"])
    table.columns[1].no_wrap, table.columns[1].overflow = False, "fold"
    for one in told.inputs:
        origin = one.file if one.run is None else f"{one.run}/{one.file}"
        table.add_row(one.role, origin, size(one.size), one.sha256[:HASH])
    return table


def _outputs(told: Manifest) -> Table:
    table = columns("output", "file", "size", "sha256", numbers=["size"])
    table.columns[1].no_wrap, table.columns[1].overflow = False, "fold"
    for one in told.outputs:
        table.add_row(one.role, one.file, size(one.size), one.sha256[:HASH])
    return table


def _results(results: Iterable[Result]) -> Table:
    numbers = ("value", "std")
    table = columns("result", *numbers, "unit", numbers=numbers)
    for one in results:
        table.add_row(one.name, number(one.value), number(one.std), "" if one.unit in BARE else one.unit)
    return table
