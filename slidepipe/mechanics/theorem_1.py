"""Theorem 1, Section III-D: how wrong the friction may be so that repeating the slide still ends at the goal.

Every duration of eq. (4) grows with the square root of d_goal and the accelerations stay, so the actual slide is the
same multiple of the intended one in every trial: what remains, eq. (7), shrinks by the same factor k_i each time.
The paper's ``mu_0 f_N`` is ``a_o`` here, and ``epsilon`` is ``eps``.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from slidepipe.errors import InputError
from slidepipe.mechanics.one_dof import Accelerations, Profile
from slidepipe.series import FloatArray


def friction_acceleration(mu: float, f_N: float, m: float = 1.0) -> float:
    """``a_o = mu f_N / m`` in m/s^2, for a normal force in N and a mass in kg (the paper's is one).

    Examples
    --------
    >>> friction_acceleration(mu=0.5, f_N=10.0)
    5.0
    """
    for name, value in (("mu", mu), ("f_N", f_N), ("m", m)):
        if not (np.isfinite(value) and value > 0.0):
            raise InputError(f"one DOF: {name} must be a positive number, got {value!r}")
    return mu * f_N / m


def d_2(profile: Profile, eps: float) -> float:
    """Error when friction is ``eps`` larger than estimated, m, eq. (5): the slide is ``d_goal - d_2``.

    It has the sign of d_goal. It holds while condition 2 does; beyond, nothing slides and the error is d_goal.
    """
    return _slide_error(profile, eps, sign=1.0)


def d_3(profile: Profile, eps: float) -> float:
    """Error when friction is ``eps`` smaller than estimated, m, eq. (6): the slide is ``d_goal + d_3``.

    It has the sign of d_goal. It holds while condition 1 does; beyond, the object slips in the sticking phases too.
    """
    return _slide_error(profile, eps, sign=-1.0)


def slide_ratio(accelerations: Accelerations, a_o: FloatArray | float) -> FloatArray:
    """Actual over intended slide, for an actual friction acceleration ``a_o`` (...) between ``a`` and ``a_f``.

    It falls from there to zero as friction grows. ``Profile.slide`` tells what happens outside.

    Examples
    --------
    >>> slide_ratio(Accelerations(a_f=20.0, a_o=5.0, a=4.0), [5.0, 6.0, 20.0])
    array([1.  , 0.84, 0.  ])
    """
    s, actual = accelerations, np.asarray(a_o, dtype=float)
    if not np.all((actual >= s.a) & (actual <= s.a_f)):
        raise InputError(f"slide ratio: a_o must be from a = {s.a!r} to a_f = {s.a_f!r} m/s^2, got {a_o!r}")
    return np.asarray((s.a_f - actual) / (s.a + actual) * ((s.a + s.a_o) / (s.a_f - s.a_o)))


def contraction_factor(accelerations: Accelerations, a_o: float) -> float:
    """The factor k_i by which a trial shrinks what is left, for any actual friction acceleration: ``|1 - ratio|``.

    The finger stays in place after a trial until the object rests. From one on, repeating does not converge.

    Examples
    --------
    >>> round(contraction_factor(Accelerations(a_f=20.0, a_o=5.0, a=4.0), 6.0), 12)
    0.16
    """
    return abs(1.0 - Profile(accelerations, 1.0).slide(a_o).d)


def contraction_bound(accelerations: Accelerations, eps: float) -> float:
    """The largest k_i over frictions from ``a_o (1 - eps)`` to ``a_o (1 + eps)``: ``d_3 / d_goal`` of eqs. (3) and (6).

    Raises
    ------
    InputError
        If ``eps`` is above ``1 - a/a_o``: the object may then slip in the sticking phases, which eq. (6) leaves out.

    Examples
    --------
    >>> round(contraction_bound(Accelerations(a_f=20.0, a_o=5.0, a=4.0), 0.2), 12)
    0.2
    """
    s = accelerations
    if not (eps >= 0.0 and s.a <= s.a_o * (1.0 - eps)):
        raise InputError(f"contraction bound: eps must be from 0 to 1 - a/a_o = {1.0 - s.a / s.a_o:g}, got {eps!r}")
    return abs(d_3(Profile(s, 1.0), eps))


@dataclass(frozen=True, slots=True)
class Condition:
    """One of Theorem 1's conditions, ``left < right`` or ``left > right``, in m/s^2."""

    name: str
    left: float
    relation: Literal["<", ">"]
    right: float

    @property
    def holds(self) -> bool:
        """Whether it does."""
        return self.left < self.right if self.relation == "<" else self.left > self.right


@dataclass(frozen=True, slots=True)
class Theorem1:
    """Theorem 1's conditions at one ``eps``: three as printed, and the fourth without which the third says nothing.

    Attributes
    ----------
    sticks : Condition
        1: ``a < a_o (1 - eps)``, it sticks in T1 and T4.
    slides : Condition
        2: ``a_f > a_o (1 + eps)``, it slides in T2; then eq. (8) holds, ``|d_2| < |d_goal|``.
    stops : Condition
        3: ``a_f > a_o (a (1 + eps) + (1 - eps) a_o) / (a + (1 - 2 eps) a_o)``, it slides less than twice as far,
        eq. (9).
    can_stop : Condition
        4, unsaid: ``a + (1 - 2 eps) a_o > 0``. Else no a_f is large enough, though the third holds as printed.
    """

    sticks: Condition
    slides: Condition
    stops: Condition
    can_stop: Condition

    @property
    def conditions(self) -> tuple[Condition, ...]:
        """All four, in the paper's order."""
        return self.sticks, self.slides, self.stops, self.can_stop

    @property
    def holds(self) -> bool:
        """Whether all four do: repeating then converges for every friction within ``eps``."""
        return all(condition.holds for condition in self.conditions)


def theorem_1(accelerations: Accelerations, eps: float) -> Theorem1:
    """Theorem 1's conditions for a friction known to within ``eps`` (0.2 is 20 %; below 1).

    Examples
    --------
    >>> for condition in theorem_1(Accelerations(a_f=20.0, a_o=5.0, a=4.0), 0.15).conditions:
    ...     print(condition.name, condition.holds, f"{condition.left:g} {condition.relation} {condition.right:.3g}")
    sticks True 4 < 4.25
    slides True 20 > 5.75
    stops True 20 > 5.9
    can stop True 7.5 > 0
    """
    _check_eps(eps)
    s = accelerations
    room = s.a + (1.0 - 2.0 * eps) * s.a_o
    enough = s.a_o * (s.a * (1.0 + eps) + (1.0 - eps) * s.a_o) / room if room != 0.0 else np.inf
    return Theorem1(
        sticks=Condition("sticks", s.a, "<", s.a_o * (1.0 - eps)),
        slides=Condition("slides", s.a_f, ">", s.a_o * (1.0 + eps)),
        stops=Condition("stops", s.a_f, ">", enough),
        can_stop=Condition("can stop", room, ">", 0.0),
    )


@dataclass(frozen=True, slots=True)
class EpsLimits:
    """Below which ``eps`` each condition of Theorem 1 holds; ``stops`` together with the unsaid fourth."""

    sticks: float
    slides: float
    stops: float
    can_stop: float

    @property
    def eps_star(self) -> float:
        """The largest friction error: all four conditions hold for every ``eps`` below it and for none from it on."""
        return min(self.sticks, self.stops)

    @property
    def binding(self) -> Literal["sticks", "stops"]:
        """Which condition sets it."""
        return "sticks" if self.sticks <= self.stops else "stops"


def eps_limits(accelerations: Accelerations) -> EpsLimits:
    """Theorem 1's conditions solved for ``eps``.

    Multiplied by its denominator, which the fourth condition makes positive, the third is linear in ``eps``:
    ``eps a_o (2 a_f + a - a_o) < (a + a_o)(a_f - a_o)``. Its limit is that of the second times
    ``(a + a_o) / (2 a_f + a - a_o)``, and that of the fourth times ``2 (a_f - a_o) / (2 a_f + a - a_o)``. Both factors
    are below one, so that only the first and the third can set ``eps_star``. The conditions are enough, not needed:
    where the third binds, repeating fails for some friction at any larger ``eps``; where the first does, it may still
    converge a little beyond.

    Examples
    --------
    >>> limits = eps_limits(Accelerations(a_f=20.0, a_o=5.0, a=4.0))
    >>> round(limits.sticks, 4), round(limits.slides, 4), round(limits.stops, 4), round(limits.can_stop, 4)
    (0.2, 3.0, 0.6923, 0.9)
    >>> limits.binding
    'sticks'
    """
    s = accelerations
    return EpsLimits(
        sticks=(s.a_o - s.a) / s.a_o,
        slides=(s.a_f - s.a_o) / s.a_o,
        stops=(s.a + s.a_o) * (s.a_f - s.a_o) / (s.a_o * (2.0 * s.a_f + s.a - s.a_o)),
        can_stop=(s.a + s.a_o) / (2.0 * s.a_o),
    )


def _slide_error(profile: Profile, eps: float, *, sign: float) -> float:
    _check_eps(eps)
    s = profile.accelerations
    a_eps = eps * s.a_o
    times = profile.T2**2 + profile.T2 * profile.T3
    return float(np.sign(profile.d_goal)) * 0.5 * a_eps * (s.a + s.a_f) * times / (s.a + s.a_o + sign * a_eps)


def _check_eps(eps: float) -> None:
    if not 0.0 <= eps < 1.0:
        raise InputError(f"Theorem 1: eps must be at least 0 and below 1, got {eps!r}")
