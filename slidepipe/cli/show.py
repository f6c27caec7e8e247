"""``slidepipe show``."""

# ruff: noqa: PLC0415  # what computes is imported when it is called, so that help is there at once

import click

from slidepipe.cli import options
from slidepipe.cli.session import Report, Session, note_line, plain


@options.verb(
    "show",
    "Show one run: what went in, what came out, by which code, and what its stage has to say.",
    example="slidepipe show @latest:estimate",
    exits={},
)
@options.run_argument("run")
@options.all_limits
@options.as_json
@click.pass_obj
def command(session: Session, *, run: str, all_limits: bool, as_json: bool) -> None:
    """Show a run."""
    from slidepipe.cli.views.runs import manifest_view
    from slidepipe.cli.views.stored import read_documents, stage_view

    store = session.store()
    found = store.get(run)
    documents = read_documents(found)
    notes = store.annotations.of(found.id)
    content = {
        "manifest": plain(found.manifest),
        "documents": {name: plain(document) for name, document in documents.items()},
        "annotations": [note_line(one) for one in notes],
    }
    view = [*manifest_view(found, notes), *stage_view(documents, found, all_limits=all_limits)]
    Report("slidepipe.run_view/1", found, content).put(view, as_json=as_json)
