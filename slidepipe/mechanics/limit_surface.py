"""Limit surfaces of one contact, Section V: the interface, the point contact and the soft finger's ellipsoid.

A limit surface bounds the wrenches ``f = [f_x, f_y, m_z]`` that a contact's friction can exert on the object. Wrenches
and twists ``dv`` are in one frame, about the contact; ``dv`` is the finger's velocity relative to the object, so that
``f . dv >= 0``. The exact surface of a circular patch is in :mod:`slidepipe.mechanics.pressure_patch`, that of a whole
grasp in :mod:`slidepipe.mechanics.grasp_surface`.
"""

from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from slidepipe.errors import InputError
from slidepipe.series import FloatArray


class LimitSurface(Protocol):
    """What every model of a contact's friction answers; all arrays are (..., 3) or (...)."""

    def friction(self, dv: FloatArray) -> FloatArray:
        """Friction wrench (..., 3), N and N m, of a twist ``dv`` that is not zero: Gamma of eq. (14)."""
        ...

    def direction(self, f: FloatArray) -> FloatArray:
        """Twist (..., 3) of a contact at its limit under ``f``, or any multiple of it: the surface's normal, eq. (11).

        Of unit Euclidean length in m/s and rad/s, since lambda of eq. (11) stays open.
        """
        ...

    def load(self, f: FloatArray) -> FloatArray:
        """The gauge (...) of the surface: the contact sticks below one, and ``f / load`` is on the surface."""
        ...

    def support(self, dv: FloatArray) -> FloatArray:
        """The most of ``f . dv`` (...) over the surface: the power, W, that friction dissipates at ``dv``."""
        ...


@dataclass(frozen=True, slots=True)
class PointContact:
    """A hard finger, Section V-A: Coulomb's circle without moment.

    Its surface is a flat disc in wrench space. Where the answer is not unique, the most symmetric one is given:
    spinning on the spot meets no force (any within the circle has the same power, none), and a wrench on the circle
    slides without turning (it may also turn, at any speed).

    Attributes
    ----------
    mu : float
        Coefficient of friction.
    f_N : float
        Normal force, N.
    """

    mu: float
    f_N: float

    def __post_init__(self) -> None:
        positive("point contact", self, "mu", "f_N")

    @property
    def semi_axes(self) -> FloatArray:
        """(3,) ``mu f_N`` twice and 0: the soft finger's ellipsoid with no patch."""
        return np.array([self.mu * self.f_N, self.mu * self.f_N, 0.0])

    def friction(self, dv: FloatArray) -> FloatArray:
        """Friction wrench (..., 3) along the sliding velocity; zero where the contact spins on the spot.

        Examples
        --------
        >>> PointContact(mu=0.5, f_N=2.0).friction(np.array([[3.0, 4.0, 9.0], [0.0, 0.0, 9.0]]))
        array([[0.6, 0.8, 0. ],
               [0. , 0. , 0. ]])
        """
        dv = moving("point contact", dv)
        return self.mu * self.f_N * _linear_direction(dv)

    def direction(self, f: FloatArray) -> FloatArray:
        """Unit twist (..., 3) parallel to the force; a wrench with a moment is on no multiple of the surface."""
        f = loaded("point contact", f)
        if np.any(f[..., 2] != 0.0):
            raise InputError("point contact: a wrench with a moment cannot be scaled to the surface, m_z must be 0")
        return _linear_direction(f)

    def load(self, f: FloatArray) -> FloatArray:
        """Share (...) of the friction in use; infinite for any moment other than zero.

        Examples
        --------
        >>> PointContact(mu=0.5, f_N=2.0).load(np.array([[0.3, 0.4, 0.0], [0.3, 0.4, 1e-9]]))
        array([0.5, inf])
        """
        f = triples("point contact", "f", f)
        share = np.hypot(f[..., 0], f[..., 1]) / (self.mu * self.f_N)
        return np.asarray(np.where(f[..., 2] == 0.0, share, np.inf))

    def support(self, dv: FloatArray) -> FloatArray:
        """Power (...) of friction, W."""
        dv = triples("point contact", "dv", dv)
        return np.asarray(self.mu * self.f_N * np.hypot(dv[..., 0], dv[..., 1]))


@dataclass(frozen=True, slots=True)
class SoftFinger:
    """One soft-finger contact with isotropic friction, eqs. (10) to (14).

    Attributes
    ----------
    mu : float
        Coefficient of friction.
    f_N : float
        Normal force, N. For a pinch whose fingers move alike this is the sum over the fingers.
    a : float
        Radius of the contact patch, m.
    c : float
        Constant of the pressure distribution: the largest moment is ``a c mu f_N``.
    """

    mu: float
    f_N: float
    a: float
    c: float

    def __post_init__(self) -> None:
        positive("soft finger", self, "mu", "f_N", "a", "c")

    @classmethod
    def growing(cls, mu: float, f_N: float, delta: float, gamma: float, c: float) -> "GrowingFinger":
        """A finger whose patch grows with the normal force, ``a = delta f_N**gamma``.

        Examples
        --------
        >>> SoftFinger.growing(mu=0.5, f_N=8.0, delta=0.01, gamma=1 / 3, c=0.6).a
        0.02
        """
        return GrowingFinger(mu=mu, f_N=f_N, c=c, delta=delta, gamma=gamma)

    @property
    def semi_axes(self) -> FloatArray:
        """(3,) the ellipsoid's semi-axes s_1, s_2, s_3 in N, N and N m; ``A = diag(s**-2)`` of eq. (10)."""
        force = self.mu * self.f_N
        return np.array([force, force, self.a * self.c * force])

    def friction(self, dv: FloatArray) -> FloatArray:
        """Friction wrench on the object for a sliding velocity of the finger on it: Gamma of eq. (14).

        Parameters
        ----------
        dv : (..., 3)
            Relative velocity of the finger, m/s and rad/s, or any positive multiple of it; not zero.

        Returns
        -------
        (..., 3)
            ``[f_x, f_y, m_z]`` in N and N m, in the frame of ``dv``, about the contact.

        Examples
        --------
        >>> SoftFinger(mu=0.5, f_N=2.0, a=0.02, c=0.6).friction(np.array([3.0, 4.0, 0.0]))
        array([0.6, 0.8, 0. ])
        """
        scaled = self.semi_axes * np.asarray(dv, dtype=float)
        size = np.linalg.norm(scaled, axis=-1, keepdims=True)
        if not np.all(size > 0.0):
            raise InputError("soft finger: the friction of a contact that does not slide is not given by eq. (14)")
        return np.asarray(self.semi_axes * scaled / size)

    def load(self, f: FloatArray) -> FloatArray:
        """How much of its friction a contact uses: ``sqrt(f^T A f)`` of eq. (10); it sticks below one.

        Examples
        --------
        >>> float(SoftFinger(mu=0.5, f_N=2.0, a=0.02, c=0.6).load(np.array([0.3, 0.4, 0.0])))
        0.5
        """
        return np.asarray(np.linalg.norm(np.asarray(f, dtype=float) / self.semi_axes, axis=-1))

    def direction(self, f: FloatArray) -> FloatArray:
        """Unit twist (..., 3) of a wrench on the surface, or of any multiple of it: A f of eq. (11).

        Examples
        --------
        >>> finger = SoftFinger(mu=0.5, f_N=2.0, a=0.02, c=0.6)
        >>> finger.direction(finger.friction(np.array([0.3, 0.4, 0.0])))
        array([0.6, 0.8, 0. ])
        """
        scaled = loaded("soft finger", f) / self.semi_axes
        normal = scaled / np.linalg.norm(scaled, axis=-1, keepdims=True) / self.semi_axes
        return np.asarray(normal / np.linalg.norm(normal, axis=-1, keepdims=True))

    def support(self, dv: FloatArray) -> FloatArray:
        """Power (...) of friction, W: ``sqrt(dv^T A^-1 dv)``, twice lambda of eq. (13)."""
        return np.asarray(np.linalg.norm(self.semi_axes * triples("soft finger", "dv", dv), axis=-1))


@dataclass(frozen=True, slots=True)
class GrowingFinger(SoftFinger):
    """A soft finger whose patch follows its normal force: ``a = delta f_N**gamma`` (Xydas and Kao).

    ``dataclasses.replace`` with another ``f_N`` gives the patch that belongs to it. Made by :meth:`SoftFinger.growing`.

    Attributes
    ----------
    delta : float
        Radius of the patch under 1 N, m.
    gamma : float
        Exponent: 1/3 for a linear elastic tip (Hertz), 0 for a patch that does not grow.
    """

    a: float = field(init=False)
    delta: float
    gamma: float

    def __post_init__(self) -> None:
        positive("soft finger", self, "f_N", "delta")
        if not (np.isfinite(self.gamma) and self.gamma >= 0.0):
            raise InputError(f"soft finger: gamma must be a number not below 0, got {self.gamma!r}")
        object.__setattr__(self, "a", float(self.delta * self.f_N**self.gamma))
        SoftFinger.__post_init__(self)  # slots make a new class, which a bare super() does not know


def positive(what: str, owner: object, *names: str) -> None:
    """Raise :class:`InputError` unless the named attributes of ``owner`` are finite and above zero."""
    for name in names:
        value = getattr(owner, name)
        if not (np.isfinite(value) and value > 0.0):
            raise InputError(f"{what}: {name} must be a positive number, got {value!r}")


def moving(what: str, dv: FloatArray) -> FloatArray:
    """Twists (..., 3) as an array; raise :class:`InputError` unless all are finite and none is zero."""
    dv = triples(what, "dv", dv)
    if not np.all(np.any(dv != 0.0, axis=-1)):
        raise InputError(f"{what}: the friction of a contact that does not slide is not given by eq. (14)")
    return dv


def loaded(what: str, f: FloatArray) -> FloatArray:
    """Wrenches (..., 3) as an array; raise :class:`InputError` unless all are finite and none is zero."""
    f = triples(what, "f", f)
    if not np.all(np.any(f != 0.0, axis=-1)):
        raise InputError(f"{what}: a wrench of zero has no direction in which the contact slides")
    return f


def triples(what: str, name: str, value: FloatArray) -> FloatArray:
    """Twists or wrenches (..., 3) as an array; raise :class:`InputError` for another shape or what is not finite."""
    array = np.asarray(value, dtype=float)
    if array.ndim == 0 or array.shape[-1] != 3:
        raise InputError(f"{what}: {name} must have shape (..., 3), got {array.shape}")
    if not np.all(np.isfinite(array)):
        raise InputError(f"{what}: {name} must be finite numbers, got {float(array[~np.isfinite(array)][0])!r}")
    return array


def _linear_direction(vector: FloatArray) -> FloatArray:
    """Unit vectors along the linear parts of (..., 3), with a last component of zero; zero where the linear part is."""
    size = np.hypot(vector[..., 0], vector[..., 1])
    unit = vector[..., :2] / np.where(size > 0.0, size, 1.0)[..., None]
    return np.concatenate([unit, np.zeros_like(size)[..., None]], axis=-1)
