"""``slidepipe view``."""

# ruff: noqa: PLC0415  # what computes is imported when it is called, so that help is there at once

from pathlib import Path

import click

from slidepipe.cli import options, render
from slidepipe.cli.exits import ExitCode
from slidepipe.cli.session import Session


@options.verb(
    "view",
    "Show a trial in the rerun viewer: arm and block in space, joints and slide over time.\n\n"
    "The trial is a run, or the path of a recording (a file that ends in .mcap). The viewer is the extra 'view'.",
    example="slidepipe view @latest:execute --save trial.rrd",
    exits={ExitCode.OK: "shown, or written", ExitCode.NOT_FOUND: "no such run or file, or no rerun installed"},
)
@options.run_argument("trial_run")
@click.option("--save", type=click.Path(path_type=Path, dir_okay=False), metavar="FILE",
              help="Open nothing, and write a file: .rrd for 'rerun FILE', .mcap for Foxglove.")  # fmt: skip
@options.as_json
@click.pass_obj
def command(session: Session, *, trial_run: str, save: Path | None, as_json: bool) -> None:
    """Show a trial, or write what would be shown."""
    from slidepipe.stages.view import ViewRequest, run

    result = run(ViewRequest(trial=trial_run, store=session.store(), save=save))
    if as_json:
        content = {"trial": result.name, "poses": result.poses, "joints": result.joints}
        render.put_json("slidepipe.view/1", {**content, "file": str(save) if save else None})
    elif save is not None:
        render.put([f"{save}  {result.name}: {result.poses} poses, {result.joints} joint states"])
