"""``slidepipe iterate``."""

# ruff: noqa: PLC0415  # what computes is imported when it is called, so that help is there at once

import click

from slidepipe.cli import options
from slidepipe.cli.exits import ExitCode
from slidepipe.cli.session import Report, Session, note_reuse, plain

WITHIN = "within tolerance: the finger is where it was wanted, there is nothing left to plan"


@options.verb(
    "iterate",
    "Plan the next trial from an estimate: the remaining error becomes the new goal.",
    example="slidepipe iterate @latest --friction keep",
    exits={
        ExitCode.OK: "planned, or already within tolerance",
        ExitCode.NO: "no motion within the limits: they are named; or the object was lost",
    },
)
@options.run_argument("estimate_run")
@options.friction
@options.force
@options.all_limits
@options.as_json
@click.pass_obj
def command(
    session: Session, *, estimate_run: str, friction: str | None, force: bool, all_limits: bool, as_json: bool
) -> None:
    """Plan anew, and show the plan."""
    from slidepipe.cli.views.plan import plan_view
    from slidepipe.stages.iterate import IterateRequest, run

    request = IterateRequest(
        estimate=estimate_run, store=session.store(), friction=friction, force=force, command=session.command
    )
    result = run(request)
    content = {
        "within_tolerance": result.document is None,
        "reused": result.reused,
        "document": plain(result.document),
    }
    report = Report("slidepipe.iterate_result/1", result.run, content)
    if result.run is None or result.document is None:
        report.put([WITHIN], as_json=as_json)
        return
    note_reuse(session, result.run, reused=result.reused)
    report.put(plan_view(result.document, result.run, all_limits=all_limits), as_json=as_json)
