"""What was recovered, as a person reads it."""

from collections.abc import Iterable

from rich.console import RenderableType

from slidepipe.cli.views.tables import NONE, columns
from slidepipe.stages.recover import Recovered


def recovered_view(found: Iterable[Recovered]) -> list[RenderableType]:
    """Table of runs and recordings."""
    table = columns("run", "recording", "messages", numbers=["messages"])
    table.add_column("what was wrong")
    for one in found:
        run = NONE if one.run is None else one.run.id
        for recording in one.recordings:
            path = recording.path if one.run is None else recording.path.name
            table.add_row(run, str(path), str(recording.messages), recording.fault or "nothing")
        if not one.recordings:
            table.add_row(run, NONE, NONE, "no recording can be read")
    return [table]


def recovered_line(one: Recovered) -> dict[str, object]:
    """One of them as JSON holds it."""
    return {
        "run": None if one.run is None else one.run.id,
        "directory": None if one.run is None else str(one.run.directory),
        "recordings": [
            {"path": str(recording.path), "messages": recording.messages, "fault": recording.fault}
            for recording in one.recordings
        ],
        "faults": list(one.faults),
    }
