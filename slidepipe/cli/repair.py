"""``slidepipe repair``."""

# ruff: noqa: PLC0415  # what computes is imported when it is called, so that help is there at once

from typing import TYPE_CHECKING

import click

from slidepipe.cli import options, render
from slidepipe.cli.exits import ExitCode

if TYPE_CHECKING:
    from slidepipe.cli.session import Session


@options.verb(
    "repair",
    "Show what can be put right in the store; --apply does it.\n\n"
    "Nothing is guessed: a damaged or missing file is copied from where the store has the same bytes, by "
    "their hash; a run without a "
    "seal gets one; the index is made anew. What is replaced goes to the trash.",
    example="slidepipe repair --apply",
    exits={
        ExitCode.OK: "everything is whole, or can be put right",
        ExitCode.STORE: "something cannot be put right: each has its line",
    },
)
@click.option("--apply", "apply_it", is_flag=True, help="Do it.")
@options.as_json
@click.pass_context
def command(ctx: click.Context, *, apply_it: bool, as_json: bool) -> None:
    """Repair the store."""
    from slidepipe.artifacts.repair import find_fixes
    from slidepipe.artifacts.verify import verify_store

    session: Session = ctx.obj
    store = session.store()
    fixes = list(find_fixes(store))
    if apply_it:
        for fix in fixes:
            fix.apply()
        store.index.rebuild()
    mended = {fix.file for fix in fixes}
    left = [one for one in verify_store(store) if one.file not in mended]
    if as_json:
        content = {
            "applied": apply_it,
            "fixes": [{"run": fix.run, "file": str(fix.file), "action": fix.action} for fix in fixes],
            "left": [{"run": one.run, "file": str(one.file), "problem": one.problem} for one in left],
        }
        render.put_json("slidepipe.repair_result/1", content)
    else:
        render.put([f"{fix.file}: {fix.action}" for fix in fixes])
        for one in left:
            render.note(f"error: {one}")
    render.note(_summary(len(fixes), len(left), applied=apply_it))
    if left:
        ctx.exit(ExitCode.STORE)


def _summary(fixes: int, left: int, *, applied: bool) -> str:
    if not fixes and not left:
        return "nothing to repair"
    done = f"{fixes} repaired" if applied else f"{fixes} can be repaired{' (--apply does it)' if fixes else ''}"
    return f"{done}, {left} cannot"
