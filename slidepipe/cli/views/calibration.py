"""A calibration as a person reads it."""

import math

from rich.console import RenderableType
from rich.table import Table

from slidepipe.artifacts.calibration import CalibrationDocument, Placement, Vector
from slidepipe.artifacts.run import Run
from slidepipe.cli.views.tables import angle_mrad, columns, facts, fixed, heading, length_mm, number

_AXES = ("x", "y", "z")


def calibration_view(calibration: CalibrationDocument, run: Run) -> list[RenderableType]:
    """Both placements with one standard deviation, the object's tilt, down, the delay, and what is left."""
    return [
        heading(f"calibration {run.id}", f"from trial {calibration.trial}"),
        _table(calibration),
        "",
        facts(_facts(calibration)),
        "",
        str(run.directory / "calibration.yaml"),
    ]


def _table(calibration: CalibrationDocument) -> Table:
    table = columns("± one standard deviation", *_AXES, numbers=_AXES)
    for name, placement in (
        ("cameras in the base frame", calibration.cameras_in_base),
        ("hand's markers in {f}", calibration.hand_markers),
    ):
        table.add_row(f"{name}, mm", *_lengths(placement))
        table.add_row("  turned by, mrad", *_angles(placement.rotation_rad, placement.rotation_std_rad))
    tilt = calibration.object_tilt
    if tilt is not None:
        table.add_row("tilt of the object's markers, mrad", *_angles(tilt.rotation_rad, tilt.std_rad))
    return table


def _lengths(placement: Placement) -> tuple[str, ...]:
    pairs = zip(placement.position_m, placement.position_std_m, strict=True)
    return tuple(f"{length_mm(value)} ± {length_mm(std)}" for value, std in pairs)


def _angles(rotation: Vector, std: Vector) -> tuple[str, ...]:
    return tuple(f"{angle_mrad(value)} ± {angle_mrad(one)}" for value, one in zip(rotation, std, strict=True))


def _facts(calibration: CalibrationDocument) -> list[tuple[str, str]]:
    x, y, z = (fixed(value, 4) for value in calibration.down_in_cameras)
    late, std = (fixed(1e3 * value, 3) for value in (calibration.joints_late_s, calibration.joints_late_std_s))
    lean, plane = angle_mrad(calibration.lean_rad), angle_mrad(calibration.plane_std_rad)
    left = f"{length_mm(calibration.rms_m)} mm and {angle_mrad(calibration.rms_rad)} mrad rms"
    return [
        ("motion plane", f"heading {angle_mrad(calibration.heading_rad)} mrad, leans by {lean} mrad, each ± {plane}"),
        ("down for the cameras", f"[{x}, {y}, {z}] ± {angle_mrad(calibration.down_std_rad)} mrad"),
        ("joints behind the cameras", f"{late} ± {std} ms"),
        ("the hand turned by", number(math.degrees(calibration.turn_rad), "degrees")),
        ("left between them", f"{left} in {calibration.frames} frames, {calibration.outliers} left out"),
        *(("note", text) for text in calibration.notes),
    ]
