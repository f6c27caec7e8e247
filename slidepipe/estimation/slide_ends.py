"""When a slide began and ended: the instant at which the measured relative pose leaves its rest along a parabola."""

from dataclasses import dataclass, replace

import numpy as np

from slidepipe.estimation.slide import Slide
from slidepipe.estimation.track import Track
from slidepipe.series import FloatArray

INWARDS_S, OUTWARDS_S = 0.06, 0.06
REACH_S, GRID_S = 0.03, 0.0005
SHARE_TO_TOP = 0.8
FEWEST_FRAMES = 12
LAW_SD_S = 0.0045
"""What a parabola costs where the sliding acceleration changes within 60 ms of the end; from trials with known ends."""


@dataclass(frozen=True, slots=True)
class RelativePath:
    """The measured relative pose around a slide.

    Attributes
    ----------
    time_s : (T,)
        Stamps of all frames.
    relative : Track
        Measured r_f_b.
    noise : (3,)
        Standard deviation of one measurement, m and rad.
    """

    time_s: FloatArray
    relative: Track
    noise: FloatArray


def refine_ends(slide: Slide, path: RelativePath, top_s: float) -> Slide:
    """The slide with its ends and their standard deviations from the measured poses.

    Parameters
    ----------
    slide : Slide
        Ends that are right to within 30 ms.
    top_s : float
        When it slid fastest; an end's parabola stays clear of it.
    """
    start, stop = (_end(path, rough, top_s) for rough in (slide.start_s, slide.stop_s))
    if start is not None:
        slide = replace(slide, start_s=start.time_s, start_sd_s=start.sd_s)
    if stop is not None:
        slide = replace(slide, stop_s=stop.time_s, stop_sd_s=stop.sd_s)
    return slide


@dataclass(frozen=True, slots=True)
class _End:
    time_s: float
    sd_s: float


def _end(path: RelativePath, rough_s: float, top_s: float) -> _End | None:
    """Mean and standard deviation of the instant under a flat prior around the rough one; None with too few frames."""
    inwards = float(np.sign(top_s - rough_s))
    since = (path.time_s - rough_s) * inwards
    reach = min(INWARDS_S, SHARE_TO_TOP * abs(top_s - rough_s))
    near = (since < reach) & (since > -OUTWARDS_S) & path.relative.valid
    if np.count_nonzero(near) < FEWEST_FRAMES:
        return None
    shifts = np.arange(-REACH_S, REACH_S, GRID_S)
    misfit = _misfits(since[near], path.relative.pose[near] / path.noise, shifts)
    freedom = max(3 * int(np.count_nonzero(near)) - 7, 1)
    share = np.exp(-0.5 * (misfit - misfit.min()) / max(1.0, float(misfit.min()) / freedom))
    share /= share.sum()
    mean = float(share @ shifts)
    return _End(rough_s + inwards * mean, float(np.sqrt(share @ (shifts - mean) ** 2 + LAW_SD_S**2)))


def _misfits(since: FloatArray, pose: FloatArray, shifts: FloatArray) -> FloatArray:
    """(K,) squared misfits of weighted poses (T, 3) to a rest and a parabola from each instant (K,) on.

    Both are fitted for each instant and axis; with the rest taken out of everything the parabola alone is left.
    """
    parabola = np.maximum(since - shifts[:, None], 0.0) ** 2
    parabola -= parabola.mean(axis=1, keepdims=True)
    pose = pose - pose.mean(axis=0)
    size = np.maximum(np.sum(parabola**2, axis=1), np.finfo(float).tiny)
    explained = np.sum((parabola @ pose) ** 2, axis=1) / size
    return np.asarray(np.sum(pose**2) - explained)
