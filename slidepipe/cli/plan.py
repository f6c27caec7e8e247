"""``slidepipe plan``."""

# ruff: noqa: PLC0415  # what computes is imported when it is called, so that help is there at once

from pathlib import Path

import click

from slidepipe.cli import options
from slidepipe.cli.exits import ExitCode
from slidepipe.cli.session import Report, Session, note_reuse, plain


@options.verb(
    "plan",
    "Plan the three-phase motion of an experiment and check it against every limit.",
    example="slidepipe plan experiments/regrasp.yaml --set friction=0.4",
    exits={ExitCode.OK: "planned", ExitCode.NO: "no motion within the limits: they are named"},
)
@click.argument("experiment", metavar="EXPERIMENT.yaml", type=click.Path(path_type=Path))
@options.overrides("--set object.mass_kg=0.03")
@options.force
@options.all_limits
@options.as_json
@click.pass_obj
def command(
    session: Session, *, experiment: Path, overrides: tuple[str, ...], force: bool, all_limits: bool, as_json: bool
) -> None:
    """Plan, and show the plan."""
    from slidepipe.cli.views.plan import plan_view
    from slidepipe.stages.plan import PlanRequest, run

    request = PlanRequest(
        experiment=experiment, store=session.store(), overrides=overrides, force=force, command=session.command
    )
    result = run(request)
    note_reuse(session, result.run, reused=result.reused)
    report = Report(
        "slidepipe.plan_result/1", result.run, {"reused": result.reused, "document": plain(result.document)}
    )
    report.put(plan_view(result.document, result.run, all_limits=all_limits), as_json=as_json)
