"""``slidepipe diff``."""

# ruff: noqa: PLC0415  # what computes is imported when it is called, so that help is there at once

from dataclasses import asdict

import click

from slidepipe.cli import options, render
from slidepipe.cli.session import Session


@options.verb(
    "diff",
    "Show what differs between two runs: parameters, inputs, code, and results with their units.",
    example="slidepipe diff 20261124T093012Z-k3f9 @latest:plan",
    exits={},
)
@options.run_argument("before")
@options.run_argument("after")
@options.as_json
@click.pass_obj
def command(session: Session, *, before: str, after: str, as_json: bool) -> None:
    """Compare two runs."""
    from slidepipe.artifacts.difference import difference
    from slidepipe.cli.views.difference import difference_view, result_line

    store = session.store()
    old, new = store.get(before), store.get(after)
    found = difference(old, new)
    if as_json:
        content = {
            "before": old.id,
            "after": new.id,
            "same_recipe": found.same_recipe,
            "task": [asdict(one) for one in found.task],
            "code": [asdict(one) for one in found.code],
            "results": [result_line(one) for one in found.results],
        }
        render.put_json("slidepipe.difference/1", content)
    else:
        render.put(difference_view(old, new, found))
