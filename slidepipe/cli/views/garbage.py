"""What nobody needs, as a person reads it."""

from rich.console import RenderableType

from slidepipe.artifacts.gc import Sweep
from slidepipe.cli.views.tables import columns, size


def garbage_view(found: Sweep) -> list[RenderableType]:
    """Table of what may go, and why."""
    table = columns("run", "size", "why", numbers=["size"])
    for one in found.garbage:
        table.add_row(one.name, size(one.size), one.reason)
    return [table]
