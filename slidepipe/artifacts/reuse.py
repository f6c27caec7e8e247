"""Why a run was computed although something like it was there."""

from slidepipe.artifacts.difference import Change, difference
from slidepipe.artifacts.manifest import InputRef
from slidepipe.artifacts.query import Query
from slidepipe.artifacts.run import Run
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.wording import describe
from slidepipe.errors import SlidepipeError

LOOKED_AT = 20
"""Earlier runs of the stage among which a like one is sought."""
TOLD = 3
IGNORED = ("state", "experiment")


def equal_before(store: Store, run: Run) -> str | None:
    """Id of the complete run that could have been taken instead of this one."""
    page = store.find(Query(recipe=run.manifest.recipe, states=("complete",)))
    return next((one.run for one in reversed(page.entries) if one.run != run.id), None)


def what_changed(store: Store, run: Run) -> str | None:
    """Say what differs from the stage's last run on the same file or run; None where there is nothing to say."""
    told = run.manifest
    page = store.find(Query(stage=told.stage, experiment=told.experiment, states=("complete",), limit=LOOKED_AT))
    for entry in reversed(page.entries):
        if entry.run == run.id:
            continue
        try:
            before = store.get_exactly(entry.run)
        except SlidepipeError:
            continue
        if _origins(before) & _origins(run):
            changes = [one for one in difference(before, run).task if one.name not in IGNORED]
            return f"unlike run {before.id}: {_words(changes)}" if changes else None
    return None


def _origins(run: Run) -> set[tuple[str, str]]:
    return {_origin(one) for one in run.manifest.inputs}


def _origin(one: InputRef) -> tuple[str, str]:
    return one.role, one.run or one.file


def _words(changes: list[Change]) -> str:
    parameters = [one for one in changes if not one.name.startswith("input.")]
    shown = parameters or changes
    words = ", ".join(_word(one) for one in shown[:TOLD])
    return words if len(shown) <= TOLD else f"{words} and {len(shown) - TOLD} more"


def _word(change: Change) -> str:
    if change.name.startswith("input."):
        return f"another {change.name.removeprefix('input.')} went in"
    return f"{change.name} was {describe(change.before)}, is {describe(change.after)}"
