"""Sticking and sliding dynamics of a pinched object, Section VI, for fingers that move alike.

The pinch is one soft finger that carries the sum of the normal forces (Section VIII). Gravity acts along -y of {w}.
"""

from dataclasses import dataclass

import numpy as np

from slidepipe.errors import InputError
from slidepipe.mechanics.limit_surface import SoftFinger
from slidepipe.mechanics.planar import rotation
from slidepipe.series import FloatArray

GRAVITY = 9.81


@dataclass(frozen=True, slots=True)
class Block:
    """A rectangular laminar object: ``length`` along x_b, ``width`` along y_b, m; ``m`` in kg; {b} at the CoM."""

    length: float
    width: float
    m: float

    def __post_init__(self) -> None:
        for name in ("length", "width", "m"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0.0):
                raise InputError(f"block: {name} must be a positive number, got {value!r}")

    @property
    def inertia(self) -> float:
        """Moment of inertia about the CoM, kg m^2.

        Examples
        --------
        >>> round(Block(length=0.1, width=0.06, m=0.023).inertia, 9)
        2.6067e-05
        """
        return self.m * (self.length**2 + self.width**2) / 12.0

    @property
    def M(self) -> FloatArray:
        """(3,) diagonal of the mass matrix of eq. (17)."""
        return np.array([self.m, self.m, self.inertia])

    @property
    def g(self) -> FloatArray:
        """(3,) wrench of gravity about the CoM in {w}, N and N m."""
        return np.array([0.0, -self.m * GRAVITY, 0.0])


def about_com(f: FloatArray, r_f: FloatArray) -> FloatArray:
    """G f of eq. (15): a contact wrench ``f`` at offset ``r_f`` from the CoM, taken about the CoM; one frame for all.

    Examples
    --------
    >>> about_com(np.array([0.0, 2.0, 0.1]), np.array([0.5, 0.0, 0.0]))
    array([0. , 2. , 1.1])
    """
    f, r_f = np.broadcast_arrays(np.asarray(f, dtype=float), np.asarray(r_f, dtype=float))
    moment = f[..., 2] + r_f[..., 0] * f[..., 1] - r_f[..., 1] * f[..., 0]
    return np.concatenate([f[..., :2], moment[..., None]], axis=-1)


def sliding_acceleration(
    block: Block, finger: SoftFinger, theta: FloatArray | float, r_f_b: FloatArray, dv_b: FloatArray
) -> FloatArray:
    """Acceleration of the object in {w} while the finger slides on it, eq. (20).

    Parameters
    ----------
    theta : (...)
        Angle of the object, rad.
    r_f_b : (..., 3)
        Relative pose of the finger in {b}, m and rad.
    dv_b : (..., 3)
        Sliding velocity in {b}: the time derivative of ``r_f_b`` (eq. 18 with eq. 22), or a multiple of it.

    Returns
    -------
    (..., 3)
        m/s^2 and rad/s^2.
    """
    wrench_b = about_com(finger.friction(dv_b), r_f_b)
    wrench = np.einsum("...ij,...j->...i", rotation(theta), wrench_b) + block.g
    return np.asarray(wrench / block.M)


def finger_acceleration(
    theta: FloatArray,
    omega: FloatArray,
    ddq_o: FloatArray,
    *,
    r_f_b: FloatArray,
    dr_f_b: FloatArray,
    ddr_f_b: FloatArray,
) -> FloatArray:
    """Acceleration of the finger in {w} that goes with a relative motion: the derivatives of eq. (22) in eq. (19).

    Parameters
    ----------
    theta, omega : (T,)
        Angle and angular velocity of the object.
    ddq_o, r_f_b, dr_f_b, ddr_f_b : (T, 3)
        Acceleration of the object in {w}; relative pose, velocity and acceleration in {b}.

    Returns
    -------
    (T, 3)
        m/s^2 and rad/s^2.
    """
    omega, alpha = np.asarray(omega)[..., None], np.asarray(ddq_o)[..., 2:3]
    linear = [np.asarray(term)[..., :2] for term in (r_f_b, dr_f_b, ddr_f_b)]
    in_body = linear[2] + 2.0 * omega * _turned(linear[1]) + alpha * _turned(linear[0]) - omega**2 * linear[0]
    with_angle = np.concatenate([in_body, np.asarray(ddr_f_b)[..., 2:3]], axis=-1)
    return np.asarray(ddq_o + np.einsum("...ij,...j->...i", rotation(theta), with_angle))


def finger_velocity(theta: FloatArray, dq_o: FloatArray, r_f_b: FloatArray, dr_f_b: FloatArray) -> FloatArray:
    """Velocity of the finger in {w}, (T, 3): the first derivative of eq. (22) added to that of the object."""
    omega = np.asarray(dq_o)[..., 2:3]
    in_body = np.asarray(dr_f_b)[..., :2] + omega * _turned(np.asarray(r_f_b)[..., :2])
    with_angle = np.concatenate([in_body, np.asarray(dr_f_b)[..., 2:3]], axis=-1)
    return np.asarray(dq_o + np.einsum("...ij,...j->...i", rotation(theta), with_angle))


def sticking_load(
    block: Block, finger: SoftFinger, theta: FloatArray, ddq_o: FloatArray, r_f_b: FloatArray
) -> FloatArray:
    """How much of the friction an object that moves with the finger needs, eq. (17) solved for f; sticks below one.

    Parameters
    ----------
    theta : (...)
        Angle of the object, rad.
    ddq_o : (..., 3)
        Acceleration of its CoM in {w}.
    r_f_b : (..., 3)
        Relative pose of the finger in {b}.

    Returns
    -------
    (...)
        ``sqrt(f^T A f)``.
    """
    wrench = np.einsum("...ji,...j->...i", rotation(theta), block.M * np.asarray(ddq_o) - block.g)
    return finger.load(about_com(wrench, -np.asarray(r_f_b)))


def _turned(v: FloatArray) -> FloatArray:
    """Planar vectors (..., 2) turned by +90 degrees."""
    return np.stack([-v[..., 1], v[..., 0]], axis=-1)
