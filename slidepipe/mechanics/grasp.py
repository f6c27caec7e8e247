"""Grasps of any number of fingers, Sections IV to VI: contacts on the object and what their friction adds up to."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol, cast

import numpy as np

from slidepipe.errors import InputError
from slidepipe.mechanics.dynamics import about_com
from slidepipe.mechanics.norm_kernel import powers
from slidepipe.mechanics.patch_curve import patch_curve
from slidepipe.mechanics.planar import rotation
from slidepipe.mechanics.pressure_patch import PressurePatch
from slidepipe.series import FloatArray, IntArray


class Finger(Protocol):
    """A contact's friction: an ellipsoid, eq. (10), unless it is a PressurePatch."""

    @property
    def semi_axes(self) -> FloatArray:
        """(3,) s_1, s_2 = s_1 and s_3 in N, N and N m; the third is zero for a point contact."""
        ...


@dataclass(frozen=True, slots=True)
class Shapes:
    """Which contacts are no ellipsoids, for compiled kernels.

    Attributes
    ----------
    of : (n,) int
        Index of each contact's curve, -1 for an ellipsoid.
    curves : (S, N + 1, 3)
        See :mod:`slidepipe.mechanics.curve_kernel`.
    """

    of: IntArray
    curves: FloatArray

    @classmethod
    def among(cls, fingers: Sequence[object]) -> "Shapes":
        """Shapes of fingers of any kind; equal pressures share a curve."""
        exponents = [finger.k if isinstance(finger, PressurePatch) else None for finger in fingers]
        some = sorted({k for k in exponents if k is not None})
        curves = np.stack([patch_curve(k) for k in some]) if some else np.empty((0, 2, 3))
        return cls(np.array([-1 if k is None else some.index(k) for k in exponents]), curves)


@dataclass(frozen=True, slots=True)
class Contact:
    """A finger and where it touches the object.

    Attributes
    ----------
    finger : Finger
        A PointContact, a SoftFinger or a PressurePatch.
    r_f_b : (3,)
        Pose of the finger in {b}, m and rad.
    """

    finger: Finger
    r_f_b: FloatArray

    def __post_init__(self) -> None:
        s = np.asarray(getattr(self.finger, "semi_axes", np.full(3, np.nan)), dtype=float)
        if s.shape != (3,) or not (np.all(np.isfinite(s)) and s[0] > 0.0 and s[1] == s[0] and s[2] >= 0.0):
            raise InputError(
                f"contact: finger must have semi_axes (s, s, s_3) with s > 0 and s_3 >= 0, got {self.finger!r}"
            )
        r = np.array(self.r_f_b, dtype=float)
        if r.shape != (3,) or not np.all(np.isfinite(r)):
            raise InputError(f"contact: r_f_b must be three finite numbers, got {self.r_f_b!r}")
        r.setflags(write=False)
        object.__setattr__(self, "r_f_b", r)


@dataclass(frozen=True, slots=True)
class Grasp:
    """One or more contacts on one object.

    Examples
    --------
    >>> from slidepipe.mechanics.limit_surface import SoftFinger
    >>> finger = SoftFinger(mu=0.5, f_N=2.0, a=0.02, c=0.6)
    >>> grasp = Grasp([Contact(finger, [0.03, 0.0, 0.0]), Contact(finger, [-0.03, 0.0, 0.0])])
    >>> float(grasp.support([1.0, 0.0, 0.0]))
    2.0
    """

    contacts: Sequence[Contact]

    def __post_init__(self) -> None:
        contacts = tuple(self.contacts)
        if not contacts:
            raise InputError("grasp: contacts must be one or more, got none")
        for contact in contacts:
            if not isinstance(contact, Contact):
                raise InputError(f"grasp: contacts must be Contact, got {contact!r}")
        object.__setattr__(self, "contacts", contacts)

    def __len__(self) -> int:
        return len(self.contacts)

    @property
    def r_f_b(self) -> FloatArray:
        """(n, 3) poses of the fingers in {b}."""
        return np.stack([contact.r_f_b for contact in self.contacts])

    @property
    def semi_axes(self) -> FloatArray:
        """(n, 3) semi-axes of the fingers' ellipsoids; the largest forces and moments of pressure patches."""
        return np.stack([np.asarray(contact.finger.semi_axes, dtype=float) for contact in self.contacts])

    @property
    def shapes(self) -> Shapes:
        """Which contacts are pressure patches."""
        return Shapes.among([contact.finger for contact in self.contacts])

    def with_normal_forces(self, f_N: FloatArray) -> "Grasp":
        """The same grasp with normal forces ``f_N`` (n,), N: one sample of f_Ni(t)."""
        f_N = np.asarray(f_N, dtype=float)
        if f_N.shape != (len(self),):
            raise InputError(f"grasp: f_N must be {len(self)} normal forces, one a contact, got shape {f_N.shape}")
        contacts = []
        for contact, force in zip(self.contacts, f_N, strict=True):
            finger = cast("Any", contact.finger)
            contacts.append(Contact(replace(finger, f_N=float(force)), contact.r_f_b))
        return Grasp(contacts)

    def axes_over(self, f_N: FloatArray | None) -> FloatArray:
        """Semi-axes (..., n, 3) under normal forces ``f_N`` (..., n), N, such as over time; None keeps the own."""
        if f_N is None:
            return self.semi_axes
        f_N = np.asarray(f_N, dtype=float)
        if f_N.ndim == 0 or f_N.shape[-1] != len(self):
            raise InputError(f"grasp: f_N must be (..., {len(self)}), one for each contact, got shape {f_N.shape}")
        rows = [self.with_normal_forces(row).semi_axes for row in f_N.reshape(-1, len(self))]
        return np.reshape(np.array(rows), (*f_N.shape, 3))

    def wrench(self, f: FloatArray) -> FloatArray:
        """Sum of G_i f_i of eq. (17) about the CoM, (..., 3), from contact wrenches ``f`` (..., n, 3); all in {b}."""
        return np.asarray(np.sum(about_com(f, self.r_f_b), axis=-2))

    def slip(self, dv_b: FloatArray) -> FloatArray:
        """Sliding velocities in {b} of fingers that move as one, (..., n, 3), from ``dv_b`` (..., 3) at the CoM."""
        return carried(np.asarray(dv_b, dtype=float)[..., None, :], self.r_f_b)

    def support(self, dv_b: FloatArray) -> FloatArray:
        """Support function of the grasp limit surface of eq. (16): the most power, W, that friction takes at ``dv_b``.

        The largest ``w . dv_b`` of all wrenches w about the CoM that the contacts can apply: ``sum_i h_i(G_i^T dv_b)``,
        with ``h_i = |S_i G_i^T dv_b|`` for an ellipsoid.
        """
        z = self.semi_axes * self.slip(dv_b)
        each, shapes = np.empty(z.shape[:-1]), self.shapes
        powers(shapes.of, shapes.curves, z.reshape(-1, len(self), 3), each.reshape(-1, len(self)))
        return np.asarray(np.sum(each, axis=-1))


def carried(velocity: FloatArray, r_f: FloatArray) -> FloatArray:
    """G^T v of eq. (18), (..., 3): the velocity at ``r_f`` of a body whose CoM has ``velocity``; one frame for all.

    Examples
    --------
    >>> carried(np.array([1.0, 0.0, 2.0]), np.array([0.5, 0.0, 0.0]))
    array([1., 1., 2.])
    """
    velocity, r_f = np.broadcast_arrays(np.asarray(velocity, dtype=float), np.asarray(r_f, dtype=float))
    v, omega = velocity[..., :2], velocity[..., 2:]
    return np.concatenate([v + omega * np.stack([-r_f[..., 1], r_f[..., 0]], axis=-1), omega], axis=-1)


def in_world(theta: FloatArray | float, vectors_b: FloatArray) -> FloatArray:
    """Contacts' vectors (..., n, 3) turned from {b} into {w}: T(theta) of eq. (22), theta (...)."""
    return np.asarray(np.einsum("...ij,...nj->...ni", rotation(theta), np.asarray(vectors_b, dtype=float)))


def in_body(theta: FloatArray | float, vectors: FloatArray) -> FloatArray:
    """The inverse of :func:`in_world`."""
    return np.asarray(np.einsum("...ji,...nj->...ni", rotation(theta), np.asarray(vectors, dtype=float)))


def single(what: str, value: FloatArray | float, shape: tuple[int, ...]) -> FloatArray:
    """``value`` as an array of finite numbers of exactly this shape; else an error that names ``what``."""
    array = np.asarray(value, dtype=float)
    if array.shape != shape:
        raise InputError(f"{what} must have shape {shape}, got {array.shape}")
    return finite(what, array)


def finite(what: str, value: FloatArray | float, shape: tuple[int, ...] | None = None) -> FloatArray:
    """``value`` as an array of finite numbers whose last axes are ``shape``; else an error that names ``what``."""
    array = np.asarray(value, dtype=float)
    if shape is not None and array.shape[array.ndim - len(shape) :] != shape:
        raise InputError(f"{what} must have shape (..., {', '.join(map(str, shape))}), got {array.shape}")
    if not np.all(np.isfinite(array)):
        raise InputError(f"{what} must be finite numbers, got {float(array[~np.isfinite(array)][0])!r}")
    return array
