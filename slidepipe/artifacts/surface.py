"""Force and motion data: the supports and the pairs that a limit surface is fitted to, and what the fit tells."""

import csv
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, ClassVar

import numpy as np
from pydantic import Field

from slidepipe.artifacts.faults import Fault
from slidepipe.artifacts.schema import Artifact, Record
from slidepipe.artifacts.values import Count, NotNegative, Positive, Slug
from slidepipe.errors import InputError, NotFoundError
from slidepipe.series import FloatArray

COLUMNS = ("force_x_n", "force_y_n", "moment_n_m", "step_x_m", "step_y_m", "step_rad")
"""Header of a file of pairs: the wrench on the object and its displacement, in {b} about the centre of mass."""
SUM_TOLERANCE = 1e-3


class SupportPoint(Record):
    """Where the object stands, in {b} about the centre of mass; ``share`` of the load, if it is known."""

    x_m: float
    y_m: float
    share: Annotated[float, Field(ge=0.0, le=1.0)] | None = None


class SupportsDocument(Artifact):
    """What is read as ``supports.yaml``: a name for the data, and the point supports."""

    SCHEMA: ClassVar[str] = "slidepipe.supports"

    name: Slug
    supports: Annotated[tuple[SupportPoint, ...], Field(min_length=1, max_length=1000)]

    def faults(self) -> Iterator[Fault]:
        """Shares of some supports only, or that do not add up."""
        shares = [point.share for point in self.supports if point.share is not None]
        if shares and len(shares) < len(self.supports):
            yield Fault(("supports",), "share must be given for all supports or for none")
        elif shares and abs(sum(shares) - 1.0) > SUM_TOLERANCE:
            yield Fault(("supports",), f"shares must add up to 1, got {sum(shares):.6g}")


class SupportFriction(Record):
    """One support's share of the friction; its standard deviation is zero where it was given."""

    x_m: float
    y_m: float
    share: Annotated[float, Field(ge=0.0, le=1.0)]
    share_std: NotNegative


class SlidingDirectionError(Record):
    """Between predicted and measured directions of sliding: the median, and what nine of ten are below."""

    median_rad: NotNegative
    ninth_decile_rad: NotNegative


class Ellipsoid(Record):
    """The paper's ellipsoid at the centre of mass: its largest force, and its largest moment over that force."""

    friction_n: Positive
    rho_m: Positive


class SurfaceDocument(Artifact):
    """What is written as ``surface.yaml``."""

    SCHEMA: ClassVar[str] = "slidepipe.surface"

    name: Slug
    pairs: Count
    shares_given: bool
    friction_n: Positive
    friction_std_n: NotNegative
    supports: tuple[SupportFriction, ...]
    rms_force_n: NotNegative
    rms_moment_n_m: NotNegative
    arm_m: NotNegative
    ellipsoid: Ellipsoid
    exact_direction_error: SlidingDirectionError
    ellipsoid_direction_error: SlidingDirectionError
    models_apart: SlidingDirectionError


def read_pairs(path: Path) -> FloatArray:
    """(M, 6) rows of a CSV file whose header names :data:`COLUMNS`, in any order.

    Raises
    ------
    InputError
        A column is missing or unknown, or a field is no finite number: file, line and column.
    NotFoundError
        There is no such file.
    """
    try:
        with path.open(newline="", encoding="utf-8") as file:
            rows = list(csv.reader(file))
    except FileNotFoundError:
        raise NotFoundError(f"{path}: no such file") from None
    except IsADirectoryError:
        raise InputError(f"{path}: is a directory, a CSV file is needed") from None
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: is not UTF-8 at byte {error.start}") from None
    header = [name.strip() for name in rows[0]] if rows else []
    if sorted(header) != sorted(COLUMNS):
        raise InputError(f"{path}:1:1: the header must name {', '.join(COLUMNS)}, got {', '.join(header) or 'nothing'}")
    numbers = [_numbers(path, line, row) for line, row in enumerate(rows[1:], start=2) if row]
    order = [header.index(name) for name in COLUMNS]
    return np.array(numbers, dtype=float).reshape(-1, len(COLUMNS))[:, order]


def _numbers(path: Path, line: int, row: list[str]) -> list[float]:
    if len(row) != len(COLUMNS):
        raise InputError(f"{path}:{line}:1: must have {len(COLUMNS)} fields, got {len(row)}")
    values = []
    for place, text in enumerate(row):
        try:
            value = float(text)
        except ValueError:
            value = np.nan
        if not np.isfinite(value):
            column = 1 + len(",".join(row[:place])) + (place > 0)
            raise InputError(f"{path}:{line}:{column}: must be a finite number, got {text.strip()!r}")
        values.append(value)
    return values
