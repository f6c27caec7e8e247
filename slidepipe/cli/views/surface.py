"""A limit surface that was fitted to force and motion, as a person reads it."""

import math

from rich.console import RenderableType
from rich.table import Table

from slidepipe.artifacts.run import Run
from slidepipe.artifacts.surface import SlidingDirectionError, SurfaceDocument
from slidepipe.cli.views.tables import columns, facts, fixed, heading, length_mm, number

SHOWN = 12
"""Supports that are listed; a patch of many is told by their number."""


def surface_view(surface: SurfaceDocument, run: Run) -> list[RenderableType]:
    """Friction in all and of each support, what is left, and how well each model tells where the object slides."""
    found = surface.ellipsoid
    return [
        heading(f"surface {run.id}", f"{surface.name}, {surface.pairs} pushes"),
        *_supports(surface),
        "",
        facts(
            [
                ("mu f_N of all supports", f"{number(surface.friction_n)} ± {surface.friction_std_n:.2g} N"),
                ("largest moment over force", f"{length_mm(surface.arm_m)} mm"),
                ("left of the wrenches", _left(surface)),
                ("ellipsoid of the same pushes", f"{number(found.friction_n)} N, rho {length_mm(found.rho_m)} mm"),
            ]
        ),
        "",
        _directions(surface),
        "",
        str(run.directory / "surface.yaml"),
    ]


def _supports(surface: SurfaceDocument) -> list[RenderableType]:
    if len(surface.supports) > SHOWN:
        return [f"{len(surface.supports)} supports with {'given' if surface.shares_given else 'fitted'} shares"]
    names = ("x mm", "y mm", "share %")
    table = columns("support", *names, numbers=names)
    for place, point in enumerate(surface.supports, start=1):
        share = fixed(100.0 * point.share, 1)
        told = share if surface.shares_given else f"{share} ± {fixed(100.0 * point.share_std, 1)}"
        table.add_row(f"{place}, {'given' if surface.shares_given else 'fitted'}", length_mm(point.x_m),
                      length_mm(point.y_m), told)  # fmt: skip
    return [table]


def _left(surface: SurfaceDocument) -> str:
    return f"{number(surface.rms_force_n, 'N')} and {number(1e3 * surface.rms_moment_n_m, 'N mm')} rms"


def _directions(surface: SurfaceDocument) -> Table:
    names = ("median °", "nine of ten below °")
    table = columns("direction of sliding for the measured wrench", *names, numbers=names)
    for name, error in (
        ("surface of the supports, beside the motion", surface.exact_direction_error),
        ("ellipsoid, beside the motion", surface.ellipsoid_direction_error),
        ("ellipsoid, beside the surface of the supports", surface.models_apart),
    ):
        table.add_row(name, *_degrees(error))
    return table


def _degrees(error: SlidingDirectionError) -> tuple[str, str]:
    return fixed(math.degrees(error.median_rad), 1), fixed(math.degrees(error.ninth_decile_rad), 1)
