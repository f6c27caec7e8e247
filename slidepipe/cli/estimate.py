"""``slidepipe estimate``."""

# ruff: noqa: PLC0415  # what computes is imported when it is called, so that help is there at once

from typing import Any

import click

from slidepipe.cli import options, render
from slidepipe.cli.exits import ExitCode
from slidepipe.cli.session import Report, Session, note_reuse, plain


@options.verb(
    "estimate",
    "Estimate from a recorded trial where the finger ended on the object, and the friction.\n\n"
    "A trial is a run, or the path of a recording (a file that ends in .mcap). Several trials of one experiment are "
    "estimated one by one and then together: friction with its spread within and between trials, how well the motion "
    "repeats, and which trials stand out.",
    example="slidepipe estimate @latest",
    exits={
        ExitCode.OK: "estimated",
        ExitCode.NO: "the object was lost, or the recording does not tell what was asked",
    },
)
@click.argument("trial_run", metavar="TRIAL...", nargs=-1, required=True)
@click.option("--figure", is_flag=True, help="Draw the poses, the slide, the residuals and the posterior, too.")
@click.option("--calibration", metavar="RUN", help="Take cameras and markers to be where this calibration found them.")
@options.overrides("estimation.sticking=apart")
@options.force
@options.as_json
@click.pass_context
def command(ctx: click.Context, /, *, trial_run: tuple[str, ...], as_json: bool, **asked: Any) -> None:
    """Estimate, and show the estimate."""
    if len(trial_run) > 1:
        _together(ctx, trial_run, as_json=as_json, **asked)
        return
    from slidepipe.cli.views.estimate import estimate_view
    from slidepipe.stages.estimate import EstimateRequest, run

    session: Session = ctx.obj
    result = run(EstimateRequest(trial=trial_run[0], store=session.store(), command=session.command, **asked))
    note_reuse(session, result.run, reused=result.reused)
    content = {"reused": result.reused, "document": plain(result.document)}
    report = Report("slidepipe.estimate_result/1", result.run, content)
    report.put(estimate_view(result.document, result.run), as_json=as_json)
    if result.document.lost is not None:
        render.note(f"lost: {result.document.lost}")
        ctx.exit(ExitCode.NO)


def _together(ctx: click.Context, trials: tuple[str, ...], *, as_json: bool, **asked: Any) -> None:
    """Pool several trials; the answer is no only where friction could be told from none of them."""
    from slidepipe.cli.views.pooled import pooled_view
    from slidepipe.stages.pool import PoolRequest, run

    session: Session = ctx.obj
    result = run(PoolRequest(trials=trials, store=session.store(), command=session.command, **asked))
    note_reuse(session, result.run, reused=result.reused)
    estimates = [None if one is None else plain(one.document) for one in result.estimates]
    content = {"reused": result.reused, "document": plain(result.document), "estimates": estimates}
    report = Report("slidepipe.pool_result/1", result.run, content)
    report.put(pooled_view(result.document, result.run), as_json=as_json)
    if result.document.kappa_m_s2 is None:
        render.note("friction: none of the trials tells it")
        ctx.exit(ExitCode.NO)
