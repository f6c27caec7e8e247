"""``docs/theory.md`` against the docstrings: what it names speaks of the equation, and no equation is left out."""

import ast
import re
from collections.abc import Iterator

from tests.docs.reading import ROOT

EQUATIONS = range(1, 23)
_MENTION = re.compile(r"\beqs?\.\s+((?:\(?\d+\)?(?:,\s*|\s+to\s+|\s+and\s+)?)+)", re.IGNORECASE)
_ROW = re.compile(r"^\| \((\d+)\) \|[^|]*\|([^|]*)\|$", re.MULTILINE)


def mentioned(text: str) -> set[int]:
    found: set[int] = set()
    for mention in _MENTION.findall(text):
        found |= {int(number) for number in re.findall(r"\d+", mention)}
        for first, last in re.findall(r"(\d+)\)?\s+to\s+\(?(\d+)", mention):
            found |= set(range(int(first), int(last) + 1))
    return found


def docstrings(module: str) -> Iterator[tuple[str, str]]:
    """Docstrings of a module by the name that the page has for it."""
    path = ROOT / "slidepipe" / f"{module.replace('.', '/')}.py"
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Module | ast.FunctionDef | ast.ClassDef):
            yield module if isinstance(node, ast.Module) else f"{module}.{node.name}", ast.get_docstring(node) or ""


def test_the_page_and_the_docstrings_agree() -> None:
    text = (ROOT / "docs" / "theory.md").read_text(encoding="utf-8")
    rows = {int(number): re.findall(r"`([\w.]+)`", places) for number, places in _ROW.findall(text)}
    assert sorted(rows) == list(EQUATIONS)
    for number, places in rows.items():
        assert places, f"eq. ({number}) lives nowhere"
        for place in places:
            room, file, *_ = place.split(".")
            told = {name: body for name, body in docstrings(f"{room}.{file}") if name == place}
            assert told, f"eq. ({number}): there is no {place}"
            assert number in mentioned(" ".join(told.values())), f"eq. ({number}): {place} does not speak of it"


def test_every_other_name_on_the_page_exists() -> None:
    text = (ROOT / "docs" / "theory.md").read_text(encoding="utf-8")
    for room, file in re.findall(r"`(mechanics|planning|estimation)\.(\w+)[\w.]*`", text):
        assert (ROOT / "slidepipe" / room / f"{file}.py").is_file(), f"{room}.{file}"


def test_no_docstring_speaks_of_an_equation_that_the_paper_has_not() -> None:
    for path in (ROOT / "slidepipe").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Module | ast.FunctionDef | ast.ClassDef):
                strange = mentioned(ast.get_docstring(node) or "") - set(EQUATIONS)
                assert not strange, f"{path.relative_to(ROOT)}: {strange}"
