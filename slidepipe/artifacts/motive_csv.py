"""Motive's CSV export: a line of settings, rows of column heads, then a row for each frame."""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from slidepipe.artifacts.foreign_poses import Sighting
from slidepipe.errors import InputError, NotFoundError
from slidepipe.series import FloatArray

UNITS_M = {"Meters": 1.0, "Centimeters": 0.01, "Millimeters": 0.001}
BODY = "Rigid Body"
MOST_HEAD_ROWS = 12
COLUMNS = (
    *(("Rotation", axis) for axis in "XYZW"),
    *(("Position", axis) for axis in "XYZ"),
)
"""What a rigid body must have, in the order of the export."""


@dataclass(frozen=True, slots=True)
class _Heads:
    """Column heads: what kind of thing each column belongs to, its name, what it tells and along which axis."""

    kinds: list[str]
    names: list[str]
    told: list[str]
    axes: list[str]
    first_row: int


def read_motive_csv(path: Path, hand: str, thing: str) -> Sighting:
    """Poses of two rigid bodies, by name; stamps count from the take's first frame.

    Raises
    ------
    NotFoundError
        There is no such file.
    InputError
        It is no such export, rotations are no quaternions, poses are not global, or a body is missing.
    """
    rows = _rows(path)
    scale_m = _scale_m(path, _settings(rows[0]))
    heads = _heads(path, rows)
    data = rows[heads.first_row :]
    if not data:
        raise InputError(f"{path}: holds no frames")
    numbers = _column(path, data, heads, 0)
    times_s = _column(path, data, heads, 1)
    for name, values in (("Frame", numbers), ("Time", times_s)):
        back = np.flatnonzero(~(np.diff(values) > 0.0))
        if len(back) or not np.isfinite(values[0]):
            line = heads.first_row + (int(back[0]) + 2 if len(back) else 1)
            raise InputError(f"{path}:{line}: {name} must increase from row to row")
    poses = [_poses(path, data, heads, name) * ([scale_m] * 3 + [1.0] * 4) for name in (hand, thing)]
    return Sighting(
        source=str(path),
        stamp_ns=np.round(1e9 * times_s).astype(np.int64),
        frame=numbers.astype(np.int64),
        hand=poses[0],
        object=poses[1],
    )


def _rows(path: Path) -> list[list[str]]:
    try:
        with path.open(encoding="utf-8-sig", newline="") as stream:
            rows = list(csv.reader(stream))
    except FileNotFoundError:
        raise NotFoundError(f"{path}: no such file") from None
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"{path}: cannot be read as CSV: {error}") from None
    if not rows or not rows[0] or rows[0][0] != "Format Version":
        raise InputError(f"{path}:1:1: is no CSV export of Motive: must begin with Format Version")
    return rows


def _settings(row: list[str]) -> Mapping[str, str]:
    return dict(zip(row[::2], row[1::2], strict=False))


def _scale_m(path: Path, settings: Mapping[str, str]) -> float:
    """Metres in the export's unit of length; InputError where it was exported in a way that does not help."""
    units = settings.get("Length Units", "Meters")
    if units not in UNITS_M:
        raise InputError(f"{path}:1: Length Units: must be one of {', '.join(UNITS_M)}, got {units!r}")
    for key, wanted in (("Rotation Type", "Quaternion"), ("Coordinate Space", "Global")):
        if settings.get(key, wanted) != wanted:
            raise InputError(f"{path}:1: {key}: must be {wanted}, got {settings[key]!r}: export it again")
    return UNITS_M[units]


def _heads(path: Path, rows: list[list[str]]) -> _Heads:
    axes = next((index for index, row in enumerate(rows[:MOST_HEAD_ROWS]) if row and row[0] == "Frame"), None)
    kinds = next((index for index, row in enumerate(rows[:MOST_HEAD_ROWS]) if BODY in row), None)
    if axes is None or kinds is None or axes < kinds + 3:
        raise InputError(f"{path}: has no rigid bodies: export the take with them")
    return _Heads(rows[kinds], rows[kinds + 1], rows[axes - 1], rows[axes], axes + 1)


def _poses(path: Path, data: list[list[str]], heads: _Heads, name: str) -> FloatArray:
    """(T, 7) positions and quaternions of a body; NaN where it was not seen."""
    places: dict[tuple[str, str], int] = {}
    for place, (kind, owner, told, axis) in enumerate(
        zip(heads.kinds, heads.names, heads.told, heads.axes, strict=False)
    ):
        if kind == BODY and owner == name:
            places.setdefault((told, axis), place)
    missing = [f"{told} {axis}" for told, axis in COLUMNS if (told, axis) not in places]
    if len(missing) == len(COLUMNS):
        pairs = zip(heads.kinds, heads.names, strict=False)
        there = ", ".join(dict.fromkeys(owner for kind, owner in pairs if kind == BODY))
        raise InputError(f"{path}: has no rigid body {name}, there are: {there}")
    if missing:
        raise InputError(f"{path}: rigid body {name}: has no column {missing[0]}: export it again")
    columns = [_column(path, data, heads, places[head]) for head in (*COLUMNS[4:], *COLUMNS[:4])]
    poses = np.stack(columns, axis=1)
    poses[~np.isfinite(poses).all(axis=1)] = np.nan
    return poses


def _column(path: Path, data: list[list[str]], heads: _Heads, place: int) -> FloatArray:
    """Numbers of a column; NaN where it is empty."""
    values = np.full(len(data), np.nan)
    for index, row in enumerate(data):
        text = row[place].strip() if place < len(row) else ""
        if text:
            try:
                values[index] = float(text)
            except ValueError:
                line = heads.first_row + index + 1
                raise InputError(f"{path}:{line}: column {place + 1}: must be a number, got {text[:40]!r}") from None
    return values
