"""How the hand followed its reference, in the manner of the paper's Fig. 10."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from slidepipe.figures import style
from slidepipe.figures.sheet import Row, Sheet, new_sheet, pose_rows
from slidepipe.figures.traces import broken, check_poses, near, turned
from slidepipe.series import FloatArray

POSE = pose_rows(0.02, 0.05)
POSITION_ERROR, ANGLE_ERROR = len(POSE), len(POSE) + 1
ERRORS = (Row("error (mm)", 1e3, 0.001, height=0.6), Row("error (mrad)", 1e3, 0.002, height=0.6))


@dataclass(frozen=True, slots=True)
class TrackingPanel:
    """One trial: poses of the hand ``[x, y, theta]`` in {w}, m and rad, over the time since its start, s.

    Attributes
    ----------
    title : str
    time_s, reference : (T,), (T, 3)
        What was commanded.
    measured_time_s, measured : (K,), (K, 3)
        What was measured, where it was.
    slide_s : tuple of float, optional
        When the object began to slide and when it stopped.
    """

    title: str
    time_s: FloatArray
    reference: FloatArray
    measured_time_s: FloatArray
    measured: FloatArray
    slide_s: tuple[float, float] | None

    def __post_init__(self) -> None:
        check_poses(f"reference of {self.title}", self.time_s, self.reference, at_least=2)
        check_poses(f"measurement of {self.title}", self.measured_time_s, self.measured)

    @property
    def error(self) -> FloatArray:
        """(K, 2) distance to the reference at the same moment, m, and turn away from it, rad; NaN outside its time."""
        wanted = np.column_stack([np.interp(self.measured_time_s, self.time_s, column) for column in self._wanted.T])
        away = self._seen - wanted
        inside = (self.measured_time_s >= self.time_s[0]) & (self.measured_time_s <= self.time_s[-1])
        return np.where(inside[:, None], np.column_stack([np.hypot(away[:, 0], away[:, 1]), away[:, 2]]), np.nan)

    @property
    def _wanted(self) -> FloatArray:
        return near(self.reference, self.reference)

    @property
    def _seen(self) -> FloatArray:
        return near(self.measured, self.reference)


def draw_tracking(panels: Sequence[TrackingPanel], path: Path) -> None:
    """Draw :func:`tracking_sheet` into a PNG at ``path``."""
    tracking_sheet(panels).save(path)


def tracking_sheet(panels: Sequence[TrackingPanel]) -> Sheet:
    """Draw x, y and theta of the hand, and under them how far it was from where it should have been.

    Parameters
    ----------
    panels : sequence of TrackingPanel
        One column each: the first and the last trial, say.

    Raises
    ------
    InputError
        There are no panels.
    """
    titles = [one.title for one in panels]
    sheet = new_sheet("Hand in the world plane: reference and measurement", titles, POSE + ERRORS)
    panels = _in_one_turn(panels)
    for column, panel in enumerate(panels):
        sheet.shade(column, panel.slide_s)
        _draw_poses(sheet, column, panel)
        _draw_errors(sheet, column, panel)
    _scale(sheet, panels)
    sheet.add_legend([("reference", style.WANTED), ("measured", style.MEASURED)], [("sliding", style.SLIDING)])
    return sheet


def _in_one_turn(panels: Sequence[TrackingPanel]) -> list[TrackingPanel]:
    """Panels whose references end in the same turn, as they must to share a scale."""
    running = [near(one.reference, one.reference) for one in panels]
    shifted = [turned(poses, running[0][-1, 2] - poses[-1, 2]) for poses in running]
    return [replace(panel, reference=poses) for panel, poses in zip(panels, shifted, strict=True)]


def _draw_poses(sheet: Sheet, column: int, panel: TrackingPanel) -> None:
    wanted, seen = panel.reference, near(panel.measured, panel.reference)
    for index, row in enumerate(POSE):
        axes = sheet.axes[index][column]
        axes.plot(panel.time_s, wanted[:, index] * row.factor, **style.WANTED)
        axes.plot(*broken(panel.measured_time_s, seen[:, index] * row.factor), **style.MEASURED)


def _draw_errors(sheet: Sheet, column: int, panel: TrackingPanel) -> None:
    error = panel.error
    for index, unit in ((POSITION_ERROR, "mm"), (ANGLE_ERROR, "mrad")):
        values = error[:, index - POSITION_ERROR] * sheet.rows[index].factor
        axes = sheet.axes[index][column]
        axes.plot(*broken(panel.measured_time_s, values), **{**style.MEASURED, "linewidth": 0.9})
        known = values[np.isfinite(values)]
        if len(known):
            rms, peak = float(np.sqrt(np.mean(known**2))), float(np.max(np.abs(known)))
            axes.set_title(f"rms {rms:.2f} {unit}, peak {peak:.2f} {unit}", loc="right", fontsize=8.0, pad=2.0)


def _scale(sheet: Sheet, panels: Sequence[TrackingPanel]) -> None:
    for index in range(len(POSE)):
        shown = [near(poses, one.reference)[:, index] for one in panels for poses in (one.reference, one.measured)]
        sheet.scale(index, shown)
    sheet.scale(POSITION_ERROR, [np.zeros(1), *(one.error[:, 0] for one in panels)])
    sheet.scale(ANGLE_ERROR, [np.zeros(1), *(one.error[:, 1] for one in panels)])
