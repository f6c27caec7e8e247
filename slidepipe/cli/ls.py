"""``slidepipe ls``."""

# ruff: noqa: PLC0415  # what computes is imported when it is called, so that help is there at once

from dataclasses import replace
from datetime import datetime
from typing import TYPE_CHECKING

import click

from slidepipe.cli import options, render
from slidepipe.cli.complete import complete_experiment, complete_stage
from slidepipe.cli.exits import ExitCode
from slidepipe.cli.times import INSTANT

if TYPE_CHECKING:
    from slidepipe.artifacts.entry import Entry
    from slidepipe.artifacts.query import Page, Query
    from slidepipe.cli.session import Session

STATES = ("complete", "lost", "failed", "interrupted", "stopped")
LIMIT = 100


@options.verb(
    "ls",
    "List the runs in the store, the latest last.\n\n"
    "Times are UTC and those of the end of a run. A TIME is 2026-11-24, 2026-11-24T09:30 or 3d, 12h, 30m ago.",
    example="slidepipe ls --experiment regrasp --stage estimate --since 7d",
    exits={ExitCode.STORE: "a run is damaged: the others are listed all the same"},
)
@click.option("--experiment", metavar="NAME", shell_complete=complete_experiment, help="Only runs of this experiment.")
@click.option(
    "--stage",
    metavar="NAME",
    shell_complete=complete_stage,
    help="Only runs of this stage: plan, execute, estimate ...",
)
@click.option(
    "--state", "states", multiple=True, type=click.Choice(STATES), help="Only runs that ended so; repeatable."
)
@click.option("--since", metavar="TIME", type=INSTANT, help="Only runs that ended then or later.")
@click.option("--until", metavar="TIME", type=INSTANT, help="Only runs that ended before.")
@click.option(
    "--limit",
    metavar="N",
    type=click.IntRange(min=0),
    help=f"Only the last N, 0 for all.  [default: {LIMIT}, and all with --json]",
)
@options.as_json
@click.pass_context
def command(
    ctx: click.Context,
    *,
    experiment: str | None,
    stage: str | None,
    states: tuple[str, ...],
    since: datetime | None,
    until: datetime | None,
    limit: int | None,
    as_json: bool,
) -> None:
    """List runs."""
    from slidepipe.artifacts.query import Query
    from slidepipe.cli.views.listing import run_line

    session: Session = ctx.obj
    limit = (0 if as_json else LIMIT) if limit is None else limit
    query = Query(
        experiment=experiment,
        stage=stage,
        states=states,
        since=_text(since),
        until=_text(until),
        limit=limit or None,
    )
    page = session.find(query)
    left = _interrupted(page, query, session)
    page = replace(page, entries=(*page.entries, *left), total=page.total + len(left))
    faults = [str(one.fault) for one in page.damaged]
    if as_json:
        content = {"runs": [run_line(one) for one in page.entries], "faults": faults}
        render.put_json("slidepipe.run_list/1", content)
    else:
        _show(page, query, session)
    for fault in faults:
        render.note(f"error: {fault}")
    if left:
        render.note(f"{len(left)} interrupted and not published: slidepipe recover")
    if faults:
        ctx.exit(ExitCode.STORE)


def _interrupted(page: "Page", query: "Query", session: "Session") -> "list[Entry]":
    """Runs in the making whose process was killed, as far as they are asked for."""
    if not page.drafts:
        return []
    from slidepipe.artifacts.entry import entry_of

    left = [one.as_run() for one in session.store().abandoned()]
    found = [entry_of(run.manifest, run.directory) for run in left]
    return [
        one
        for one in found
        if query.experiment in (None, one.experiment)
        and query.stage in (None, one.stage)
        and (not query.states or one.state in query.states)
        and (query.since is None or one.finished >= query.since)
        and (query.until is None or one.finished < query.until)
    ]


def _show(page: "Page", query: "Query", session: "Session") -> None:
    from slidepipe.cli.views.listing import run_list

    if page.entries:
        render.put(run_list(page.entries))
    elif page.damaged:
        return
    else:
        from slidepipe.artifacts.query import Query
        from slidepipe.cli.views.listing import nothing_found

        render.note(nothing_found(query, session.find(Query()).entries, session.data))
    if page.total > len(page.entries):
        render.note(f"the last {len(page.entries)} of {page.total} runs (--limit 0 lists all)")


def _text(when: datetime | None) -> str | None:
    """Time as manifests write it."""
    return None if when is None else f"{when:%Y-%m-%dT%H:%M:%S.%fZ}"
