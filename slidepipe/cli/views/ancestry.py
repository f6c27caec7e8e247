"""An ancestry as a person reads it: chains that branch, each run told once."""

from collections.abc import Iterator, Mapping
from itertools import chain, repeat

from rich.console import RenderableType
from rich.text import Text

from slidepipe.artifacts.ancestry import Ancestor, direct, outside
from slidepipe.cli.views.tables import number

RESULTS = 1


def ancestry_view(ancestors: Mapping[str, Ancestor], run_id: str) -> list[RenderableType]:
    """Lines below a run: they branch where it was made from several, so that a long chain stays at the margin."""
    return list(_branch(ancestors, run_id, set()))


def ancestry_lines(ancestors: Mapping[str, Ancestor]) -> list[dict[str, object]]:
    """Ancestry as JSON holds it: a flat list, each run with its parents."""
    return [
        {
            "run": one.id,
            "stage": one.run.manifest.stage if one.run else None,
            "experiment": one.run.manifest.experiment if one.run else None,
            "state": one.run.manifest.state.value if one.run else "missing",
            "finished": one.run.manifest.times.finished if one.run else None,
            "parents": list(one.parents),
            "outside": list(one.outside),
        }
        for one in ancestors.values()
    ]


def _branch(ancestors: Mapping[str, Ancestor], run_id: str, told: set[str]) -> Iterator[Text]:
    """A chain of runs, line by line, and a branch for each run and file at which it forks."""
    line = _line(ancestors[run_id])
    if run_id in told:
        yield line.append("  (see above)", "dim")
        return
    told.add(run_id)
    yield line
    branches = [_branch(ancestors, parent, told) for parent in sorted(direct(ancestors, run_id), reverse=True)]
    branches += [iter([Text(f"file {file}")]) for file in outside(ancestors, run_id)]
    if len(branches) == 1:
        yield from branches[0]
        return
    for left, branch in zip(range(len(branches))[::-1], branches, strict=True):
        guides = chain(["├── " if left else "└── "], repeat("│   " if left else "    "))
        yield from (Text.assemble((guide, "dim"), below) for guide, below in zip(guides, branch, strict=False))


def _line(one: Ancestor) -> Text:
    if one.run is None:
        return Text(f"{one.id}  is not in the store, or cannot be read")
    told = one.run.manifest
    state = "" if told.state.value == "complete" else f", {told.state.value}"
    results = "".join(f"  {name.name} {number(name.value, name.unit)}" for name in told.results[:RESULTS])
    return Text.assemble(one.id, "  ", (told.stage, "bold"), f"  {told.experiment}{state}{results}")
