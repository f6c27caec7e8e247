"""``slidepipe figures``."""

# ruff: noqa: PLC0415  # what computes is imported when it is called, so that help is there at once

from pathlib import Path

import click

from slidepipe.cli import options, render
from slidepipe.cli.exits import ExitCode
from slidepipe.cli.session import Session
from slidepipe.stages.figure_names import TITLES


@options.verb(
    "figures",
    "Draw the paper's figures from runs of its two experiments, each as PDF, SVG and PNG with a caption.\n\n"
    "Runs that are in the store are taken, those that are missing are made. NAME is fig01 to fig12; all without one.",
    example="slidepipe figures fig07 fig12 --to figures",
    exits={ExitCode.OK: "drawn"},
)
@click.argument("names", metavar="[NAME]...", nargs=-1, type=click.Choice(list(TITLES)))
@click.option("--to", "directory", type=click.Path(path_type=Path), default=Path("figures"), show_default=True,
              help="Folder to write to.")  # fmt: skip
@click.option("--experiments", type=click.Path(path_type=Path), default=Path("experiments"), show_default=True,
              help="Folder with paper_linear.yaml and paper_rotational.yaml.")  # fmt: skip
@click.option("--table", type=click.Path(path_type=Path),
              help="Also write the paper's numbers beside ours to this Markdown file.")  # fmt: skip
@options.as_json
@click.pass_obj
def command(
    session: Session, *, names: tuple[str, ...], directory: Path, experiments: Path, table: Path | None, as_json: bool
) -> None:
    """Draw figures, and say where they are."""
    from slidepipe.cli.views.figures import figures_view
    from slidepipe.stages.figures import FiguresRequest, run

    request = FiguresRequest(
        names=names,
        directory=directory,
        experiments=experiments,
        store=session.store(),
        report=render.note,
        table=table,
        command=session.command,
    )
    written = run(request)
    if as_json:
        figures = [
            {"name": one.name, "title": one.title, "caption": one.caption, "files": [str(path) for path in one.paths]}
            for one in written
        ]
        render.put_json("slidepipe.figures/1", {"figures": figures, "table": str(table) if table else None})
    else:
        render.put(figures_view(written, table))
