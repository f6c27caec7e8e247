"""Markdown as the tests read it: its fenced blocks, and what their info strings ask for."""

from dataclasses import dataclass
from pathlib import Path

from markdown_it import MarkdownIt

ROOT = Path(__file__).resolve().parents[2]


@dataclass(frozen=True, slots=True)
class Block:
    """A fenced block: ``sh exit=3`` is of language ``sh`` with the option ``exit`` set to ``3``."""

    language: str
    options: dict[str, str]
    text: str
    place: str


def blocks(path: Path) -> list[Block]:
    found = []
    for token in MarkdownIt("commonmark").parse(path.read_text(encoding="utf-8")):
        if token.type in ("fence", "code_block"):
            language, *rest = token.info.split() or [""]
            options = {name: value for name, _, value in (word.partition("=") for word in rest)}
            place = f"{path.relative_to(ROOT)}:{(token.map or [0])[0] + 1}"
            found.append(Block(language, options, token.content, place))
    return found


def inline_code(path: Path) -> list[str]:
    tokens = MarkdownIt("commonmark").enable("table").parse(path.read_text(encoding="utf-8"))
    return [child.content for token in tokens for child in token.children or () if child.type == "code_inline"]
