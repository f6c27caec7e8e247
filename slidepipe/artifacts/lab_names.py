"""Which labs there are. Loads neither YAML nor pydantic."""

from pathlib import Path

EXPERIMENTS = Path("experiments")
"""Where labs are looked for that are called by their names, beside an experiment file or where there is none."""


def labs(beside: Path) -> dict[str, Path]:
    """Files of the labs by their names: those beside an experiment, then those of this folder's experiments."""
    found: dict[str, Path] = {}
    for directory in (beside / "labs", EXPERIMENTS / "labs"):
        for path in sorted(directory.glob("*.yaml")):
            found.setdefault(path.stem, path)
    return found
