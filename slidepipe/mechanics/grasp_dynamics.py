"""Sliding dynamics of a grasp of n fingers, Section VI-B: forward, eq. (21), and inverse, with the derivatives of (22).

Every finger slides with its own velocity. Where some stick while others slide, friction is no function of the
velocities and eq. (21) does not hold: :mod:`slidepipe.mechanics.slip` solves that case.
"""

from dataclasses import dataclass

import numpy as np

from slidepipe.errors import InputError
from slidepipe.mechanics.dynamics import Block, about_com, finger_acceleration, finger_velocity
from slidepipe.mechanics.grasp import Grasp, carried, finite, in_body, in_world
from slidepipe.mechanics.norm_kernel import frictions
from slidepipe.series import FloatArray


@dataclass(frozen=True, slots=True)
class GraspSliding:
    """Object and fingers while every finger slides; in {w} unless named ``_b``, leading axes as they were given.

    Attributes
    ----------
    dv : (..., n, 3)
        Sliding velocities, eq. (18).
    f : (..., n, 3)
        Friction on the object at the contacts, eq. (14), N and N m.
    ddq_o : (..., 3)
        Acceleration of the object, eq. (20).
    dq_f, ddq_f : (..., n, 3)
        Velocities and accelerations of the fingers.
    ddr_f : (..., n, 3)
        Relative accelerations ``ddq_f - ddq_o``, eqs. (19) and (21).
    dr_f_b, ddr_f_b : (..., n, 3)
        First and second derivative of the relative poses in {b}, eq. (22).
    """

    dv: FloatArray
    f: FloatArray
    ddq_o: FloatArray
    dq_f: FloatArray
    ddq_f: FloatArray
    ddr_f: FloatArray
    dr_f_b: FloatArray
    ddr_f_b: FloatArray


def forward_dynamics(
    block: Block,
    grasp: Grasp,
    *,
    theta: FloatArray | float,
    dq_o: FloatArray,
    dq_f: FloatArray,
    ddq_f: FloatArray,
    r_f_b: FloatArray | None = None,
    f_N: FloatArray | None = None,
) -> GraspSliding:
    """Relative accelerations of fingers that move as given, eq. (21); vectorised over leading axes, such as time.

    Parameters
    ----------
    theta : (...)
        Angle of the object, rad.
    dq_o : (..., 3)
        Its velocity in {w}.
    dq_f, ddq_f : (..., n, 3)
        Velocities and accelerations of the fingers in {w}; every finger must slide.
    r_f_b : (..., n, 3), optional
        Relative poses in {b}; those of the grasp if not given.
    f_N : (..., n), optional
        Normal forces f_Ni(t), N; those of the grasp if not given.
    """
    theta, dq_o = finite("sliding: theta", theta), finite("sliding: dq_o", dq_o, (3,))
    dq_f, ddq_f = (
        finite(f"sliding: {name}", value, (len(grasp), 3)) for name, value in (("dq_f", dq_f), ("ddq_f", ddq_f))
    )
    r_b = _places(grasp, r_f_b)
    r_f = in_world(theta, r_b)
    dv = dq_f - carried(dq_o[..., None, :], r_f)
    f = _friction(grasp, grasp.axes_over(f_N), dv)
    ddq_o = (np.sum(about_com(f, r_f), axis=-2) + block.g) / block.M
    ddr_f, dr_f_b = ddq_f - ddq_o[..., None, :], in_body(theta, dv)
    ddr_f_b = _seen_from_body(theta, dq_o[..., 2], ddq_o[..., 2], r_b=r_b, dr_b=dr_f_b, ddr_f=ddr_f)
    return GraspSliding(dv, f, ddq_o, _like(dq_f, ddr_f), _like(ddq_f, ddr_f), ddr_f, dr_f_b, ddr_f_b)


def inverse_dynamics(
    block: Block,
    grasp: Grasp,
    *,
    theta: FloatArray | float,
    dq_o: FloatArray,
    dr_f_b: FloatArray,
    ddr_f_b: FloatArray,
    r_f_b: FloatArray | None = None,
    f_N: FloatArray | None = None,
) -> GraspSliding:
    """Motion of the fingers that makes them slide as wanted: eqs. (20) and (22), the inverse of eq. (21).

    Parameters
    ----------
    theta, dq_o, r_f_b, f_N
        As in :func:`forward_dynamics`.
    dr_f_b, ddr_f_b : (..., n, 3) or (..., 1, 3) or (3,)
        Relative velocities and accelerations in {b}: each finger's, or one for fingers that move alike. Where a
        velocity is zero the slide begins: friction then acts along the acceleration, as Section VII assumes.

    Examples
    --------
    >>> from slidepipe.mechanics.grasp import Contact
    >>> from slidepipe.mechanics.limit_surface import SoftFinger
    >>> finger = SoftFinger(mu=0.5, f_N=2.0, a=0.02, c=0.6)
    >>> grasp = Grasp([Contact(finger, [0.03, 0.0, 0.0]), Contact(finger, [-0.03, 0.0, 0.0])])
    >>> block = Block(length=0.1, width=0.06, m=0.1)
    >>> found = inverse_dynamics(
    ...     block, grasp, theta=0.0, dq_o=[0.0, 0.0, 0.0], dr_f_b=[0.0, 0.0, 0.0], ddr_f_b=[1.0, 0.0, 0.0]
    ... )
    >>> found.ddq_o.round(9), found.ddq_f[0].round(9)
    (array([20.  , -9.81,  0.  ]), array([21.  , -9.81,  0.  ]))
    """
    theta, dq_o = finite("sliding: theta", theta), finite("sliding: dq_o", dq_o, (3,))
    r_b, dr_b, ddr_b = _each(grasp, theta, dq_o, r_b=_places(grasp, r_f_b), relative=(dr_f_b, ddr_f_b))
    shape, lead = r_b.shape, r_b.shape[:-2]
    along = np.where(np.any(dr_b != 0.0, axis=-1, keepdims=True), dr_b, ddr_b)
    f = in_world(theta, _friction(grasp, grasp.axes_over(f_N), along))
    ddq_o = (np.sum(about_com(f, in_world(theta, r_b)), axis=-2) + block.g) / block.M
    theta, dq_o = np.broadcast_to(theta, lead), np.broadcast_to(dq_o, (*lead, 3))
    dq_f, ddq_f = np.empty(shape), np.empty(shape)
    for i in range(len(grasp)):
        r, dr, ddr = r_b[..., i, :], dr_b[..., i, :], ddr_b[..., i, :]
        dq_f[..., i, :] = finger_velocity(theta, dq_o, r, dr)
        ddq_f[..., i, :] = finger_acceleration(theta, dq_o[..., 2], ddq_o, r_f_b=r, dr_f_b=dr, ddr_f_b=ddr)
    return GraspSliding(in_world(theta, dr_b), f, ddq_o, dq_f, ddq_f, ddq_f - ddq_o[..., None, :], dr_b, ddr_b)


def _places(grasp: Grasp, r_f_b: FloatArray | None) -> FloatArray:
    return grasp.r_f_b if r_f_b is None else finite("sliding: r_f_b", r_f_b, (len(grasp), 3))


def _each(
    grasp: Grasp, theta: FloatArray, dq_o: FloatArray, *, r_b: FloatArray, relative: tuple[FloatArray, FloatArray]
) -> tuple[FloatArray, ...]:
    """Relative poses, velocities and accelerations (..., n, 3): those of fingers that move alike, for each."""
    dr_b, ddr_b = (
        np.atleast_2d(finite(f"sliding: {name}", value, (3,)))
        for name, value in zip(("dr_f_b", "ddr_f_b"), relative, strict=True)
    )
    try:
        lead = np.broadcast_shapes(theta.shape, dq_o.shape[:-1], *(value.shape[:-2] for value in (r_b, dr_b, ddr_b)))
        return tuple(np.broadcast_to(value, (*lead, len(grasp), 3)) for value in (r_b, dr_b, ddr_b))
    except ValueError:
        raise InputError(
            f"sliding: dr_f_b and ddr_f_b must be one or {len(grasp)} rows of three for each instant of theta, dq_o "
            f"and r_f_b, got {dr_b.shape} and {ddr_b.shape}"
        ) from None


def _like(values: FloatArray, pattern: FloatArray) -> FloatArray:
    return np.broadcast_to(values, pattern.shape)


def _friction(grasp: Grasp, semi_axes: FloatArray, dv: FloatArray) -> FloatArray:
    """Gamma of eq. (14) for every contact; an error where one does not slide."""
    scaled = semi_axes * dv
    still = np.argwhere(~np.any(scaled != 0.0, axis=-1))
    if len(still):
        raise InputError(
            f"sliding: finger {int(still[0][-1])} does not slide: eq. (21) needs the sliding velocity of every finger; "
            "slip.friction_step allows some to stick"
        )
    share, shapes, n = np.empty(scaled.shape), grasp.shapes, len(grasp)
    frictions(shapes.of, shapes.curves, scaled.reshape(-1, n, 3), share.reshape(-1, n, 3))
    return np.asarray(semi_axes * share)


def _seen_from_body(
    theta: FloatArray, omega: FloatArray, alpha: FloatArray, *, r_b: FloatArray, dr_b: FloatArray, ddr_f: FloatArray
) -> FloatArray:
    """Second derivative of eq. (22), solved for the relative acceleration in {b}."""
    omega, alpha = np.asarray(omega)[..., None, None], np.asarray(alpha)[..., None, None]
    result = in_body(theta, ddr_f)
    turning = alpha * _turned(r_b) + 2.0 * omega * _turned(dr_b) - omega**2 * r_b[..., :2]
    result[..., :2] -= turning
    return result


def _turned(v: FloatArray) -> FloatArray:
    """The planar parts of (..., 3), turned by +90 degrees."""
    return np.stack([-v[..., 1], v[..., 0]], axis=-1)
