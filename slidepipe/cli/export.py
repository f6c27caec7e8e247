"""``slidepipe export``."""

# ruff: noqa: PLC0415  # what computes is imported when it is called, so that help is there at once

from pathlib import Path
from typing import TYPE_CHECKING

import click

from slidepipe.cli import options, render

if TYPE_CHECKING:
    from slidepipe.cli.session import Session


@options.verb(
    "export",
    "Export a recorded trial as a ROS 2 bag, as CSV tables, or both.\n\n"
    "The trial is a run, or the path of a recording (a file that ends in .mcap). A bag holds the poses, joint states "
    "and events as ROS has them; a directory of tables has one file for each topic, with SI units in the heads.",
    example="slidepipe export @latest:execute --csv tables",
    exits={},
)
@options.run_argument("trial")
@click.option("--ros2", type=click.Path(path_type=Path), metavar="DIR", help="Write a ROS 2 bag (MCAP) there.")
@click.option("--csv", type=click.Path(path_type=Path), metavar="DIR", help="Write CSV tables there.")
@options.as_json
@click.pass_obj
def command(session: "Session", *, trial: str, ros2: Path | None, csv: Path | None, as_json: bool) -> None:
    """Export."""
    from slidepipe.stages.export import ExportRequest, run

    if ros2 is None and csv is None:
        raise click.UsageError("say what to write: --ros2 DIR, --csv DIR, or both")
    written = run(ExportRequest(trial, session.store(), ros2, csv))
    if as_json:
        content = [{"directory": str(one.directory), "files": list(one.files)} for one in written]
        render.put_json("slidepipe.export_result/1", {"exported": content})
    else:
        render.put([str(one.directory / name) for one in written for name in one.files])
