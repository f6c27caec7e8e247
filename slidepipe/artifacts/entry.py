"""What a list of runs shows of each: the manifest in short. Loads neither YAML nor pydantic."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from slidepipe.artifacts.manifest import Manifest


MANIFEST, SEAL = "run.yaml", "run.sha256"
HEADER = b"schema: slidepipe.run/1\n"
"""Of manifests whose blocks are known."""
_BLOCK = re.compile(r"^(?=[a-z_]+:)", re.MULTILINE)
_SHOWN = ("run:", "stage:", "experiment:", "state:", "times:", "recipe:", "seed:", "inputs:", "results:")


@dataclass(frozen=True, slots=True)
class Stamp:
    """What a file looks like from outside; a file that was edited, or damaged by an edit, looks otherwise."""

    modified_ns: int
    size: int
    inode: int

    @classmethod
    def of(cls, path: Path) -> "Stamp":
        """Look at a file; raises OSError where there is none."""
        status = path.stat()
        return cls(status.st_mtime_ns, status.st_size, status.st_ino)


@dataclass(frozen=True, slots=True, kw_only=True)
class Entry:
    """One run as a list shows it.

    Attributes
    ----------
    run : str
    directory : Path
    stage, experiment, state, recipe, started, finished : str
        As in the manifest; empty where it cannot be read.
    seed : int or None
    inputs : tuple of str
        Runs that it was made from.
    results : tuple of Mapping
        ``name``, ``value``, ``std`` and ``unit`` of each.
    fault : str or None
        Why the manifest cannot be read.
    """

    run: str
    directory: Path
    stage: str = ""
    experiment: str = ""
    state: str = ""
    recipe: str = ""
    started: str = ""
    finished: str = ""
    seed: int | None = None
    inputs: tuple[str, ...] = ()
    results: tuple[Mapping[str, Any], ...] = ()
    fault: str | None = None


def read_entry(directory: Path) -> Entry | None:
    """Entry of a published run; None where it was moved away meanwhile."""
    return sealed_entry(directory) or _validated_entry(directory)


def sealed_entry(directory: Path) -> Entry | None:
    """Entry of a run whose manifest has the bytes that its seal tells; None where it has not.

    Such a manifest was validated when it was written: what a list does not show is not even parsed.
    """
    try:
        raw, seal = (directory / MANIFEST).read_bytes(), (directory / SEAL).read_bytes()
    except OSError:
        return None
    if not raw.startswith(HEADER) or not seal.startswith(sha256(raw).hexdigest().encode() + b"  run.yaml\n"):
        return None
    from slidepipe.artifacts.strict_yaml import loads  # noqa: PLC0415  # a list that is known needs no YAML

    text = "".join(block for block in _BLOCK.split(raw.decode()) if block.startswith(_SHOWN))
    told: dict[str, Any] = loads(text, str(directory / MANIFEST)).data
    if told["run"] != directory.name:
        return None
    return Entry(
        run=told["run"],
        directory=directory,
        stage=told["stage"],
        experiment=told["experiment"],
        state=told["state"],
        recipe=told["recipe"],
        started=told["times"]["started"],
        finished=told["times"]["finished"],
        seed=told["seed"],
        inputs=tuple(dict.fromkeys(one["run"] for one in told["inputs"] if one["run"] is not None)),
        results=tuple(told["results"]),
    )


def _validated_entry(directory: Path) -> Entry | None:
    from slidepipe.artifacts.run import read_run  # noqa: PLC0415  # a known list needs no YAML
    from slidepipe.errors import NotFoundError, StoreError  # noqa: PLC0415

    try:
        run = read_run(directory)
    except (NotFoundError, StoreError) as error:
        return Entry(run=directory.name, directory=directory, fault=str(error)) if directory.exists() else None
    if run.id != directory.name:
        fault = f"{directory / MANIFEST}: run: must be {directory.name} as its directory, got {run.id}"
        return Entry(run=directory.name, directory=directory, fault=fault)
    return entry_of(run.manifest, directory)


def entry_of(told: "Manifest", directory: Path) -> Entry:
    """Entry of a run by its manifest."""
    return Entry(
        run=told.run,
        directory=directory,
        stage=told.stage,
        experiment=told.experiment,
        state=told.state.value,
        recipe=told.recipe,
        started=told.times.started,
        finished=told.times.finished,
        seed=told.seed,
        inputs=tuple(dict.fromkeys(one.run for one in told.inputs if one.run is not None)),
        results=tuple(one.model_dump(mode="json") for one in told.results),
    )
