"""``slidepipe estimate``."""

# ruff: noqa: PLC0415  # what computes is imported when it is called, so that help is there at once

import click

from slidepipe.cli import options, render
from slidepipe.cli.exits import ExitCode
from slidepipe.cli.session import Report, Session, note_reuse, plain


@options.verb(
    "estimate",
    "Estimate from a recorded trial where the finger ended on the object, and the friction.\n\n"
    "The trial is a run, or the path of a recording (a file that ends in .mcap).",
    example="slidepipe estimate @latest",
    exits={
        ExitCode.OK: "estimated",
        ExitCode.NO: "the object was lost, or the recording does not tell what was asked",
    },
)
@options.run_argument("trial_run")
@options.force
@options.as_json
@click.pass_context
def command(ctx: click.Context, *, trial_run: str, force: bool, as_json: bool) -> None:
    """Estimate, and show the estimate."""
    from slidepipe.cli.views.estimate import estimate_view
    from slidepipe.stages.estimate import EstimateRequest, run

    session: Session = ctx.obj
    result = run(EstimateRequest(trial=trial_run, store=session.store(), force=force, command=session.command))
    note_reuse(session, result.run, reused=result.reused)
    content = {"reused": result.reused, "document": plain(result.document)}
    report = Report("slidepipe.estimate_result/1", result.run, content)
    report.put(estimate_view(result.document, result.run), as_json=as_json)
    if result.document.lost is not None:
        render.note(f"lost: {result.document.lost}")
        ctx.exit(ExitCode.NO)
