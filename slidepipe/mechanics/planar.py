"""Poses in the plane, and the plane in space.

A planar pose is ``[x, y, theta]`` in metres and radians. ``r_f_b`` is the pose of the finger {f} expressed in the
body frame {b}; the paper's world-frame offset is ``r_f = q_f - q_o = T(theta) r_f_b`` (eqs. 19 and 22).
"""

from dataclasses import dataclass

import numpy as np

from slidepipe.errors import InputError
from slidepipe.series import FloatArray


def rotation(theta: FloatArray | float) -> FloatArray:
    """T(theta) of eq. (22): turns planar vectors ``[x, y, theta]`` from {b} into {w}.

    Parameters
    ----------
    theta : (...)
        Angle of {b} in {w}, rad.

    Returns
    -------
    (..., 3, 3)
        Block rotation; the angle is left as it is.

    Examples
    --------
    >>> np.round(rotation(np.pi / 2) @ [1.0, 0.0, 0.5], 12)
    array([0. , 1. , 0.5])
    """
    theta = np.asarray(theta, dtype=float)
    c, s, zero, one = np.cos(theta), np.sin(theta), np.zeros_like(theta), np.ones_like(theta)
    return np.stack(
        [np.stack([c, -s, zero], -1), np.stack([s, c, zero], -1), np.stack([zero, zero, one], -1)],
        axis=-2,
    )


def finger_pose(q_o: FloatArray, r_f_b: FloatArray) -> FloatArray:
    """Pose of the finger in {w} from the object's pose and the relative pose in {b}: q_f = q_o + T(theta) r_f_b.

    Both are ``(..., 3)``.

    Examples
    --------
    >>> finger_pose(np.array([1.0, 0.0, np.pi / 2]), np.array([0.0, 2.0, 0.0])).round(9)
    array([-1.        ,  0.        ,  1.57079633])
    """
    q_o, r_f_b = np.asarray(q_o, dtype=float), np.asarray(r_f_b, dtype=float)
    return np.asarray(q_o + np.einsum("...ij,...j->...i", rotation(q_o[..., 2]), r_f_b))


def relative_pose(q_o: FloatArray, q_f: FloatArray) -> FloatArray:
    """Pose of the finger in {b}: the inverse of :func:`finger_pose`.

    Examples
    --------
    >>> relative_pose(np.array([1.0, 0.0, np.pi / 2]), np.array([-1.0, 1.0, np.pi / 2])).round(9)
    array([1., 2., 0.])
    """
    q_o, q_f = np.asarray(q_o, dtype=float), np.asarray(q_f, dtype=float)
    return np.asarray(np.einsum("...ji,...j->...i", rotation(q_o[..., 2]), q_f - q_o))


def object_pose(q_f: FloatArray, r_f_b: FloatArray) -> FloatArray:
    """Pose of the object in {w} whose finger is at ``q_f`` with relative pose ``r_f_b``.

    Examples
    --------
    >>> object_pose(np.array([0.0, 0.0, 0.0]), np.array([0.1, 0.0, 0.0])).round(9)
    array([-0.1,  0. ,  0. ])
    """
    q_f, r_f_b = np.asarray(q_f, dtype=float), np.asarray(r_f_b, dtype=float)
    theta = q_f[..., 2] - r_f_b[..., 2]
    return np.asarray(q_f - np.einsum("...ij,...j->...i", rotation(theta), r_f_b))


@dataclass(frozen=True, slots=True)
class MotionPlane:
    """The vertical plane of motion {w} inside the arm's base frame.

    Attributes
    ----------
    origin_m : (3,)
        Origin of {w} in the base frame.
    heading_rad : float
        Direction of the plane's x axis in the base frame's horizontal plane; y is up, so gravity acts along -y, and
        the normal is ``x cross y``.
    """

    origin_m: FloatArray
    heading_rad: float

    def __post_init__(self) -> None:
        if np.shape(self.origin_m) != (3,) or not np.all(np.isfinite(self.origin_m)):
            raise InputError(f"motion plane: origin_m must be three finite numbers, got {self.origin_m!r}")
        if not np.isfinite(self.heading_rad):
            raise InputError(f"motion plane: heading_rad must be a finite number, got {self.heading_rad!r}")

    @property
    def axes(self) -> FloatArray:
        """(3, 3) rotation whose columns are the plane's x, y and normal in the base frame."""
        c, s = np.cos(self.heading_rad), np.sin(self.heading_rad)
        return np.array([[c, 0.0, s], [s, 0.0, -c], [0.0, 1.0, 0.0]])

    def lift(self, pose: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Planar poses (..., 3) as positions (..., 3) and rotation matrices (..., 3, 3) in the base frame."""
        pose = np.asarray(pose, dtype=float)
        flat = np.concatenate([pose[..., :2], np.zeros_like(pose[..., :1])], axis=-1)
        return self.origin_m + flat @ self.axes.T, self.axes @ rotation(pose[..., 2])

    def project(self, position_m: FloatArray, matrix: FloatArray) -> FloatArray:
        """Planar poses (..., 3) of bodies in the base frame; the angle is that of the body's x axis, in (-pi, pi].

        Examples
        --------
        >>> plane = MotionPlane(np.array([0.5, 0.0, 0.4]), 1.0)
        >>> plane.project(*plane.lift(np.array([0.1, 0.2, 0.3]))).round(9)
        array([0.1, 0.2, 0.3])
        """
        local = (np.asarray(position_m, dtype=float) - self.origin_m) @ self.axes
        x_axis = np.asarray(matrix, dtype=float)[..., :, 0] @ self.axes
        angle = np.arctan2(x_axis[..., 1], x_axis[..., 0])
        return np.concatenate([local[..., :2], angle[..., None]], axis=-1)
