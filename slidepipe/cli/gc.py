"""``slidepipe gc``."""

# ruff: noqa: PLC0415  # what computes is imported when it is called, so that help is there at once

from datetime import datetime

import click

from slidepipe.cli import options, render
from slidepipe.cli.session import Session
from slidepipe.cli.times import INSTANT


@options.verb(
    "gc",
    "Show which runs nobody needs; --apply moves them to the trash.\n\n"
    "Never what a name or a note marks, never a trial that ran to its end, never the latest result of each stage of an "
    "experiment, nor what any of these was made from. Nothing is deleted: it can be moved back.",
    example="slidepipe gc --before 7d",
    exits={},
)
@click.option(
    "--before",
    metavar="TIME",
    type=INSTANT,
    default="1d",
    show_default=True,
    help="Only what ended before: 2026-11-24, or 3d, 12h, 30m ago.",
)
@click.option("--apply", "apply_it", is_flag=True, help="Do it.")
@options.as_json
@click.pass_obj
def command(session: Session, *, before: datetime, apply_it: bool, as_json: bool) -> None:
    """Move what nobody needs to the trash."""
    from slidepipe.artifacts.gc import find_garbage, sweep
    from slidepipe.cli.views.garbage import garbage_view
    from slidepipe.cli.views.tables import size

    store = session.store()
    found = find_garbage(store, before=before)
    moved = sweep(store, found) if apply_it else ()
    if as_json:
        garbage = [
            {"name": one.name, "directory": str(one.directory), "reason": one.reason, "size": one.size}
            for one in found.garbage
        ]
        content = {"applied": apply_it, "kept": found.kept, "garbage": garbage, "moved_to": [str(one) for one in moved]}
        render.put_json("slidepipe.sweep/1", content)
    elif found.garbage:
        render.put(garbage_view(found))
    total = size(sum(one.size for one in found.garbage))
    if apply_it:
        render.note(f"moved {len(moved)} to {store.root / 'trash'} ({total}), kept {found.kept}")
    else:
        hint = " (--apply moves them to the trash)" if found.garbage else ""
        render.note(f"{len(found.garbage)} may go, {total}{hint}; {found.kept} are kept")
