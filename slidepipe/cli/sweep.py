"""``slidepipe sweep``."""

# ruff: noqa: PLC0415  # what computes is imported when it is called, so that help is there at once

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import click

from slidepipe.cli import options, render
from slidepipe.cli.session import Report, Session, plain

if TYPE_CHECKING:
    from slidepipe.artifacts.sweep import WorldKind


@options.verb(
    "sweep",
    "Run an experiment in many worlds: drawn, listed, or both.\n\n"
    "KEY=LOW..HIGH is drawn anew for each world, KEY=[A, B] makes a grid, KEY=VALUE holds for all. "
    "Each world is a run of its own; worlds that were tried before are not tried again.",
    example="slidepipe sweep experiments/regrasp.yaml --set lab.friction=0.36..0.44",
    exits={},
)
@click.argument("experiment", metavar="EXPERIMENT.yaml", type=click.Path(path_type=Path))
@click.option(
    "--set", "sets", metavar="KEY=SPEC", multiple=True, help="Set, list or draw a key: lab.friction=0.36..0.44."
)
@click.option("--trials", type=click.IntRange(min=1), default=1, show_default=True, help="Worlds for each setting.")
@click.option("--seed", type=click.IntRange(min=0), default=1, show_default=True, help="Of what is drawn.")
@click.option(
    "--world",
    type=click.Choice(["mechanics", "lab"]),
    default="lab",
    show_default=True,
    help="The exact mechanics with a perfect hand, first motion only; or the simulated lab, whole loop.",
)
@click.option("--workers", type=click.IntRange(min=1), help="Processes.  [default: one for each core]")
@click.option("--scheduler", metavar="ADDRESS", help="Work on the Dask cluster with this scheduler.")
@options.force
@options.as_json
@click.pass_obj
def command(
    session: Session,
    *,
    experiment: Path,
    sets: tuple[str, ...],
    trials: int,
    seed: int,
    world: "WorldKind",
    workers: int | None,
    scheduler: str | None,
    force: bool,
    as_json: bool,
) -> None:
    """Try out every world, and show what they come to."""
    from slidepipe.cli.views.sweep import sweep_view
    from slidepipe.stages.sweep import SweepRequest, run

    with _progress() as report:
        request = SweepRequest(
            experiment=experiment,
            store=session.store(),
            report=report,
            sets=sets,
            trials=trials,
            seed=seed,
            world=world,
            workers=workers or os.cpu_count() or 1,
            scheduler=scheduler,
            force=force,
            command=session.command,
        )
        result = run(request)
    shown = Report("slidepipe.sweep_result/1", result.run, {"document": plain(result.document)})
    shown.put(sweep_view(result.document, result.run), as_json=as_json)


@contextmanager
def _progress() -> Iterator[Callable[[int, int], None]]:
    """Bar on a terminal, and nothing where there is none."""
    import sys

    if not sys.stderr.isatty():
        yield lambda _done, _all: None
        return
    with render.progress("worlds") as bar:
        yield bar
