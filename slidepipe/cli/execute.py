"""``slidepipe execute``."""

# ruff: noqa: PLC0415  # what computes is imported when it is called, so that help is there at once

import click

from slidepipe.cli import options, render
from slidepipe.cli.exits import MEANINGS, ExitCode
from slidepipe.cli.session import Report, Session, plain


@options.verb(
    "execute",
    "Execute a plan in the lab and record what the arm and the cameras say.\n\n"
    "It is never taken from an earlier run: every call makes a new trial.",
    example="slidepipe execute @latest --set lab.friction=0.45 --seed 7",
    exits={
        ExitCode.OK: "executed, and the object is still held",
        ExitCode.NO: "the object was lost; the trial is kept all the same",
        ExitCode.BUSY: MEANINGS[ExitCode.BUSY],
        ExitCode.LAB: MEANINGS[ExitCode.LAB],
    },
)
@options.run_argument("plan_run")
@options.overrides("--set lab.friction=0.45; only keys of lab")
@click.option("--seed", type=click.IntRange(min=0), help="Seed of the simulated lab, the same as --set lab.seed=SEED.")
@options.as_json
@click.pass_context
def command(ctx: click.Context, *, plan_run: str, overrides: tuple[str, ...], seed: int | None, as_json: bool) -> None:
    """Execute, and show what happened."""
    from slidepipe.cli.views.trial import trial_view
    from slidepipe.stages.execute import ExecuteRequest, run

    session: Session = ctx.obj
    if seed is not None:
        overrides += (f"lab.seed={seed}",)
    result = run(ExecuteRequest(plan=plan_run, store=session.store(), overrides=overrides, command=session.command))
    documents = {"document": plain(result.document), "truth": plain(result.truth)}
    report = Report("slidepipe.execute_result/1", result.run, documents)
    report.put(trial_view(result.document, result.truth, result.run), as_json=as_json)
    if result.document.outcome == "lost":
        render.note(f"lost: the fingers did not hold the object to the end of trial {result.run.id}")
        ctx.exit(ExitCode.NO)
