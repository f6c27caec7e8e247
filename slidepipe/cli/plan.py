"""``slidepipe plan``."""

# ruff: noqa: PLC0415  # what computes is imported when it is called, so that help is there at once

from pathlib import Path
from typing import Any

import click

from slidepipe.cli import options
from slidepipe.cli.exits import ExitCode
from slidepipe.cli.session import Report, Session, note_reuse, plain


@options.verb(
    "plan",
    "Plan the three-phase motion of an experiment and check it against every limit.\n\n"
    "The experiment's motion section either gives the times of the phases, which are then checked and never changed, "
    "or says what the planner is to make best (objective: fast, gentle, or robust against wrong friction).\n\n"
    "Of a one-DOF experiment: the times of eq. (4), and Theorem 1's conditions.",
    example="slidepipe plan experiments/regrasp.yaml --set friction=0.4",
    exits={
        ExitCode.OK: "planned",
        ExitCode.NO: "no motion within the limits, or no promise of Theorem 1",
    },
)
@click.argument("experiment", metavar="EXPERIMENT.yaml", type=click.Path(path_type=Path))
@options.overrides("--set object.mass_kg=0.03")
@click.option("--figure", is_flag=True, help="Draw the motion, its friction and what wrong friction does, too.")
@options.force
@options.all_limits
@options.as_json
@click.pass_context
def command(ctx: click.Context, /, *, all_limits: bool, as_json: bool, figure: bool, **asked: Any) -> None:
    """Plan, and show the plan."""
    from slidepipe.stages.one_dof import is_one_dof

    session: Session = ctx.obj
    if is_one_dof(asked["experiment"]):
        from slidepipe.cli.one_dof import plan_one_dof

        ctx.exit(plan_one_dof(session, as_json=as_json, **asked))
    from slidepipe.cli.views.plan import plan_view
    from slidepipe.stages.plan import PlanRequest, run

    result = run(PlanRequest(store=session.store(), figure=figure, command=session.command, **asked))
    note_reuse(session, result.run, reused=result.reused)
    report = Report(
        "slidepipe.plan_result/1", result.run, {"reused": result.reused, "document": plain(result.document)}
    )
    report.put(plan_view(result.document, result.run, all_limits=all_limits), as_json=as_json)
