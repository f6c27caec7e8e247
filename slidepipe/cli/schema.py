"""``slidepipe schema``."""

# ruff: noqa: PLC0415  # what computes is imported when it is called, so that help is there at once

import json
from pathlib import Path

import click

from slidepipe.cli import options, render
from slidepipe.cli.complete import complete_document

HINT = "# yaml-language-server: $schema={path}"


@options.verb(
    "schema",
    "Print the JSON Schema of a document, for editors and other programs.\n\n"
    "Without a NAME the documents are listed. "
    "An editor with a YAML language server (VS Code with the YAML extension, Neovim, Emacs, Helix) checks and "
    "completes a file that begins with the line '# yaml-language-server: $schema=PATH'.",
    example="slidepipe schema experiment --out experiment.schema.json",
    exits={},
)
@click.argument("name", required=False, metavar="[NAME]", shell_complete=complete_document)
@click.option("--out", type=click.Path(path_type=Path, dir_okay=False), help="Write it to this file instead.")
@options.as_json
def command(*, name: str | None, out: Path | None, as_json: bool) -> None:
    """Print a schema."""
    from slidepipe.artifacts.json_schema import json_schema, names

    if name is None:
        listed = names()
        if as_json:
            render.put_json("slidepipe.schemas/1", {"documents": [{"name": key, **one} for key, one in listed.items()]})
        else:
            render.put([f"{key:12s} {one['schema']:24s} {one['what']}" for key, one in listed.items()])
        return
    schema = json_schema(name)
    if out is not None:
        _write(out, json.dumps(schema, indent=2) + "\n")
        render.note(f"wrote {out}; an editor uses it in a file whose first line is")
        render.note(HINT.format(path=out))
    if as_json:
        render.put_json("slidepipe.json_schema/1", {"name": name, "json_schema": schema})
    elif out is None:
        render.put([json.dumps(schema, indent=2)])


def _write(out: Path, text: str) -> None:
    from slidepipe.artifacts.durable import whole

    with whole(out) as draft:
        draft.write_text(text, encoding="utf-8")
