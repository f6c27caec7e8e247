"""``slidepipe recover``."""

# ruff: noqa: PLC0415  # what computes is imported when it is called, so that help is there at once

from typing import TYPE_CHECKING

import click

from slidepipe.cli import options, render
from slidepipe.cli.exits import MEANINGS, ExitCode

if TYPE_CHECKING:
    from slidepipe.cli.session import Session


@options.verb(
    "recover",
    "Recover what a killed process left: its runs are published as interrupted, with recordings that open.\n\n"
    "Without WHAT everything is recovered that can be; WHAT is the beginning of a run id, or the path of a recording, "
    "which is repaired where it lies.",
    example="slidepipe recover 20261124T",
    exits={
        ExitCode.NO: "a recording cannot be read; its run is published all the same",
        ExitCode.BUSY: MEANINGS[ExitCode.BUSY],
    },
)
@click.argument("what", required=False, metavar="[WHAT]")
@options.as_json
@click.pass_context
def command(ctx: click.Context, *, what: str | None, as_json: bool) -> None:
    """Recover."""
    from slidepipe.cli.views.recover import recovered_line, recovered_view
    from slidepipe.stages.recover import RecoverRequest, run

    session: Session = ctx.obj
    found = run(RecoverRequest(what, session.store()))
    if as_json:
        render.put_json("slidepipe.recover_result/1", {"recovered": [recovered_line(one) for one in found]})
    elif found:
        render.put(recovered_view(found))
    else:
        render.note(f"nothing to recover in {session.data}")
    faults = [fault for one in found for fault in one.faults]
    for fault in faults:
        render.note(f"error: {fault}")
    if faults:
        ctx.exit(ExitCode.NO)
