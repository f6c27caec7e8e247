"""Make the documentation as pages for a browser: ``make docs``, then open ``build/docs/index.html``.

The reference is made here from what the code says of itself: commands from their ``--help``, documents from their
schemas, the library from its docstrings (by pdoc). Nothing of it is committed.
"""

import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any

import click
from markdown_it import MarkdownIt
from mdit_py_plugins.anchors import anchors_plugin

from slidepipe.artifacts.documents import DOCUMENTS
from slidepipe.artifacts.json_schema import json_schema, names
from slidepipe.cli.main import cli

ROOT = Path(__file__).resolve().parents[1]
OUT = ROOT / "build" / "docs"
ROOMS = ("notebook", "errors", "series", "mechanics", "planning", "arm", "lab", "estimation", "artifacts")
WRITTEN = {
    "index": ROOT / "README.md",
    "tutorial": ROOT / "docs" / "tutorial.md",
    "hardware": ROOT / "docs" / "hardware.md",
    "theory": ROOT / "docs" / "theory.md",
    "paper": ROOT / "docs" / "paper.md",
    "real-data": ROOT / "docs" / "real-data.md",
    "architecture": ROOT / "ARCHITECTURE.md",
    "contributing": ROOT / "CONTRIBUTING.md",
    "changelog": ROOT / "CHANGELOG.md",
}
"""Pages that people wrote, or ``make`` measured, by the name of the page."""
_LINK = re.compile(r"\]\((?:\.\./|docs/)?([A-Za-z-]+)\.md(#[^)]*)?\)")
_STYLE = """
:root { color-scheme: light dark; }
body { font: 16px/1.5 system-ui, sans-serif; max-width: 60rem; margin: 0 auto; padding: 0 1rem 4rem; }
nav { padding: 1rem 0; border-bottom: 1px solid #8886; } nav a { margin-right: .8rem; white-space: nowrap; }
pre { overflow-x: auto; background: #8881; padding: .7rem; border-radius: 4px; } code { font-size: .92em; }
table { border-collapse: collapse; display: block; overflow-x: auto; } img { max-width: 100%; }
td, th { border: 1px solid #8886; padding: .2rem .5rem; text-align: left; vertical-align: top; }
"""


def main() -> None:
    """Write every page."""
    OUT.mkdir(parents=True, exist_ok=True)
    pages = {name: path.read_text(encoding="utf-8") for name, path in WRITTEN.items()}
    pages |= {"commands": commands(), "documents": documents()}
    for name, text in pages.items():
        (OUT / f"{name}.html").write_text(page(name, text, [*pages]), encoding="utf-8")
    for picture in (ROOT / "docs").glob("*.png"):
        (OUT / picture.name).write_bytes(picture.read_bytes())
    library()
    sys.stdout.write(f"{(OUT / 'index.html').relative_to(ROOT)}\n")


def commands() -> str:
    """Page of all commands, as their ``--help`` prints them."""
    top = click.Context(cli, info_name="slidepipe", max_content_width=100, terminal_width=100)
    parts = ["# Commands", *(f"## {path}\n\n```text\n{text}\n```" for path, text in _helps(top))]
    return "\n\n".join(parts) + "\n"


def documents() -> str:
    """Page of all documents, key by key, from their schemas."""
    parts = [
        "# Documents",
        "Every file that slidepipe reads or writes begins with its schema, which `slidepipe schema NAME` prints whole.",
    ]
    for name, told in names().items():
        schema: dict[str, Any] = dict(json_schema(name))
        parts += [f"## {name}", f"`schema: {told['schema']}`", _plain(DOCUMENTS[name].__doc__ or "")]
        rows = [f"| `{key}` | {kind} | {rest} |" for key, kind, rest in _rows(schema, schema.get("$defs", {}), "")]
        parts.append("\n".join(["| key | value | |", "| --- | --- | --- |", *rows]))
    return "\n\n".join(parts) + "\n"


def library() -> None:
    """Pages of the library, from its docstrings."""
    modules = [f"slidepipe.{room}" for room in ROOMS]
    command = [
        sys.executable,
        "-m",
        "pdoc",
        "--docformat",
        "numpy",
        "--output-directory",
        str(OUT / "library"),
        *modules,
    ]
    subprocess.run(command, check=True, env={**os.environ, "PDOC_ALLOW_EXEC": "1"})  # noqa: S603  # our own modules


def page(name: str, text: str, names: Sequence[str]) -> str:
    """One page in HTML, with the way to all others at its head."""
    shown = " ".join(f'<a href="{other}.html">{"start" if other == "index" else other}</a>' for other in names)
    markdown = MarkdownIt("commonmark").enable("table").use(anchors_plugin, max_level=3)
    body = markdown.render(_LINK.sub(_to_page, text).replace("](docs/", "]("))
    return (
        f'<!doctype html><html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width">'
        f"<title>slidepipe: {escape(name)}</title><style>{_STYLE}</style>"
        f'<nav>{shown} <a href="library/index.html">library</a></nav>{body}</html>\n'
    )


def _to_page(found: re.Match[str]) -> str:
    name = {"README": "index"}.get(found[1], found[1].lower())
    return f"]({name}.html{found[2] or ''})"


def _helps(context: click.Context) -> Iterator[tuple[str, str]]:
    command = context.command
    yield context.command_path, command.get_help(context)
    if isinstance(command, click.Group):
        for name in command.list_commands(context):
            below = command.get_command(context, name)
            if below is not None:
                yield from _helps(click.Context(below, info_name=name, parent=context))


def _rows(schema: Mapping[str, Any], defs: Mapping[str, Any], above: str) -> Iterator[tuple[str, str, str]]:
    """Key, kind of value and what is said of it, for every key of an object and of those in it."""
    for key, value in schema.get("properties", {}).items():
        told = _resolved(value, defs)
        needed = "required" if key in schema.get("required", ()) else f"default `{json.dumps(value.get('default'))}`"
        yield above + key, _kind(value, defs), ". ".join(filter(None, [needed, _plain(told.get("description", ""))]))
        for many, inner in _objects(told, defs):
            yield from _rows(inner, defs, f"{above}{key}{many}.")


def _objects(told: Mapping[str, Any], defs: Mapping[str, Any]) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Objects that a value is, may be, or is a list of, each with ``.N`` for the list."""
    if "properties" in told:
        yield "", told
    for one in told.get("anyOf", ()):
        yield from _objects(_resolved(one, defs), defs)
    if isinstance(told.get("items"), dict):
        yield from ((f".N{many}", inner) for many, inner in _objects(_resolved(told["items"], defs), defs))


def _resolved(value: Mapping[str, Any], defs: Mapping[str, Any]) -> Mapping[str, Any]:
    return defs[value["$ref"].rpartition("/")[2]] if "$ref" in value else value


_BOUNDS = {"minimum": "at least", "exclusiveMinimum": "above", "maximum": "at most", "exclusiveMaximum": "below"}


def _kind(value: Mapping[str, Any], defs: Mapping[str, Any]) -> str:
    told = _resolved(value, defs)
    if "const" in told:
        return f"`{told['const']}`"
    if "enum" in told:
        return " or ".join(f"`{one}`" for one in told["enum"])
    if "anyOf" in told:
        return " or ".join(_kind(one, defs) for one in told["anyOf"])
    if told.get("type") == "array":
        least, most = told.get("minItems"), told.get("maxItems")
        many = least if least is not None and least == most else "list"
        return f"{many} of {_kind(told.get('items') or (told.get('prefixItems') or [{}])[0], defs)}"
    bounds = [f"{words} {told[key]:g}" for key, words in _BOUNDS.items() if key in told]
    pattern = [f"`{told['pattern']}`"] if "pattern" in told else []
    return ", ".join([str(told.get("type", "anything")), *bounds, *pattern]).replace("|", "\\|")


def _plain(text: str) -> str:
    """Docstring on one line, for a table or a paragraph."""
    return " ".join(text.replace("``", "`").split()).replace("|", "\\|")


if __name__ == "__main__":
    main()
