"""``slidepipe verify``."""

# ruff: noqa: PLC0415  # what computes is imported when it is called, so that help is there at once

from typing import TYPE_CHECKING

import click

from slidepipe.cli import options, render
from slidepipe.cli.exits import ExitCode

if TYPE_CHECKING:
    from slidepipe.cli.session import Session


@options.verb(
    "verify",
    "Check hashes, links, schemas and recordings.\n\n"
    "Without a RUN every run, name and note of the store is checked. Each run has a seal, run.sha256, which sha256sum "
    "checks as well.",
    example="slidepipe verify @latest:execute",
    exits={ExitCode.OK: "everything is whole", ExitCode.STORE: "something is not: each has its line"},
)
@options.runs_argument
@options.as_json
@click.pass_context
def command(ctx: click.Context, *, runs: tuple[str, ...], as_json: bool) -> None:
    """Check runs."""
    from slidepipe.artifacts.verify import verify_run, verify_store

    session: Session = ctx.obj
    store = session.store()
    if runs:
        chosen = [store.get(run) for run in runs]
        checked, findings = len(chosen), [one for run in chosen for one in verify_run(store, run)]
    else:
        survey = store.survey()
        checked, findings = len(survey.runs) + len(survey.damaged), list(verify_store(store))
    if as_json:
        lines = [{"run": one.run, "file": str(one.file), "problem": one.problem} for one in findings]
        render.put_json("slidepipe.verification/1", {"checked": checked, "findings": lines})
    else:
        render.put([str(one) for one in findings])
    faulty = len({one.run for one in findings})
    render.note(f"checked {checked} runs: {f'{len(findings)} faults in {faulty}' if findings else 'all whole'}")
    if findings:
        ctx.exit(ExitCode.STORE)
