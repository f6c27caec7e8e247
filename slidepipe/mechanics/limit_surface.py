"""The soft-finger limit surface of Section V: an ellipsoid in (f_x, f_y, m_z)."""

from dataclasses import dataclass

import numpy as np

from slidepipe.errors import InputError
from slidepipe.series import FloatArray


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
        for name in ("mu", "f_N", "a", "c"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0.0):
                raise InputError(f"soft finger: {name} must be a positive number, got {value!r}")

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
