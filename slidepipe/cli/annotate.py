"""``slidepipe annotate``."""

# ruff: noqa: PLC0415  # what computes is imported when it is called, so that help is there at once

import click

from slidepipe.cli import options, render
from slidepipe.cli.session import Session, note_line


@options.verb(
    "annotate",
    "Note something on a run: a verdict, a text, or both.\n\n"
    "Without either the notes are shown. "
    "Notes are only ever added, beside the runs, which never change. gc keeps a run that has a note.",
    example="slidepipe annotate @latest:execute --verdict good",
    exits={},
)
@options.run_argument("run")
@click.argument("note", default="", metavar="[NOTE]")
@click.option("--verdict", metavar="WORD", help="A word to sort by: good, bad, outlier ...")
@click.option("--author", metavar="NAME", help="Who says so.  [default: the user's name on this machine]")
@options.as_json
@click.pass_obj
def command(session: Session, *, run: str, note: str, verdict: str | None, author: str | None, as_json: bool) -> None:
    """Add a note."""
    from slidepipe.artifacts.annotations import annotation_of

    store = session.store()
    found = store.get(run)
    if note or verdict:
        store.annotations.add(annotation_of(found.id, author=author, verdict=verdict, note=note))
    notes = store.annotations.of(found.id)
    if as_json:
        render.put_json("slidepipe.annotations/1", {"run": found.id, "annotations": [note_line(one) for one in notes]})
        return
    for one in notes:
        render.put([" ".join(filter(None, (one.time, one.author, one.verdict, one.note)))])
    if not notes:
        render.note(f"run {found.id} has no notes")
