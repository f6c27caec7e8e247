"""How the finger slid on the object, in the manner of the paper's Fig. 11."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from slidepipe.figures import style
from slidepipe.figures.sheet import Sheet, new_sheet, pose_rows
from slidepipe.figures.traces import broken, check_poses, near, turned
from slidepipe.series import FloatArray

POSE = pose_rows(0.002, 0.02)
ROOM = 1.5
"""How far beyond the planned motion, as a multiple of its range, a scale follows an object that goes astray."""
MOST_FRAMES = (1.0, 99.0)
"""Percentiles of the frames that a scale shows: outliers among them do not count."""

AWAY_M, AWAY_WAYS = 0.3, 10.0
"""So far from the goal, and so many times the planned way, a finger is not on the object any more."""


@dataclass(frozen=True, slots=True)
class SlidingPanel:
    """One trial: relative poses r_f_b of the finger in {b}, ``[x, y, theta]`` in m and rad, over its time.

    Attributes
    ----------
    title : str
    time_s, planned : (T,), (T, 3)
    raw_time_s, raw : (K,), (K, 3)
        Single frames of the cameras.
    smoothed_time_s, smoothed : (S,), (S, 3)
        What was estimated from them.
    slide_s : tuple of float, optional
        When the object began to slide and when it stopped, s.
    goal : (3,)
        The relative pose that is wanted in the end.
    truth : (K, 3) or (N, 3), optional
        What was true, known in a simulated lab only: at ``raw_time_s``, or at ``truth_time_s`` where that is given.
    position_tolerance_m, angle_tolerance_rad : float
        How near to the goal is near enough.
    truth_time_s : (N,), optional
    """

    title: str
    time_s: FloatArray
    planned: FloatArray
    raw_time_s: FloatArray
    raw: FloatArray
    smoothed_time_s: FloatArray
    smoothed: FloatArray
    slide_s: tuple[float, float] | None
    goal: FloatArray
    truth: FloatArray | None
    position_tolerance_m: float
    angle_tolerance_rad: float
    truth_time_s: FloatArray | None = None

    def __post_init__(self) -> None:
        check_poses(f"plan of {self.title}", self.time_s, self.planned, at_least=2)
        check_poses(f"raw poses of {self.title}", self.raw_time_s, self.raw)
        check_poses(f"smoothed poses of {self.title}", self.smoothed_time_s, self.smoothed)
        if self.truth is not None:
            check_poses(f"truth of {self.title}", self.true_time_s, self.truth)

    @property
    def true_time_s(self) -> FloatArray:
        """Times of the truth."""
        return self.raw_time_s if self.truth_time_s is None else self.truth_time_s

    @property
    def tolerance(self) -> FloatArray:
        """(3,) tolerance of x, y and theta, m and rad."""
        return np.array([self.position_tolerance_m, self.position_tolerance_m, self.angle_tolerance_rad])

    @property
    def plan(self) -> FloatArray:
        """Planned poses, with the angles of the turn in which they reach the goal."""
        running = near(self.planned, self.planned)
        return turned(running, self.goal[2] - running[-1, 2])

    def near_plan(self, poses: FloatArray) -> FloatArray:
        """Poses with their angles in the turn in which the plan begins; none once the object has left the fingers."""
        shown = np.array(near(poses, self.plan))
        reach_m = max(AWAY_M, AWAY_WAYS * float(np.hypot(*np.ptp(self.plan[:, :2], axis=0))))
        away = np.hypot(*(shown[:, :2] - self.goal[:2]).T) > reach_m
        shown[np.maximum.accumulate(away)] = np.nan
        return shown


def draw_sliding(panels: Sequence[SlidingPanel], path: Path) -> None:
    """Draw :func:`sliding_sheet` into a PNG at ``path``."""
    sliding_sheet(panels).save(path)


def sliding_sheet(panels: Sequence[SlidingPanel]) -> Sheet:
    """Draw x, y and theta of the finger in the body frame, with the goal and what its tolerance allows.

    The band about x and about y is the tolerance of the distance: a pose within both may still be too far away.

    Parameters
    ----------
    panels : sequence of SlidingPanel
        One column each: the first and the last trial, say.

    Raises
    ------
    InputError
        There are no panels.
    """
    sheet = new_sheet("Finger in the body frame, $r_f^b$: plan and measurement", [one.title for one in panels], POSE)
    for column, panel in enumerate(panels):
        sheet.shade(column, panel.slide_s)
        for index in range(len(POSE)):
            _draw_row(sheet, index, column, panel)
    for index in range(len(POSE)):
        sheet.scale(index, [_shown(one, index) for one in panels])
    sheet.add_legend(_lines(panels), [("sliding", style.SLIDING), ("tolerance", style.BAND)])
    return sheet


def _draw_row(sheet: Sheet, index: int, column: int, panel: SlidingPanel) -> None:
    axes, factor = sheet.axes[index][column], POSE[index].factor
    goal, allowed = panel.goal[index] * factor, panel.tolerance[index] * factor
    axes.axhspan(goal - allowed, goal + allowed, **style.BAND)
    axes.axhline(goal, **style.GOAL)
    axes.plot(panel.raw_time_s, panel.near_plan(panel.raw)[:, index] * factor, **style.RAW)
    axes.plot(panel.time_s, panel.plan[:, index] * factor, **style.WANTED)
    axes.plot(*broken(panel.smoothed_time_s, panel.near_plan(panel.smoothed)[:, index] * factor), **style.MEASURED)
    if panel.truth is not None:
        axes.plot(panel.true_time_s, panel.near_plan(panel.truth)[:, index] * factor, **style.TRUE)


def _shown(panel: SlidingPanel, index: int) -> FloatArray:
    """Values that a scale must show: the plan and the goal, and the rest as far as it does not dwarf them."""
    goal, allowed = panel.goal[index], panel.tolerance[index]
    wanted = np.concatenate([panel.plan[:, index], [goal - allowed, goal + allowed]])
    room = ROOM * (wanted.max() - wanted.min())
    happened = [panel.near_plan(poses)[:, index] for poses in (panel.smoothed, panel.truth) if poses is not None]
    seen = panel.near_plan(panel.raw)[:, index]
    if np.isfinite(seen).any():
        happened.append(np.nanpercentile(seen, MOST_FRAMES))
    clipped = np.clip(np.concatenate(happened), wanted.min() - room, wanted.max() + room)
    return np.concatenate([wanted, clipped])


def _lines(panels: Sequence[SlidingPanel]) -> list[tuple[str, style.Look]]:
    """Entries of the legend; the truth is named only where it is drawn."""
    lines = [("planned", style.WANTED), ("cameras", style.RAW), ("smoothed", style.MEASURED)]
    if any(panel.truth is not None for panel in panels):
        lines.append(("true", style.TRUE))
    return [*lines, ("goal", style.GOAL)]
