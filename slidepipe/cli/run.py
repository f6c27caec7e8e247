"""``slidepipe run``."""

# ruff: noqa: PLC0415  # what computes is imported when it is called, so that help is there at once

from pathlib import Path

import click

from slidepipe.cli import options, render
from slidepipe.cli.exits import MEANINGS, ExitCode
from slidepipe.cli.session import Report, Session, plain
from slidepipe.cli.watching import watched


@options.verb(
    "run",
    "Plan, execute, estimate and iterate until the finger is within tolerance of its goal.\n\n"
    "Every stage is a run of its own; the table and two pictures are one more.",
    example="slidepipe run experiments/regrasp.yaml --trials 3",
    exits={
        ExitCode.OK: "converged: the last trial is within tolerance",
        ExitCode.NO: "not converged, the object was lost, or no motion within the limits",
        ExitCode.BUSY: MEANINGS[ExitCode.BUSY],
        ExitCode.LAB: MEANINGS[ExitCode.LAB],
    },
)
@click.argument("experiment", metavar="EXPERIMENT.yaml", type=click.Path(path_type=Path))
@click.option("--trials", type=click.IntRange(min=1), help="At most so many.  [default: as the experiment says]")
@options.overrides("--set lab.seed=7")
@options.friction
@options.lab
@options.yes
@options.as_json
@click.pass_context
def command(
    ctx: click.Context,
    *,
    experiment: Path,
    trials: int | None,
    overrides: tuple[str, ...],
    friction: str | None,
    lab: str | None,
    yes: bool,
    as_json: bool,
) -> None:
    """Go round the loop, and show every trial."""
    from slidepipe.cli.views.campaign import campaign_view
    from slidepipe.stages.campaign import CampaignRequest, run

    session: Session = ctx.obj
    with watched(lab, yes=yes, beside=experiment.parent) as real:
        request = CampaignRequest(
            experiment=experiment,
            store=session.store(),
            overrides=overrides,
            trials=trials,
            friction=friction,
            command=session.command,
            report=render.note,
            lab=real,
        )
        result = run(request)
    report = Report("slidepipe.run_result/1", result.run, {"document": plain(result.document)})
    report.put(campaign_view(result.document, result.run), as_json=as_json)
    if not result.document.converged:
        ctx.exit(ExitCode.NO)
