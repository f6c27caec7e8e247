"""``slidepipe report``."""

# ruff: noqa: PLC0415  # what computes is imported when it is called, so that help is there at once

from pathlib import Path

import click

from slidepipe.cli import options, render
from slidepipe.cli.complete import complete_subject
from slidepipe.cli.exits import ExitCode
from slidepipe.cli.session import Session


@options.verb(
    "report",
    "Write one HTML page about an experiment's trials, which opens without a network.\n\n"
    "SUBJECT is the name of an experiment in the store, or a run: a campaign, a plan, a trial or an estimate.",
    example="slidepipe report regrasp --to report.html",
    exits={ExitCode.OK: "written", ExitCode.NOT_FOUND: "no such experiment or run, or no trial belongs to it"},
)
@click.argument("subject", metavar="SUBJECT", shell_complete=complete_subject)
@click.option("--to", "path", type=click.Path(path_type=Path, dir_okay=False), default=Path("report.html"),
              show_default=True, help="File to write.")  # fmt: skip
@options.as_json
@click.pass_obj
def command(session: Session, *, subject: str, path: Path, as_json: bool) -> None:
    """Write a report, and say where it is."""
    from slidepipe.stages.report import ReportRequest, run

    result = run(ReportRequest(reference=subject, path=path, store=session.store()))
    if as_json:
        content = {"subject": result.subject, "file": str(result.path), "trials": list(result.trials)}
        render.put_json("slidepipe.report/1", {**content, "warnings": list(result.warnings), "bytes": result.size})
        return
    for line in result.warnings:
        render.note(f"warning: {line}")
    count = len(result.trials)
    render.put([f"{result.path}  {count} {'trial' if count == 1 else 'trials'}, {result.size / 1e6:.1f} MB"])
