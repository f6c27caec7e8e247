"""Is everything as it was published: seals, hashes, links, schemas and the structure of recordings."""

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from slidepipe.artifacts.documents import DOCUMENTS
from slidepipe.artifacts.entry import MANIFEST, SEAL
from slidepipe.artifacts.manifest import InputRef, OutputRef
from slidepipe.artifacts.provenance import recipe_of, sha256_of
from slidepipe.artifacts.run import Run
from slidepipe.artifacts.schema import parse
from slidepipe.artifacts.seal import read_seal
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.strict_yaml import load
from slidepipe.errors import NotFoundError, SlidepipeError

UNSEALED = "is missing: nobody can tell whether the manifest was edited"


@dataclass(frozen=True, slots=True)
class Finding:
    """Something that is not as it was published: the run (or what else), the file, and what is wrong with it.

    Attributes
    ----------
    file : Path
        Where it is wrong.
    problem : str
    """

    run: str
    file: Path
    problem: str

    def __str__(self) -> str:
        return f"{self.file}: {self.problem}"


def verify_store(store: Store) -> Iterator[Finding]:
    """Check every run, name and note of a store."""
    survey = store.survey()
    for directory, fault in survey.damaged:
        yield Finding(directory.name, directory / MANIFEST, fault.removeprefix(f"{directory / MANIFEST}: "))
    for run in survey.runs:
        yield from verify_run(store, run)
    yield from _names(store)
    for fault in store.annotations.faults():
        yield Finding("annotations", store.annotations.path, fault)


def verify_run(store: Store, run: Run) -> Iterator[Finding]:
    """Check one run whose manifest can be read: its seal, its files, and that what it was made from is there."""
    yield from _seal(run)
    yield from _recipe(run)
    yield from _strangers(run)
    for output in run.manifest.outputs:
        yield from _output(run, output)
    for one in run.manifest.inputs:
        yield from _link(store, run, one)


def _seal(run: Run) -> Iterator[Finding]:
    path = run.directory / SEAL
    try:
        sealed = read_seal(run.directory)
    except NotFoundError:
        yield Finding(run.id, path, UNSEALED)
        return
    except SlidepipeError as error:
        yield Finding(run.id, path, str(error).removeprefix(f"{path}: "))
        return
    if sealed.get(MANIFEST) != sha256_of(run.directory / MANIFEST):
        yield Finding(run.id, run.directory / MANIFEST, f"was edited: its sha256 is not the one in {SEAL}")
    named = {output.file: output.sha256 for output in run.manifest.outputs}
    if {name: digest for name, digest in sealed.items() if name != MANIFEST} != named:
        yield Finding(run.id, path, f"names other files or hashes than {MANIFEST}")


def _recipe(run: Run) -> Iterator[Finding]:
    told = run.manifest
    recipe = recipe_of(
        stage=told.stage,
        stage_version=told.stage_version,
        parameters=told.parameters,
        inputs=told.inputs,
        seed=told.seed,
    )
    if recipe != told.recipe:
        problem = "recipe: is not the hash of the stage, parameters, inputs and seed that stand there"
        yield Finding(run.id, run.directory / MANIFEST, problem)


def _strangers(run: Run) -> Iterator[Finding]:
    known = {MANIFEST, SEAL, *(output.file for output in run.manifest.outputs)}
    for name in sorted(os.listdir(run.directory)):  # noqa: PTH208  # names are all that is needed
        if name not in known and not name.startswith("."):
            yield Finding(run.id, run.directory / name, f"is not one of the run's files in {MANIFEST}")


def _output(run: Run, output: OutputRef) -> Iterator[Finding]:
    path = run.directory / output.file
    if not path.is_file():
        yield Finding(run.id, path, "is missing")
        return
    size = path.stat().st_size
    if size != output.size:
        yield Finding(run.id, path, f"has {size} bytes, it was published with {output.size}")
    elif sha256_of(path) != output.sha256:
        yield Finding(run.id, path, "was changed: its sha256 is not the one that it was published with")
    yield from _content(run, path)


def _content(run: Run, path: Path) -> Iterator[Finding]:
    """Check a document against its schema, and a recording's structure and checksums."""
    try:
        if path.suffix == ".yaml":
            _check_document(path)
        elif path.suffix == ".mcap":
            from slidepipe.artifacts.recording_reader import read_recording  # noqa: PLC0415  # loads numpy

            read_recording(path)
    except SlidepipeError as error:
        for line in str(error).splitlines():
            yield Finding(run.id, path, line.removeprefix(f"{path}: ").removeprefix(f"{path}:"))


def _check_document(path: Path) -> None:
    document = load(path)
    header = document.data.get("schema")
    name = header.removeprefix("slidepipe.").partition("/")[0] if isinstance(header, str) else ""
    model = DOCUMENTS.get(name, DOCUMENTS.get(path.stem))
    if model is not None:
        parse(model, document)


def _link(store: Store, run: Run, one: InputRef) -> Iterator[Finding]:
    """Check that what a run was made from is there, with the bytes that it had; files from outside may have changed."""
    if one.run is None:
        return
    manifest = run.directory / MANIFEST
    try:
        origin = store.get_exactly(one.run)
    except NotFoundError:
        yield Finding(run.id, manifest, f"input {one.role}: run {one.run} is not in the store")
        return
    except SlidepipeError:
        return  # its own finding
    there = next((output for output in origin.manifest.outputs if output.file == one.file), None)
    if there is None:
        yield Finding(run.id, manifest, f"input {one.role}: run {one.run} has no {one.file}")
    elif there.sha256 != one.sha256:
        yield Finding(run.id, manifest, f"input {one.role}: {one.run}/{one.file} is not the file that went in")


def _names(store: Store) -> Iterator[Finding]:
    for path in store.refs.paths():
        try:
            store.get_exactly(store.refs.read(path).run)
        except NotFoundError as error:
            yield Finding("refs", path, f"means a {error}")
        except SlidepipeError as error:
            yield Finding("refs", path, str(error).removeprefix(f"{path}: "))
