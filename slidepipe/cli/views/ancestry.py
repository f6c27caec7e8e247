"""An ancestry as a person reads it: a tree, each run told once."""

from collections.abc import Mapping

from rich.text import Text
from rich.tree import Tree

from slidepipe.artifacts.ancestry import Ancestor, direct
from slidepipe.cli.views.tables import number

RESULTS = 1


def ancestry_tree(ancestors: Mapping[str, Ancestor], run_id: str) -> Tree:
    """Tree below a run."""
    told = set[str]()
    tree = Tree(_line(ancestors[run_id]), guide_style="dim")
    _grow(tree, ancestors, run_id, told)
    return tree


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


def _grow(tree: Tree, ancestors: Mapping[str, Ancestor], run_id: str, told: set[str]) -> None:
    told.add(run_id)
    for parent in sorted(direct(ancestors, run_id), reverse=True):
        line = _line(ancestors[parent])
        if parent in told:
            tree.add(line.append("  (see above)", "dim"))
        else:
            _grow(tree.add(line), ancestors, parent, told)
    for file in ancestors[run_id].outside:
        tree.add(Text(f"file {file}"))


def _line(one: Ancestor) -> Text:
    if one.run is None:
        return Text(f"{one.id}  is not in the store, or cannot be read")
    told = one.run.manifest
    state = "" if told.state.value == "complete" else f", {told.state.value}"
    results = "".join(f"  {name.name} {number(name.value, name.unit)}" for name in told.results[:RESULTS])
    return Text.assemble(
        one.id, "  ", (told.stage, "bold"), f"  {told.experiment}{state}{results}", no_wrap=True, overflow="ignore"
    )
