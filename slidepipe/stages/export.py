"""Export: a recording for tools that do not read ours."""

from dataclasses import dataclass
from pathlib import Path

from slidepipe.artifacts.export import export_csv, export_ros2
from slidepipe.artifacts.recording_reader import read_recording
from slidepipe.artifacts.store import Store
from slidepipe.stages.trial_facts import RECORDING

MCAP = ".mcap"


@dataclass(frozen=True, slots=True)
class ExportRequest:
    """Which recording to export, a run's or one at a path, and where to: a bag, tables, or both."""

    trial: str
    store: Store
    ros2: Path | None = None
    csv: Path | None = None


@dataclass(frozen=True, slots=True)
class Exported:
    """A directory that was written, and the names of its files."""

    directory: Path
    files: tuple[str, ...]


def run(request: ExportRequest) -> tuple[Exported, ...]:
    """Export a recording.

    Raises
    ------
    NotFoundError
        There is no such run or file, or the run holds no recording.
    InputError
        The recording is damaged, or a directory exists already.
    """
    path = Path(request.trial)
    if path.suffix != MCAP:
        path = request.store.get(request.trial).file(RECORDING)
    recording = read_recording(path)
    wanted = ((request.ros2, export_ros2), (request.csv, export_csv))
    return tuple(
        Exported(directory, write(recording, directory)) for directory, write in wanted if directory is not None
    )
