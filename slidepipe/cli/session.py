"""What every verb is given: where the store is, and what was typed."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from slidepipe.cli import render

if TYPE_CHECKING:
    from rich.console import RenderableType

    from slidepipe.artifacts.annotations import Annotation
    from slidepipe.artifacts.query import Page, Query
    from slidepipe.artifacts.run import Run
    from slidepipe.artifacts.schema import Artifact
    from slidepipe.artifacts.store import Store


@dataclass(frozen=True, slots=True)
class Session:
    """One call of the command line.

    Attributes
    ----------
    data : Path
        Directory of the run store.
    command : tuple of str
        The command as it was typed.
    """

    data: Path
    command: tuple[str, ...]

    def store(self) -> "Store":
        """Open the run store."""
        from slidepipe.artifacts.store import Store  # noqa: PLC0415  # help must not wait for it

        return Store(self.data, render.note)

    def find(self, query: "Query") -> "Page":
        """Find runs by the index alone, which is there at once."""
        from slidepipe.artifacts.index import Index  # noqa: PLC0415
        from slidepipe.artifacts.layout import check_layout  # noqa: PLC0415

        check_layout(self.data)
        return Index(self.data).find(query)


@dataclass(frozen=True, slots=True)
class Report:
    """What a verb tells in the end, for a person or for a program.

    Attributes
    ----------
    schema : str
        Of the JSON object: ``slidepipe.plan_result/1`` say.
    run : Run, optional
        The run that was published, or that was found to be equal.
    content : Mapping
        What the JSON object holds beside the run.
    """

    schema: str
    run: "Run | None"
    content: Mapping[str, object]

    def put(self, view: "list[RenderableType]", *, as_json: bool) -> None:
        """Print it: as one JSON object, or as a person reads it."""
        if as_json:
            where = (self.run.id, str(self.run.directory)) if self.run else (None, None)
            render.put_json(self.schema, {"run": where[0], "directory": where[1], **self.content})
        else:
            render.put(view)


def plain(document: "Artifact | None") -> dict[str, object] | None:
    """Document as JSON holds it, its schema first."""
    if document is None:
        return None
    return {"schema": f"{document.SCHEMA}/{document.VERSION}", **document.model_dump(mode="json")}


def note_line(note: "Annotation") -> dict[str, object]:
    """Note on a run as JSON holds it."""
    return asdict(note)


def note_reuse(session: Session, run: "Run", *, reused: bool) -> None:
    """Say why nothing was computed, or why something was although the like of it was there."""
    from slidepipe.artifacts.reuse import equal_before, what_changed  # noqa: PLC0415

    if reused:
        render.note(f"reused run {run.id}: same inputs, parameters and code of the stage (--force computes it anew)")
        return
    store = session.store()
    equal = equal_before(store, run)
    if equal is not None:
        render.note(f"computed anew (--force), though run {equal} has the same parameters, inputs and code")
        return
    changed = what_changed(store, run)
    if changed is not None:
        render.note(f"computed, {changed}")
