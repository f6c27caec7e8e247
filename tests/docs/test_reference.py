"""The reference that ``make docs`` makes: every command, every document, and pages that a browser can show."""

from importlib.util import module_from_spec, spec_from_file_location
from types import ModuleType

import pytest

from slidepipe.artifacts.documents import DOCUMENTS
from slidepipe.cli.main import VERBS
from tests.docs.reading import ROOT


@pytest.fixture(scope="module")
def build() -> ModuleType:
    spec = spec_from_file_location("build_docs", ROOT / "docs" / "build.py")
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_every_command(build: ModuleType) -> None:
    text = build.commands()
    for verb in VERBS:
        assert f"\n## slidepipe {verb}\n\n```text\nUsage: slidepipe {verb}" in text
    assert "\n## slidepipe lab serve\n" in text


def test_every_document(build: ModuleType) -> None:
    text = build.documents()
    for name in DOCUMENTS:
        assert f"\n## {name}\n" in text
    assert "| `object.mass_kg` | number, above 0, at most 50 | required |" in text
    assert "| `grasp.places.N.force_share` | number, above 0, at most 1 | required |" in text
    assert "| `iteration.patience` | integer, at least 1, at most 100 | default `3` |" in text


def test_a_page(build: ModuleType) -> None:
    made = build.page("index", "# Top\n\n[paper](docs/paper.md) ![picture](docs/demo.png)\n", ["index", "paper"])
    assert '<h1 id="top">Top</h1>' in made
    assert '<a href="paper.html">paper</a> <img src="demo.png"' in made
    assert build.page("x", "[a](ARCHITECTURE.md#artifacts)", []).count('href="architecture.html#artifacts"') == 1
