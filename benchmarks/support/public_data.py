"""Readers of public recordings that this project did not make, and what slidepipe's estimators say of them.

The data is no part of the repository. The folder that holds it is looked for beside the checkout.
"""

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from slidepipe.errors import EstimationError
from slidepipe.estimation.pooled import Pooled, pool
from slidepipe.estimation.poses import Track
from slidepipe.estimation.smoothing import SmoothedSeries, rest_noise, smooth
from slidepipe.estimation.surface_fit import ForceMotion, Supports
from slidepipe.mechanics.dynamics import GRAVITY
from slidepipe.mechanics.planar import relative_pose, rotation
from slidepipe.series import BoolArray, FloatArray

FOLDER = Path(__file__).resolve().parents[3] / "shared" / "data"

PUSH_LOGS = ("hardboard_tri_small", "hardboard_tri_mid", "hardboard_tri_asym", "hardboard_patch")
PULL_N = 4.2
"""With which the authors pulled the block of the push logs over hardboard."""
COM_M = np.array([0.05, 0.05])
LEG_M = 0.15
PATCH_CELLS = 12
SETTLING_SHARE = 0.3
SENSOR = np.array([[1.0, 1.0], [1.0, -1.0]]) / np.sqrt(2.0)

CUBE_HALF_M = 0.0524
FLAT_RAD, FLAT_M = 0.05, 0.004
SLOWEST_M_S = 0.08
FEWEST_FRAMES = 12
SPIN_SHARE = 0.2
PUBLISHED_MU = (0.18, 0.216)
"""The authors' parameter file, and a measurement of the flat slides' deceleration before this project's."""

UNIT = 1e-3
LARGEST_TILT_RAD, LARGEST_RISE_M = 0.3, 0.015
SEEN_SHARE = 0.5
FASTEST_M_S, FASTEST_RAD_S = 0.15, 1.5
FARTHEST_M, FARTHEST_RAD = 0.02, 0.5
"""How fast and how far a block may have gone while it was out of sight."""


@dataclass(frozen=True, slots=True)
class _Push:
    """Object poses before and after (7,), force rows (K, 3) and finger rows (L, 8) of one push."""

    before: FloatArray
    after: FloatArray
    force: FloatArray
    finger: FloatArray


@dataclass(frozen=True, slots=True)
class Sampling:
    """Which force samples of a push count: those after its first 30 %, and of these the larger or all."""

    larger_only: bool = True


def push_supports(log: str) -> Supports:
    """Point supports of a push log with their shares; the whole face is cut into cells of equal load."""
    told = json.loads((FOLDER / "cmu_three_point_push" / "supports.json").read_text())[log]
    if "load_fractions" not in told:
        cells = np.array(list(_cells(PATCH_CELLS))) * LEG_M / PATCH_CELLS
        return Supports(cells - COM_M, np.full(len(cells), 1.0 / len(cells)))
    shares = np.array(told["load_fractions"])
    return Supports(np.array(told["support_points_m_from_corner"]) - COM_M, shares / shares.sum())


def push_pairs(log: str, sampling: Sampling | None = None) -> ForceMotion:
    """Wrench and displacement of each push of a log, in the body's heading half way through the push."""
    lines = iter((FOLDER / "cmu_three_point_push" / "raw" / f"{log}.txt").read_text().splitlines())
    pairs = [_pair(push, sampling or Sampling()) for push in _pushes(lines)]
    rows = np.array(pairs)
    return ForceMotion(rows[:, :3], rows[:, 3:])


def _cells(count: int) -> Iterator[tuple[float, float]]:
    """Centres of the equal triangles that a right triangle of legs ``count`` is cut into."""
    for i in range(count):
        for j in range(count - i):
            yield i + 1 / 3, j + 1 / 3
            if j < count - i - 1:
                yield i + 2 / 3, j + 2 / 3


def _pushes(lines: Iterator[str]) -> Iterator[_Push]:
    for _ in range(int(next(lines))):
        before, after = (np.array(next(lines).split(), dtype=float) for _ in range(2))
        force, finger = (
            np.array([next(lines).split() for _ in range(int(next(lines)))], dtype=float) for _ in range(2)
        )
        yield _Push(before, after, force, finger)


def _pair(push: _Push, sampling: Sampling) -> FloatArray:
    start, stop = (np.array([*pose[:2] / 1e3, _heading(pose[3:])]) for pose in (push.before, push.after))
    stop[2] = start[2] + np.arctan2(np.sin(stop[2] - start[2]), np.cos(stop[2] - start[2]))
    com = np.array([start + rotation(start[2]) @ [*COM_M, 0.0], stop + rotation(stop[2]) @ [*COM_M, 0.0]])
    half = com.mean(axis=0)
    force = push.force[:, 1:] - push.force[0, 1:]
    size = np.hypot(*force.T)
    kept = np.arange(len(force)) >= SETTLING_SHARE * len(force)
    if sampling.larger_only:
        kept &= size >= size[kept].mean()
    middle_s = push.force[kept, 0].mean()
    contact = np.array([np.interp(middle_s, push.finger[:, 0], push.finger[:, axis]) / 1e3 for axis in (1, 2)])
    turned = rotation(_heading(push.finger[0, 4:])) @ [*(-SENSOR.T @ force[kept].mean(axis=0)), 0.0]
    f = (rotation(half[2]).T @ turned)[:2]
    r = relative_pose(half, np.array([*contact, 0.0]))
    return np.concatenate([f, [r[0] * f[1] - r[1] * f[0]], rotation(half[2]).T @ (com[1] - com[0])])


def _heading(quaternion_wxyz: FloatArray) -> float:
    return float(2.0 * np.arctan2(quaternion_wxyz[3], quaternion_wxyz[0]))


@dataclass(frozen=True, slots=True)
class TossFriction:
    """Coefficient of friction of each flat slide (K,) and its standard deviation, and all of them pooled."""

    mu: FloatArray
    std: FloatArray
    pooled: Pooled


def toss_friction() -> TossFriction:
    """Friction of the cube from the deceleration of every flat slide at the end of a toss."""
    data = np.load(FOLDER / "contactnets_tosses" / "tosses_si.npz")
    found = [
        one
        for start, length in zip(data["start"], data["length"], strict=True)
        if (one := _flat_slide(data["state"][start : start + length], float(data["dt"]))) is not None
    ]
    mu, std = np.array(found).T
    return TossFriction(mu, std, pool(mu, std))


def _flat_slide(state: FloatArray, dt: float) -> tuple[float, float] | None:
    """Friction of the last stretch on which the cube lies flat and slides without much turning: a parabola's bend."""
    up = np.abs(Rotation.from_quat(state[:, 3:7], scalar_first=True).as_matrix()[:, 2, :]).max(axis=1)
    speed, spin = np.hypot(*state[:, 7:9].T), np.linalg.norm(state[:, 10:13], axis=1)
    flat = (np.arccos(np.minimum(up, 1.0)) < FLAT_RAD) & (np.abs(state[:, 2] - CUBE_HALF_M) < FLAT_M)
    flat &= (speed > SLOWEST_M_S) & (spin * CUBE_HALF_M < SPIN_SHARE * speed)
    rows = np.flatnonzero(flat)
    if not len(rows):
        return None
    rows = rows[rows >= rows[np.flatnonzero(np.diff(rows, prepend=rows[0] - 1) > 1).max(initial=0)]]
    if len(rows) < FEWEST_FRAMES:
        return None
    way = (state[rows[-1], :2] - state[rows[0], :2]) / np.linalg.norm(state[rows[-1], :2] - state[rows[0], :2])
    time_s = dt * (rows - rows.mean())
    (bend, _, _), covariance = np.polyfit(time_s, state[rows, :2] @ way, 2, cov=True)
    return -2.0 * bend / GRAVITY, 2.0 * float(np.sqrt(covariance[0, 0])) / GRAVITY


@dataclass(frozen=True, slots=True)
class Stream:
    """A stream of mocap poses of a pushed block, and the same smoothed.

    Attributes
    ----------
    time_s : (T,)
    raw : Track
        Every frame as it came, the lost ones included: x, y (m) and heading (rad).
    believed : Track
        Those frames that can be the block's.
    smoothed : SmoothedSeries
    """

    time_s: FloatArray
    raw: Track
    believed: Track
    smoothed: SmoothedSeries

    @property
    def lost(self) -> int:
        """Frames without a pose that can be believed."""
        return int(np.count_nonzero(~self.believed.valid))

    @property
    def raw_jump_m(self) -> float:
        """Longest step between frames that claim to be tracked."""
        return _longest(self.raw.pose[self.raw.valid])

    @property
    def raw_jump_rad(self) -> float:
        """Largest turn between them, within half a turn."""
        turn = np.diff(self.raw.pose[self.raw.valid, 2])
        return float(np.abs((turn + np.pi) % (2.0 * np.pi) - np.pi).max())

    @property
    def smoothed_jump_m(self) -> float:
        """Longest step between neighbouring frames after smoothing."""
        return _longest(self.smoothed.pose)

    @property
    def loss_jump_m(self) -> float:
        """The same where one of the two frames is lost, or the next to a lost one; zero where none is."""
        near = np.convolve(~self.believed.valid, np.ones(3), mode="same") > 0
        steps = np.hypot(*np.diff(self.smoothed.pose[:, :2], axis=0).T)
        return float(np.max(steps[near[1:] | near[:-1]], initial=0.0))

    @property
    def smoothed_jump_rad(self) -> float:
        """Largest turn between neighbouring frames after smoothing."""
        return float(np.abs(np.diff(self.smoothed.pose[:, 2])).max())


def read_stream(name: str) -> Stream:
    """Read and smooth one stream, such as ``pos8``.

    Raises
    ------
    EstimationError
        The block was tracked in less than half of the frames.
    """
    lines = (FOLDER / "cmu_mocap_push_streams" / "exp3" / f"{name}.txt").read_text().split("\n")
    lines = [line for line in lines if line.strip()]
    stamps, rows = np.array(lines[0::2], dtype=float), np.array([line.split() for line in lines[1::2]], dtype=float)
    fresh = np.diff(stamps, prepend=stamps[0] - 1.0) > 0.0
    stamps, rows = stamps[fresh], rows[fresh]
    claimed = np.abs(np.linalg.norm(rows[:, 3:], axis=1) - 1.0) < UNIT
    if np.count_nonzero(claimed) < SEEN_SHARE * len(claimed):
        raise EstimationError(
            f"{name}: the block was tracked in {np.count_nonzero(claimed)} of {len(claimed)} frames, half are needed"
        )
    time_s = stamps - stamps[0]
    raw, upright = _on_table(rows, claimed)
    believed = _without_swaps(time_s, Track(np.where(upright[:, None], raw.pose, 0.0), upright))
    if np.count_nonzero(believed.valid) < SEEN_SHARE * len(believed.valid):
        raise EstimationError(f"{name}: the block's pose jumps about in more than half of the frames")
    still = time_s < 1.0
    smoothed = smooth(time_s, believed, rest_noise(believed, still), np.ones(len(time_s), dtype=bool))
    return Stream(time_s, raw, believed, smoothed)


def _on_table(rows: FloatArray, claimed: BoolArray) -> tuple[Track, BoolArray]:
    """Poses on the table, turned since the first; and which of them leave the block standing on it."""
    turn = np.tile(np.eye(3), (len(rows), 1, 1))
    matrices = Rotation.from_quat(rows[claimed, 3:], scalar_first=True).as_matrix()
    turn[claimed] = matrices @ matrices[0].T
    heading = np.zeros(len(rows))
    heading[claimed] = np.unwrap(np.arctan2(turn[claimed, 1, 0], turn[claimed, 0, 0]))
    pose = np.column_stack([rows[:, :2] / 1e3, heading])
    tilt, rise = np.arccos(np.clip(turn[:, 2, 2], -1.0, 1.0)), np.abs(rows[:, 2] - np.median(rows[claimed, 2])) / 1e3
    upright = claimed & (tilt < LARGEST_TILT_RAD) & (rise < LARGEST_RISE_M)
    return Track(pose, claimed), upright


def _without_swaps(time_s: FloatArray, track: Track) -> Track:
    """Leave out what is too far from the last believed frame for the time since then.

    The markers of these blocks lie so regularly that the cameras now and then mistake one for another, and the pose
    turns by 90, 120 or 180 degrees for some frames.
    """
    valid, last = track.valid.copy(), int(np.argmax(track.valid))
    for row in np.flatnonzero(track.valid)[1:]:
        gap_s = time_s[row] - time_s[last]
        away, turn = np.hypot(*(track.pose[row] - track.pose[last])[:2]), track.pose[row, 2] - track.pose[last, 2]
        turn = abs((turn + np.pi) % (2.0 * np.pi) - np.pi)
        near = away < min(0.003 + FASTEST_M_S * gap_s, FARTHEST_M)
        valid[row] = near and turn < min(0.03 + FASTEST_RAD_S * gap_s, FARTHEST_RAD)
        last = row if valid[row] else last
    pose = np.where(valid[:, None], track.pose, 0.0)
    pose[valid, 2] = np.unwrap(pose[valid, 2])
    return Track(pose, valid)


def _longest(pose: FloatArray) -> float:
    return float(np.hypot(*np.diff(pose[:, :2], axis=0).T).max())
