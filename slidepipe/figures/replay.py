"""One trial in three dimensions, as a recording of the rerun viewer."""

import os
import sys
import sysconfig
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from slidepipe.errors import NotFoundError
from slidepipe.series import FloatArray, IntArray, JointSeries, PoseSeries

TIMELINE = "motion"
INSTEAD = "--save FILE.rrd (for rerun) or FILE.mcap (for Foxglove) writes what it would show"
ARM, HAND, BLOCK = "world/arm", "world/hand", "world/block"
GREY, RED, CREAM = (90, 100, 110), (179, 38, 30), (239, 233, 220)


@dataclass(frozen=True, slots=True)
class Replay:
    """A trial in the arm's base frame, m and rad; every time counts from the start of the motion.

    Attributes
    ----------
    name : str
        The recording's own, such as a run id.
    start_ns : int
        When the motion began on the host's clock.
    hand, block : PoseSeries
        As the cameras saw them.
    joints, commanded : JointSeries
    arm_stamp_ns, arm_m : (K,), (K, P, 3)
        Points along the arm, from the shoulder to the hand.
    relative_stamp_ns, relative : (R,), (R, 3)
        The finger in {b}: mm, mm and degrees.
    block_size_m : (3,)
        Along the axes of the block's pose.
    """

    name: str
    start_ns: int
    hand: PoseSeries
    block: PoseSeries
    joints: JointSeries
    commanded: JointSeries
    arm_stamp_ns: IntArray
    arm_m: FloatArray
    relative_stamp_ns: IntArray
    relative: FloatArray
    block_size_m: FloatArray


def save_replay(replay: Replay, path: Path) -> None:
    """Write it to a file that ``rerun FILE`` opens.

    Raises
    ------
    NotFoundError
        rerun is not installed.
    """
    stream = _stream(replay)
    stream.save(str(path), default_blueprint=_blueprint())
    _log(stream, replay)
    stream.flush()
    stream.disconnect()


def open_replay(replay: Replay) -> None:
    """Open the viewer with it; it goes on when this program has ended.

    Raises
    ------
    NotFoundError
        rerun is not installed, or there is no display to open it on.
    """
    stream = _stream(replay)
    if sys.platform == "linux" and not any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY")):
        raise NotFoundError(f"the viewer needs a display, and there is none: {INSTEAD}")
    beside_python = sysconfig.get_path("scripts")  # where pip puts it; an environment that is not activated lacks it
    os.environ["PATH"] = os.pathsep.join([os.environ.get("PATH", os.defpath), beside_python])
    try:
        stream.spawn(default_blueprint=_blueprint())
        _log(stream, replay)
        stream.flush()
    except RuntimeError as error:
        raise NotFoundError(f"the viewer cannot be opened: {str(error).splitlines()[0]}: {INSTEAD}") from None


def _rerun() -> Any:
    """Import rerun, which is an extra."""
    try:
        import rerun  # noqa: PLC0415
    except ImportError:
        raise NotFoundError("rerun is not installed: pip install 'slidepipe[view]'") from None
    return rerun


def _stream(replay: Replay) -> Any:
    return _rerun().RecordingStream("slidepipe", recording_id=replay.name)


def _blueprint() -> Any:
    """The scene on the left, relative pose and joints on the right."""
    _rerun()
    from rerun import blueprint  # noqa: PLC0415

    plots = blueprint.Vertical(
        blueprint.TimeSeriesView(origin="relative", name="finger in {b}: mm and degrees"),
        blueprint.TimeSeriesView(origin="joints/measured", name="joints, rad"),
        blueprint.TimeSeriesView(origin="joints/error", name="joints less command, mrad"),
    )
    return blueprint.Blueprint(blueprint.Horizontal(blueprint.Spatial3DView(origin="world"), plots))


def _log(stream: Any, replay: Replay) -> None:
    rr = _rerun()
    stream.log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    half = [0.5 * replay.block_size_m]
    stream.log(BLOCK, rr.Boxes3D(half_sizes=half, colors=[CREAM], fill_mode="solid"), static=True)
    stream.log(HAND, rr.Points3D([[0.0, 0.0, 0.0]], radii=[0.006], colors=[RED]), static=True)
    stream.log(HAND, rr.TransformAxes3D(0.05), static=True)
    for path, poses in ((HAND, replay.hand), (BLOCK, replay.block)):
        columns = rr.Transform3D.columns(translation=poses.position_m, quaternion=poses.quaternion_xyzw)
        stream.send_columns(path, [_times(replay, poses.stamp_ns)], columns)
    lines = rr.LineStrips3D.columns(
        strips=replay.arm_m, radii=np.full(len(replay.arm_m), 0.012), colors=np.tile(GREY, (len(replay.arm_m), 1))
    )
    stream.send_columns(ARM, [_times(replay, replay.arm_stamp_ns)], lines)
    _log_plots(stream, replay)


def _log_plots(stream: Any, replay: Replay) -> None:
    rr = _rerun()
    for index, name in enumerate(("x_mm", "y_mm", "theta_deg")):
        times = [_times(replay, replay.relative_stamp_ns)]
        stream.send_columns(f"relative/{name}", times, rr.Scalars.columns(scalars=replay.relative[:, index]))
    times = [_times(replay, replay.joints.stamp_ns)]
    error = 1e3 * (replay.joints.position_rad - replay.commanded.position_rad)
    for joint, angle in enumerate(replay.joints.position_rad.T):
        stream.send_columns(f"joints/measured/j{joint + 1}", times, rr.Scalars.columns(scalars=angle))
        stream.send_columns(f"joints/error/j{joint + 1}", times, rr.Scalars.columns(scalars=error[:, joint]))


def _times(replay: Replay, stamp_ns: Any) -> Any:
    return _rerun().TimeColumn(TIMELINE, duration=1e-9 * (np.asarray(stamp_ns) - replay.start_ns))
