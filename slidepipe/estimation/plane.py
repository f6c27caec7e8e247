"""Poses in space to poses in the motion plane, with what does not fit into the plane."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from slidepipe.errors import InputError
from slidepipe.mechanics.planar import MotionPlane
from slidepipe.series import FloatArray, IntArray, PoseSeries


@dataclass(frozen=True, slots=True)
class PlanarBody:
    """One body in the plane {w}, at the frames where it was tracked.

    Attributes
    ----------
    sequence : (T,) int
        Frame numbers.
    pose : (T, 3)
        ``[x, y, theta]`` in {w}, m and rad; the angle runs on past pi.
    distance_m : (T,)
        Distance from the plane along its normal.
    tilt_rad : (T,)
        Angle between the body's z axis and the plane's normal.
    """

    sequence: IntArray
    pose: FloatArray
    distance_m: FloatArray
    tilt_rad: FloatArray


def to_plane(name: str, series: PoseSeries, plane: MotionPlane) -> PlanarBody:
    """Project one body into the plane and unwrap its angle over the tracked frames.

    Raises
    ------
    InputError
        Numbers that are not finite, quaternions that are not unit, frames out of order, lengths that differ.
    """
    _check(name, series)
    matrix = Rotation.from_quat(series.quaternion_xyzw).as_matrix()
    pose = plane.project(series.position_m, matrix)
    pose[:, 2] = np.unwrap(pose[:, 2])
    normal = plane.axes[:, 2]
    return PlanarBody(
        sequence=series.sequence,
        pose=pose,
        distance_m=(series.position_m - plane.origin_m) @ normal,
        tilt_rad=np.arccos(np.clip(matrix[:, :, 2] @ normal, -1.0, 1.0)),
    )


def _check(name: str, series: PoseSeries) -> None:
    count = len(series.sequence)
    if series.position_m.shape != (count, 3) or series.quaternion_xyzw.shape != (count, 4):
        raise InputError(
            f"{name} poses: positions and quaternions must be ({count}, 3) and ({count}, 4) to go with {count} frame "
            f"numbers, got {series.position_m.shape} and {series.quaternion_xyzw.shape}"
        )
    for what, values in (("position_m", series.position_m), ("quaternion_xyzw", series.quaternion_xyzw)):
        bad = np.flatnonzero(~np.isfinite(values).all(axis=1))
        if len(bad):
            raise InputError(f"{name} poses: {what} of frame {series.sequence[bad[0]]} is not finite")
    size = np.linalg.norm(series.quaternion_xyzw, axis=1)
    off = np.flatnonzero(np.abs(size - 1.0) > 1e-3)
    if len(off):
        raise InputError(
            f"{name} poses: quaternion_xyzw of frame {series.sequence[off[0]]} has size {size[off[0]]:.6g}, must be 1"
        )
    back = np.flatnonzero(np.diff(series.sequence) <= 0)
    if len(back):
        raise InputError(f"{name} poses: frame numbers go back after frame {series.sequence[back[0]]}")
