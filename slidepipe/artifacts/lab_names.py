"""Which labs there are. Loads neither YAML nor pydantic."""

from pathlib import Path

DIRECTORY = "labs"
"""Where labs that are called by their names are looked for: beside the experiments."""


def labs_beside(experiments: Path) -> list[str]:
    """Names of the labs that lie beside the experiments of a directory."""
    return sorted(one.stem for one in (experiments / DIRECTORY).glob("*.yaml"))
