"""Files that were released stay readable: one is stored for each version of each document, and read as it is today."""

import re
from pathlib import Path

import pytest

from slidepipe.artifacts.documents import DOCUMENTS
from slidepipe.artifacts.schema import UPCASTS, dump_model, parse
from slidepipe.artifacts.strict_yaml import load, loads

RELEASED = Path(__file__).parent / "released"
VERSIONS = [(name, version) for name, model in DOCUMENTS.items() for version in range(1, model.VERSION + 1)]


@pytest.mark.parametrize(("name", "version"), VERSIONS)
def test_every_version_is_read(name: str, version: int) -> None:
    path = RELEASED / f"{name}-{version}.yaml"
    assert path.read_text().startswith(f"schema: slidepipe.{name}/{version}\n")
    document = parse(DOCUMENTS[name], load(path))
    assert parse(DOCUMENTS[name], loads(dump_model(document), "again.yaml")) == document


def test_a_file_for_each_version_and_no_other() -> None:
    stored = {re.fullmatch(r"(\w+)-(\d+)\.yaml", path.name).groups() for path in RELEASED.iterdir()}
    assert stored == {(name, str(version)) for name, version in VERSIONS}


def test_an_upcast_for_each_older_version_and_no_other() -> None:
    older = {(f"slidepipe.{name}", version) for name, version in VERSIONS if version < DOCUMENTS[name].VERSION}
    assert set(UPCASTS) == older


@pytest.mark.parametrize(("name", "version"), [pair for pair in VERSIONS if pair[1] == DOCUMENTS[pair[0]].VERSION])
def test_what_is_written_today_is_what_was_released(name: str, version: int) -> None:
    path = RELEASED / f"{name}-{version}.yaml"
    assert dump_model(parse(DOCUMENTS[name], load(path))) == path.read_text(), "a change needs a new version"
