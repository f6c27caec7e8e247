"""What ``slidepipe plan`` and ``slidepipe run`` do with a one-DOF experiment."""

# ruff: noqa: PLC0415  # what computes is imported when it is called, so that help is there at once

from pathlib import Path

from slidepipe.cli import render
from slidepipe.cli.exits import ExitCode
from slidepipe.cli.session import Report, Session, note_reuse, plain


def plan_one_dof(
    session: Session, /, *, experiment: Path, overrides: tuple[str, ...], force: bool, as_json: bool
) -> ExitCode:
    """Plan, and show the plan; NO where Theorem 1 promises nothing."""
    from slidepipe.cli.views.one_dof import one_dof_plan_view
    from slidepipe.stages.one_dof import OneDofRequest, plan

    result = plan(OneDofRequest(experiment, session.store(), overrides, force=force, command=session.command))
    note_reuse(session, result.run, reused=result.reused)
    content = {"reused": result.reused, "document": plain(result.document)}
    report = Report("slidepipe.one_dof_plan_result/1", result.run, content)
    report.put(one_dof_plan_view(result.document, result.run), as_json=as_json)
    return ExitCode.OK if result.document.converges else ExitCode.NO


def run_one_dof(session: Session, experiment: Path, overrides: tuple[str, ...], *, as_json: bool) -> ExitCode:
    """Run the trials, and show them; NO where they do not confirm what Theorem 1 promises."""
    from slidepipe.cli.views.one_dof import one_dof_trials_view
    from slidepipe.stages.one_dof import OneDofRequest, run

    request = OneDofRequest(experiment, session.store(), overrides, command=session.command, report=render.note)
    result = run(request)
    report = Report("slidepipe.one_dof_run_result/1", result.run, {"document": plain(result.document)})
    report.put(one_dof_trials_view(result.document, result.run), as_json=as_json)
    return ExitCode.OK if result.document.confirmed else ExitCode.NO
