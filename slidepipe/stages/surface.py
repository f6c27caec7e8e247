"""Surface: the friction between an object and its supports, from pushes with a force sensor."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from slidepipe.artifacts.run import Run, outside_input
from slidepipe.artifacts.schema import dump_model, parse
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.strict_yaml import load
from slidepipe.artifacts.surface import (
    Ellipsoid,
    SlidingDirectionError,
    SupportFriction,
    SupportsDocument,
    SurfaceDocument,
    read_pairs,
)
from slidepipe.estimation.surface_fit import DirectionError, ForceMotion, Supports, SurfaceFit, fit_surface

STAGE, STAGE_VERSION = "surface", 1
SURFACE, PAIRS, SUPPORTS = "surface", "pairs", "supports"
"""Roles of its file and of its inputs."""


@dataclass(frozen=True, slots=True)
class SurfaceRequest:
    """Which pairs of wrench and displacement to fit, on which supports; ``force`` fits them again."""

    pairs: Path
    supports: Path
    store: Store
    force: bool = False
    command: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class SurfaceResult:
    """The fit's run and document; ``reused`` where an equal fit was there already."""

    run: Run
    document: SurfaceDocument
    reused: bool


def run(request: SurfaceRequest) -> SurfaceResult:
    """Fit the limit surface of n point supports to force and motion.

    Raises
    ------
    NotFoundError
        There is no such file.
    InputError
        A file is wrong: which line and column.
    EstimationError
        The pairs are too few, or do not fit.
    """
    document = parse(SupportsDocument, load(request.supports))
    pairs = read_pairs(request.pairs)
    draft = request.store.draft(
        stage=STAGE,
        stage_version=STAGE_VERSION,
        experiment=document.name,
        parameters={},
        inputs=(outside_input(PAIRS, request.pairs), outside_input(SUPPORTS, request.supports)),
        command=request.command,
    )
    known = None if request.force else request.store.find_recipe(draft.recipe)
    if known is not None:
        return SurfaceResult(known, parse(SurfaceDocument, load(known.file(SURFACE))), reused=True)
    fit = fit_surface(ForceMotion(pairs[:, :3], pairs[:, 3:]), _supports(document))
    told = _document(document, fit, len(pairs))
    with draft:
        draft.add(SURFACE, "surface.yaml").write_text(dump_model(told), encoding="utf-8")
        draft.report("friction", fit.friction_n, std=fit.friction_std_n, unit="N")
    return SurfaceResult(draft.run, told, reused=False)


def _supports(document: SupportsDocument) -> Supports:
    points = np.array([(point.x_m, point.y_m) for point in document.supports])
    shares = [point.share for point in document.supports if point.share is not None]
    return Supports(points, np.array(shares) / sum(shares) if shares else None)


def _document(document: SupportsDocument, fit: SurfaceFit, count: int) -> SurfaceDocument:
    return SurfaceDocument(
        name=document.name,
        pairs=count,
        shares_given=document.supports[0].share is not None,
        friction_n=fit.friction_n,
        friction_std_n=fit.friction_std_n,
        supports=tuple(
            SupportFriction(x_m=point.x_m, y_m=point.y_m, share=float(share), share_std=float(std))
            for point, share, std in zip(document.supports, fit.shares, fit.shares_std, strict=True)
        ),
        rms_force_n=fit.rms_force_n,
        rms_moment_n_m=fit.rms_moment_n_m,
        arm_m=fit.arm_m,
        ellipsoid=Ellipsoid(friction_n=fit.ellipsoid.f_N, rho_m=fit.ellipsoid.a),
        exact_direction_error=_error(fit.exact_error),
        ellipsoid_direction_error=_error(fit.ellipsoid_error),
        models_apart=_error(fit.models_apart),
    )


def _error(error: DirectionError) -> SlidingDirectionError:
    return SlidingDirectionError(median_rad=error.median, ninth_decile_rad=error.ninth_decile)
