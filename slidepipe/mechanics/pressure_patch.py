"""The exact limit surface of a circular patch under a given pressure: what the ellipsoid of Section V approximates.

The pressure is ``p ~ (1 - (r/a)**k)**(1/k)`` (Xydas and Kao): a cone for k = 1, Hertz for k = 2, uniform for k = inf.
Every point rubs against its own velocity. By symmetry all follows from one curve, force and moment over the distance
``eps`` of the centre of rotation (COR) from the patch's centre in units of ``a``; it is summed ring by ring, where the
mean over a ring is a complete elliptic integral.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize.elementwise import find_root
from scipy.special import betaln, ellipkm1, elliprd, gammaln

from slidepipe.errors import InputError
from slidepipe.mechanics.limit_surface import SoftFinger, loaded, moving, positive, triples
from slidepipe.series import FloatArray

_FAR = 1e150  # a COR further away than this many radii cannot be told from infinity
_ROWS = 2048  # twists integrated at a time: bounds the memory
_STEP, _REACH = 0.125, 3.125  # of the double-exponential rule in its own variable


def torsion_constant(k: float) -> float:
    """c(k) of the largest moment ``a c mu f_N``: ``3/4 Gamma(3/k)**2 / (Gamma(2/k) Gamma(4/k))``.

    Parameters
    ----------
    k : float
        Pressure exponent, from 1 to infinity.

    Examples
    --------
    >>> round(torsion_constant(2.0), 6), round(torsion_constant(np.inf), 6)
    (0.589049, 0.666667)
    """
    _check_exponent(k)
    if np.isinf(k):
        return 2.0 / 3.0
    return float(0.75 * np.exp(2.0 * gammaln(3.0 / k) - gammaln(2.0 / k) - gammaln(4.0 / k)))


@dataclass(frozen=True, slots=True)
class PressurePatch:
    """A circular patch of Coulomb friction, exact: a :class:`~slidepipe.mechanics.limit_surface.LimitSurface`.

    Attributes
    ----------
    mu : float
        Coefficient of friction.
    f_N : float
        Normal force, N.
    a : float
        Radius of the patch, m.
    k : float
        Pressure exponent, from 1 (cone) to infinity (uniform).
    """

    mu: float
    f_N: float
    a: float
    k: float

    def __post_init__(self) -> None:
        positive("pressure patch", self, "mu", "f_N", "a")
        _check_exponent(self.k)

    @property
    def c(self) -> float:
        """Constant of the largest moment, :func:`torsion_constant`."""
        return torsion_constant(self.k)

    @property
    def semi_axes(self) -> FloatArray:
        """(3,) largest forces and moment, N and N m: those of :meth:`ellipsoid`."""
        return self.ellipsoid().semi_axes

    def ellipsoid(self) -> SoftFinger:
        """The soft finger of eq. (10) with the same largest force and moment; it contains this surface."""
        return SoftFinger(self.mu, self.f_N, self.a, self.c)

    def friction(self, dv: FloatArray) -> FloatArray:
        """Friction wrench (..., 3), N and N m, of a twist ``dv`` (..., 3) in m/s and rad/s, or of a multiple of it.

        Examples
        --------
        >>> PressurePatch(mu=0.5, f_N=2.0, a=0.02, k=np.inf).friction(np.array([0.02, 0.0, 1.0])).round(7)
        array([0.8488264, 0.       , 0.0056588])
        """
        dv = moving("pressure patch", dv)
        dv = dv / np.max(np.abs(dv), axis=-1, keepdims=True)
        speed = np.hypot(dv[..., 0], dv[..., 1])
        F, T = curve(speed, self.a * np.abs(dv[..., 2]), self.k)
        unit = dv[..., :2] / np.where(speed > 0.0, speed, 1.0)[..., None]
        moment = self.a * T * np.sign(dv[..., 2])
        return np.asarray(self.mu * self.f_N * np.concatenate([F[..., None] * unit, moment[..., None]], axis=-1))

    def direction(self, f: FloatArray) -> FloatArray:
        """Unit twist (..., 3) of a wrench ``f`` (..., 3) on the surface, or of any multiple of it, eq. (11).

        Examples
        --------
        >>> patch = PressurePatch(mu=0.5, f_N=2.0, a=0.02, k=2.0)
        >>> patch.direction(patch.friction(np.array([0.0, 0.006, -0.8]))) * 0.8
        array([ 0.        ,  0.00599983, -0.7999775 ])
        """
        f = loaded("pressure patch", f)
        force, moment = np.hypot(f[..., 0], f[..., 1]), np.abs(f[..., 2]) / self.a
        q = _turning_share(force, moment, self.k)
        unit = f[..., :2] / np.where(force > 0.0, force, 1.0)[..., None]
        linear = (1.0 - q)[..., None] * unit
        dv = np.concatenate([linear, (q / self.a * np.sign(f[..., 2]))[..., None]], axis=-1)
        return np.asarray(dv / np.linalg.norm(dv, axis=-1, keepdims=True))

    def load(self, f: FloatArray) -> FloatArray:
        """How often ``f`` (..., 3) fits into the surface (...): the largest ``f . dv / support(dv)``; sticks below one.

        Examples
        --------
        >>> round(float(PressurePatch(mu=0.5, f_N=2.0, a=0.02, k=2.0).load(np.array([0.3, 0.4, 0.0]))), 9)
        0.5
        """
        f = triples("pressure patch", "f", f)
        some = np.any(f != 0.0, axis=-1)
        f = np.where(some[..., None], f, 1.0)
        force, moment = np.hypot(f[..., 0], f[..., 1]), np.abs(f[..., 2]) / self.a
        q = _turning_share(force, moment, self.k)
        F, T = curve(1.0 - q, q, self.k)
        used = ((1.0 - q) * force + q * moment) / ((1.0 - q) * F + q * T) / (self.mu * self.f_N)
        return np.asarray(np.where(some, used, 0.0))

    def support(self, dv: FloatArray) -> FloatArray:
        """Power (...) that friction dissipates at ``dv`` (..., 3), W."""
        dv = triples("pressure patch", "dv", dv)
        some = np.any(dv != 0.0, axis=-1)
        power = np.sum(self.friction(np.where(some[..., None], dv, 1.0)) * dv, axis=-1)
        return np.asarray(np.where(some, power, 0.0))


def curve(v: FloatArray, w: FloatArray, k: float) -> tuple[FloatArray, FloatArray]:
    """Force and moment of the unit patch (mu f_N = a = 1) that slides at ``v`` and turns at ``w``.

    Every ring adds a positive part to both, and the double-exponential rule takes the COR and the rim, where the
    integrand is singular, as ends of its intervals: both are good to 1e-9 of themselves.

    Parameters
    ----------
    v, w : (...)
        Not negative, not both zero; only their ratio, the COR's distance from the centre, matters.
    k : float
        Pressure exponent.

    Returns
    -------
    F, T : (...)
        Shares of the largest force ``mu f_N`` and of ``mu f_N a``.
    """
    v, w = np.broadcast_arrays(np.asarray(v, dtype=float), np.asarray(w, dtype=float))
    turning = w > 0.0
    eps = np.where(turning, np.minimum(v, _FAR * w) / np.where(turning, w, 1.0), _FAR).reshape(-1)
    F, T = np.empty_like(eps), np.empty_like(eps)
    for start in range(0, eps.size, _ROWS):
        rows = slice(start, start + _ROWS)
        F[rows], T[rows] = _sum_of_rings(eps[rows, None], k)
    return F.reshape(v.shape), np.where(turning, T.reshape(v.shape), 0.0)


def _sum_of_rings(eps: FloatArray, k: float) -> tuple[FloatArray, FloatArray]:
    """Shares of force and moment, (n,) each, for CORs at ``eps`` (n, 1) radii: rings within the COR, then beyond it."""
    x, rest, weight = _RULE
    split, safe = np.minimum(eps, 1.0), np.maximum(eps, 1e-300)
    r, rim = split * x, (1.0 - split) + split * rest
    share = weight * split * _ring_force(r, rim, k)
    strong, weak = _ring_friction(r / safe, ((eps - split) + split * rest) / safe)
    F, T = np.sum(share * strong, axis=-1), np.sum(share * r * weak, axis=-1)
    r, rim = split + (1.0 - split) * x, (1.0 - split) * rest
    share = weight * (1.0 - split) * _ring_force(r, rim, k)
    strong, weak = _ring_friction(split / r, (1.0 - split) * x / r)
    return F + np.sum(share * weak, axis=-1), T + np.sum(share * r * strong, axis=-1)


def _ring_friction(u: FloatArray, gap: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Mean unit friction of a ring along the faster of its two motions, sliding and turning, and along the slower.

    ``u`` <= 1 is the ratio of their speeds and ``gap = 1 - u``: ``2/pi E(u^2)`` and ``2/pi u B(u^2)``, where
    ``B(m) = (E - (1 - m) K) / m``, by Carlson's R_D without cancellation.
    """
    m1 = np.maximum(gap * (1.0 + u), 1e-300)
    D = elliprd(0.0, m1, 1.0) / 3.0
    B = ellipkm1(m1) - D
    return 2.0 / np.pi * (B + m1 * D), 2.0 / np.pi * u * B


def _ring_force(r: FloatArray, rim: FloatArray, k: float) -> FloatArray:
    """Normal force on the ring at ``r``, ``rim = 1 - r`` from the edge, by width; all rings together bear 1."""
    if np.isinf(k):
        return 2.0 * r
    log_r = np.where(rim < 0.5, np.log1p(-np.minimum(rim, 0.5)), np.log(np.maximum(r, 1e-300)))
    return np.asarray(r * (-np.expm1(k * log_r)) ** (1.0 / k) * np.exp(np.log(k) - betaln(2.0 / k, 1.0 + 1.0 / k)))


def _turning_share(force: FloatArray, moment: FloatArray, k: float) -> FloatArray:
    """Where on the curve a wrench lies: q for the twist that slides at ``1 - q`` and turns at ``q`` (unit patch).

    Along the curve the moment grows and the force falls with q, so that there is one root between the ends. A force far
    below the moment is met to rounding of the moment, since ``1 - q`` is.
    """

    def beyond(q: FloatArray, force: FloatArray, moment: FloatArray) -> FloatArray:
        F, T = curve(1.0 - q, q, k)
        return force * T - moment * F

    size = np.maximum(force, moment)
    force, moment = force / size, moment / size
    between = (force > 0.0) & (moment > 0.0)
    ends = np.zeros_like(force), np.ones_like(force)
    wrench = np.where(between, force, 1.0), np.where(between, moment, 1.0)
    found = find_root(beyond, ends, args=wrench, tolerances={"xatol": 1e-30})
    return np.where(between, found.x, np.where(moment > 0.0, 1.0, 0.0))


def _double_exponential() -> tuple[FloatArray, FloatArray, FloatArray]:
    """Nodes in (0, 1), their distances from 1 and weights, that shrug off singular ends."""
    t = np.arange(-_REACH, _REACH + 0.5 * _STEP, _STEP)
    near = 1.0 / (1.0 + np.exp(np.pi * np.sinh(np.abs(t))))
    x, rest = np.where(t < 0.0, near, 1.0 - near), np.where(t < 0.0, 1.0 - near, near)
    return x, rest, _STEP * np.pi * np.cosh(t) * x * rest


def _check_exponent(k: float) -> None:
    if not k >= 1.0:
        raise InputError(f"pressure patch: k must be a number from 1 to infinity, got {k!r}")


_RULE = _double_exponential()
