"""``slidepipe run``."""

# ruff: noqa: PLC0415  # what computes is imported when it is called, so that help is there at once

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import click

from slidepipe.cli import options, render
from slidepipe.cli.exits import MEANINGS, ExitCode
from slidepipe.cli.session import Report, Session, plain
from slidepipe.cli.watching import watched

if TYPE_CHECKING:
    from slidepipe.artifacts.iteration_setup import Way


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
@options.way
@click.option(
    "--repeat",
    type=click.IntRange(min=1),
    help="Execute the first plan so often in the simulated lab, to see how it repeats.",
)
@click.option("--resume", is_flag=True, help="Go on where the experiment's last campaign ended or was interrupted.")
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
    way: "Way | None",
    repeat: int | None,
    resume: bool,
    lab: str | None,
    yes: bool,
    as_json: bool,
) -> None:
    """Go round the loop, and show every trial."""
    from slidepipe.stages.one_dof import is_one_dof

    session: Session = ctx.obj
    others = {"--lab": lab, "--trials": trials, "--way": way}
    if is_one_dof(experiment):
        _without({**others, "--repeat": repeat, "--resume": resume or None}, "an experiment of one degree of freedom")
        from slidepipe.cli.one_dof import run_one_dof

        ctx.exit(run_one_dof(session, experiment, overrides, as_json=as_json))
    if repeat is not None:
        _without(others, "--repeat, which executes the first plan in the simulated lab,")
        _repeat(session, experiment, overrides, count=repeat, resume=resume, as_json=as_json)
        return
    from slidepipe.cli.views.campaign import campaign_view
    from slidepipe.stages.campaign import CampaignRequest, run

    with watched(lab, yes=yes, beside=experiment.parent) as real:
        request = CampaignRequest(
            experiment=experiment,
            store=session.store(),
            overrides=overrides,
            trials=trials,
            way=way,
            resume=resume,
            command=session.command,
            report=render.note,
            lab=real,
        )
        result = run(request)
    report = Report("slidepipe.run_result/1", result.run, {"document": plain(result.document)})
    report.put(campaign_view(result.document, result.run), as_json=as_json)
    if not result.document.converged:
        ctx.exit(ExitCode.NO)


def _without(options: Mapping[str, object], what: str) -> None:
    """Refuse options that would say nothing."""
    given = [name for name, value in options.items() if value is not None]
    if given:
        raise click.UsageError(f"{what} goes without {' and '.join(given)}")


def _repeat(
    session: Session, experiment: Path, overrides: tuple[str, ...], *, count: int, resume: bool, as_json: bool
) -> None:
    """Execute the first plan again and again, and show how it repeats."""
    from slidepipe.cli.views.repeat import repeat_view
    from slidepipe.stages.repeat import RepeatRequest, run

    request = RepeatRequest(
        experiment=experiment,
        store=session.store(),
        report=render.note,
        count=count,
        overrides=overrides,
        resume=resume,
        command=session.command,
    )
    result = run(request)
    report = Report("slidepipe.repeat_result/1", result.run, {"document": plain(result.document)})
    report.put(repeat_view(result.document, result.run), as_json=as_json)
