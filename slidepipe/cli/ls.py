"""``slidepipe ls``."""

# ruff: noqa: PLC0415  # what computes is imported when it is called, so that help is there at once

from typing import TYPE_CHECKING

import click

from slidepipe.cli import options, render
from slidepipe.cli.exits import ExitCode

if TYPE_CHECKING:
    from slidepipe.cli.session import Session


@options.verb(
    "ls",
    "List the runs in the store, the latest last.",
    example="slidepipe ls --experiment regrasp --stage estimate",
    exits={ExitCode.STORE: "a run is damaged: the others are listed all the same"},
)
@click.option("--experiment", metavar="NAME", help="Only runs of this experiment.")
@click.option("--stage", metavar="NAME", help="Only runs of this stage: plan, execute, estimate ...")
@options.as_json
@click.pass_context
def command(ctx: click.Context, *, experiment: str | None, stage: str | None, as_json: bool) -> None:
    """List runs."""
    from slidepipe.cli.views.runs import run_line, run_list

    session: Session = ctx.obj
    survey, abandoned = session.store().survey(), session.store().abandoned()
    runs = [
        run
        for run in (*survey.runs, *(one.as_run() for one in abandoned))
        if experiment in (None, run.manifest.experiment) and stage in (None, run.manifest.stage)
    ]
    if as_json:
        content = {"runs": [run_line(run) for run in runs], "faults": list(survey.faults)}
        render.put_json("slidepipe.run_list/1", content)
    elif runs:
        render.put(run_list(runs))
    else:
        render.note("no such runs" if survey.runs or abandoned else f"no runs in {session.data}")
    for fault in survey.faults:
        render.note(f"error: {fault}")
    if abandoned:
        render.note(f"{len(abandoned)} interrupted and not published: slidepipe recover")
    if survey.faults:
        ctx.exit(ExitCode.STORE)
