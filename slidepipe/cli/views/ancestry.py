"""An ancestry as a person reads it: a tree, each run told once."""

from collections.abc import Mapping

from rich.text import Text
from rich.tree import Tree

from slidepipe.artifacts.ancestry import Ancestor, direct, outside
from slidepipe.cli.views.tables import number

RESULTS = 1


def ancestry_tree(ancestors: Mapping[str, Ancestor], run_id: str) -> Tree:
    """Tree below a run: it branches where a run was made from several, so that a long chain stays at the margin."""
    tree = Tree(Text(), guide_style="dim")
    _grow(tree, ancestors, run_id, set())
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
    """Put a chain of runs, line by line, into a node, and a branch for each run and file at which it forks."""
    lines, here = list[Text](), run_id
    while True:
        if here in told:
            lines.append(_line(ancestors[here]).append("  (see above)", "dim"))
            parents, files = [], list[Text]()
            break
        told.add(here)
        lines.append(_line(ancestors[here]))
        parents = sorted(direct(ancestors, here), reverse=True)
        files = [Text(f"file {file}") for file in outside(ancestors, here)]
        if len(parents) != 1 or files:
            break
        here = parents[0]
    if not parents and len(files) == 1:
        lines.append(files.pop())
    tree.label = Text("\n", no_wrap=True, overflow="ignore").join(lines)
    for parent in parents:
        _grow(tree.add(Text()), ancestors, parent, told)
    for file in files:
        tree.add(file)


def _line(one: Ancestor) -> Text:
    if one.run is None:
        return Text(f"{one.id}  is not in the store, or cannot be read")
    told = one.run.manifest
    state = "" if told.state.value == "complete" else f", {told.state.value}"
    results = "".join(f"  {name.name} {number(name.value, name.unit)}" for name in told.results[:RESULTS])
    return Text.assemble(
        one.id, "  ", (told.stage, "bold"), f"  {told.experiment}{state}{results}", no_wrap=True, overflow="ignore"
    )
