"""``slidepipe surface``."""

# ruff: noqa: PLC0415  # what computes is imported when it is called, so that help is there at once

from pathlib import Path

import click

from slidepipe.cli import options
from slidepipe.cli.exits import ExitCode
from slidepipe.cli.session import Report, Session, note_reuse, plain


@options.verb(
    "surface",
    "Fit a limit surface to pushes that were measured with a force sensor.\n\n"
    "PAIRS.csv has a row for each push: force_x_n, force_y_n and moment_n_m on the object, and its displacement "
    "step_x_m, step_y_m and step_rad, all in the body frame about the centre of mass. SUPPORTS.yaml says on which "
    "points the object stands and, if it is known, which share of the load each of them bears.",
    example="slidepipe surface pushes.csv supports.yaml",
    exits={ExitCode.OK: "fitted", ExitCode.NO: "the pairs are too few, or do not fit"},
)
@click.argument("pairs", metavar="PAIRS.csv", type=click.Path(path_type=Path))
@click.argument("supports", metavar="SUPPORTS.yaml", type=click.Path(path_type=Path))
@options.force
@options.as_json
@click.pass_obj
def command(session: Session, *, pairs: Path, supports: Path, force: bool, as_json: bool) -> None:
    """Fit, and show the surface."""
    from slidepipe.cli.views.surface import surface_view
    from slidepipe.stages.surface import SurfaceRequest, run

    request = SurfaceRequest(
        pairs=pairs, supports=supports, store=session.store(), force=force, command=session.command
    )
    result = run(request)
    note_reuse(session, result.run, reused=result.reused)
    content = {"reused": result.reused, "document": plain(result.document)}
    report = Report("slidepipe.surface_result/1", result.run, content)
    report.put(surface_view(result.document, result.run), as_json=as_json)
