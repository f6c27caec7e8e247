"""``slidepipe log``."""

# ruff: noqa: PLC0415  # what computes is imported when it is called, so that help is there at once

import click

from slidepipe.cli import options, render
from slidepipe.cli.session import Session


@options.verb(
    "log",
    "Show what a run was made from, back to the experiment file.\n\n"
    "Each run was made from the one below it; where from several, each of them is a branch.",
    example="slidepipe log @latest:estimate",
    exits={},
)
@options.run_argument("run")
@options.as_json
@click.pass_obj
def command(session: Session, *, run: str, as_json: bool) -> None:
    """Show an ancestry."""
    from slidepipe.artifacts.ancestry import ancestry
    from slidepipe.cli.views.ancestry import ancestry_lines, ancestry_view

    store = session.store()
    found = store.get(run)
    ancestors = ancestry(store, [found])
    if as_json:
        render.put_json("slidepipe.ancestry/1", {"run": found.id, "ancestors": ancestry_lines(ancestors)})
    else:
        render.put(ancestry_view(ancestors, found.id))
