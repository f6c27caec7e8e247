"""``slidepipe execute``."""

# ruff: noqa: PLC0415  # what computes is imported when it is called, so that help is there at once

from typing import TYPE_CHECKING

import click

from slidepipe.cli import options, render
from slidepipe.cli.exits import MEANINGS, ExitCode
from slidepipe.cli.session import Report, Session, plain
from slidepipe.cli.watching import watched

if TYPE_CHECKING:
    from slidepipe.artifacts.run import Run
    from slidepipe.artifacts.trial import TrialDocument


@options.verb(
    "execute",
    "Execute a plan in the lab and record what the arm and the cameras say.\n\n"
    "It is never taken from an earlier run: every call makes a new trial. A real arm is moved only after a person "
    "has said so.",
    example="slidepipe execute @latest --set lab.friction=0.45 --seed 7",
    exits={
        ExitCode.OK: "executed, and the object is still held",
        ExitCode.NO: "the object was lost; the trial is kept all the same",
        ExitCode.BUSY: MEANINGS[ExitCode.BUSY],
        ExitCode.LAB: "the arm was stopped, a part of the lab failed, or time was not kept",
        ExitCode.INTERRUPTED: "Ctrl-C: a real arm stops on its path, and the trial is kept",
    },
)
@options.run_argument("plan_run")
@options.overrides("--set lab.friction=0.45; only keys of lab")
@click.option("--seed", type=click.IntRange(min=0), help="Seed of the simulated lab, the same as --set lab.seed=SEED.")
@options.lab
@options.yes
@options.as_json
@click.pass_context
def command(
    ctx: click.Context,
    *,
    plan_run: str,
    overrides: tuple[str, ...],
    seed: int | None,
    lab: str | None,
    yes: bool,
    as_json: bool,
) -> None:
    """Execute, and show what happened."""
    from slidepipe.cli.views.trial import trial_view
    from slidepipe.stages.execute import ExecuteRequest, run

    session: Session = ctx.obj
    if seed is not None:
        overrides += (f"lab.seed={seed}",)
    with watched(lab, yes=yes) as real:
        result = run(
            ExecuteRequest(plan=plan_run, store=session.store(), overrides=overrides, command=session.command, lab=real)
        )
    documents = {"document": plain(result.document), "truth": plain(result.truth)}
    report = Report("slidepipe.execute_result/1", result.run, documents)
    report.put(trial_view(result.document, result.truth, result.run), as_json=as_json)
    end_with(ctx, result.document, result.run)


def end_with(ctx: click.Context, trial: "TrialDocument", run: "Run") -> None:
    """Say why a trial is none to go on from, and end with its code."""
    state = run.manifest.state.value
    if trial.stopped is not None:
        render.note(f"stopped: {trial.stopped}")
    if state == "interrupted" and trial.stopped is not None:
        ctx.exit(ExitCode.INTERRUPTED)
    if state == "stopped":
        ctx.exit(ExitCode.LAB)
    if trial.outcome == "lost" or state == "lost":
        render.note(f"lost: the fingers did not hold the object to the end of trial {run.id}")
        ctx.exit(ExitCode.NO)
    if trial.invalid is not None:
        render.note(f"invalid: {trial.invalid}: this trial cannot be estimated")
        ctx.exit(ExitCode.LAB)
