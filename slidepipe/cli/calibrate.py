"""``slidepipe calibrate``."""

# ruff: noqa: PLC0415  # what computes is imported when it is called, so that help is there at once

import click

from slidepipe.cli import options
from slidepipe.cli.exits import ExitCode
from slidepipe.cli.session import Report, Session, note_reuse, plain


@options.verb(
    "calibrate",
    "Find from a recorded motion where the cameras are, and the finger on the hand's markers.\n\n"
    "Any trial will do that turns the hand: experiments/paper_rotational.yaml does. What it tells goes into the "
    "estimates of other trials with estimate --calibration.",
    example="slidepipe calibrate @latest:execute",
    exits={ExitCode.OK: "calibrated", ExitCode.NO: "the motion cannot tell, or joints and cameras do not fit"},
)
@options.run_argument("trial_run")
@options.force
@options.as_json
@click.pass_obj
def command(session: Session, *, trial_run: str, force: bool, as_json: bool) -> None:
    """Calibrate, and show what was found."""
    from slidepipe.cli.views.calibration import calibration_view
    from slidepipe.stages.calibrate import CalibrateRequest, run

    result = run(CalibrateRequest(trial=trial_run, store=session.store(), force=force, command=session.command))
    note_reuse(session, result.run, reused=result.reused)
    content = {"reused": result.reused, "document": plain(result.document)}
    report = Report("slidepipe.calibrate_result/1", result.run, content)
    report.put(calibration_view(result.document, result.run), as_json=as_json)
