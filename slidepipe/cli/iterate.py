"""``slidepipe iterate``."""

# ruff: noqa: PLC0415  # what computes is imported when it is called, so that help is there at once

from typing import TYPE_CHECKING

import click

from slidepipe.cli import options
from slidepipe.cli.exits import ExitCode
from slidepipe.cli.session import Report, Session, note_reuse, plain

if TYPE_CHECKING:
    from slidepipe.artifacts.iteration_setup import Way

WITHIN = "within tolerance: the finger is where it was wanted, there is nothing left to plan"


@options.verb(
    "iterate",
    "Plan the next trial from an estimate: the remaining error becomes the new goal.",
    example="slidepipe iterate @latest --way goal",
    exits={
        ExitCode.OK: "planned, or already within tolerance",
        ExitCode.NO: "no motion within the limits: they are named; or the object was lost",
    },
)
@options.run_argument("estimate_run")
@options.way
@click.option("--put-back", is_flag=True, help="The object was lost, and is in the grip at its start again.")
@options.force
@options.all_limits
@options.as_json
@click.pass_obj
def command(
    session: Session,
    *,
    estimate_run: str,
    way: "Way | None",
    put_back: bool,
    force: bool,
    all_limits: bool,
    as_json: bool,
) -> None:
    """Plan anew, and show the plan."""
    from slidepipe.cli.views.plan import plan_view
    from slidepipe.cli.views.why import why_view
    from slidepipe.stages.iterate import IterateRequest, run

    request = IterateRequest(
        estimate=estimate_run,
        store=session.store(),
        way=way,
        put_back=put_back,
        force=force,
        command=session.command,
    )
    result = run(request)
    content = {
        "within_tolerance": result.document is None,
        "reused": result.reused,
        "document": plain(result.document),
        "why": plain(result.why),
    }
    report = Report("slidepipe.iterate_result/1", result.run, content)
    if result.run is None or result.document is None:
        report.put([WITHIN], as_json=as_json)
        return
    note_reuse(session, result.run, reused=result.reused)
    view = plan_view(result.document, result.run, all_limits=all_limits)
    if result.why is not None:
        view = [*why_view(result.why), "", *view]
    report.put(view, as_json=as_json)
