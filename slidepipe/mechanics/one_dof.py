"""One degree of freedom, Sections III-A to III-C: a finger that shakes an object along a line until it slides.

``d_c = q_f - q_o`` is the position of the finger relative to the object, and ``a_o = mu f_N / m`` the largest
acceleration that friction gives the object (the paper's object has unit mass). Section III-D is in ``theorem_1``.
"""

from dataclasses import dataclass

import numpy as np

from slidepipe.errors import InputError
from slidepipe.mechanics.line_motion import LineMotion, Piece
from slidepipe.series import FloatArray


def relative_acceleration(ddq_f: FloatArray | float, dd_c: FloatArray | float, a_o: float) -> FloatArray:
    """Forward dynamics, Section III-A: how the slide accelerates under a given motion of the finger.

    Parameters
    ----------
    ddq_f : (...)
        Acceleration of the finger, m/s^2.
    dd_c : (...)
        Sliding velocity, m/s; it sticks only where this is exactly zero.
    a_o : float
        Acceleration that friction gives the object, m/s^2.

    Returns
    -------
    (...)
        The second derivative of ``d_c`` in m/s^2: zero where it goes on sticking.

    Examples
    --------
    >>> relative_acceleration([3.0, -7.0, 3.0], [0.0, 0.0, -0.1], a_o=5.0)
    array([ 0., -2.,  8.])
    """
    _check_positive(a_o=a_o)
    ddq_f, dd_c = np.broadcast_arrays(_finite("ddq_f", ddq_f), _finite("dd_c", dd_c))
    from_rest = np.sign(ddq_f) * np.maximum(np.abs(ddq_f) - a_o, 0.0)
    return np.where(dd_c == 0.0, from_rest, ddq_f - np.sign(dd_c) * a_o)


def finger_accelerations(
    ddd_c: FloatArray | float, dd_c: FloatArray | float, a_o: float
) -> tuple[FloatArray, FloatArray]:
    """Inverse dynamics, Section III-B: which accelerations of the finger make the slide accelerate as wanted.

    Parameters
    ----------
    ddd_c : (...)
        Wanted second derivative of ``d_c``, m/s^2.
    dd_c : (...)
        Sliding velocity, m/s.
    a_o : float
        Acceleration that friction gives the object, m/s^2.

    Returns
    -------
    lowest, highest : (...)
        m/s^2. They are equal, except where it is to stick: there all from ``-a_o`` to ``a_o`` will do.

    Examples
    --------
    >>> finger_accelerations([0.0, -2.0, 8.0], [0.0, 0.0, -0.1], a_o=5.0)
    (array([-5., -7.,  3.]), array([ 5., -7.,  3.]))
    """
    _check_positive(a_o=a_o)
    ddd_c, dd_c = np.broadcast_arrays(_finite("ddd_c", ddd_c), _finite("dd_c", dd_c))
    way = np.where(dd_c == 0.0, np.sign(ddd_c), np.sign(dd_c))
    lowest, highest = np.where(way == 0.0, -1.0, way), np.where(way == 0.0, 1.0, way)
    return ddd_c + lowest * a_o, ddd_c + highest * a_o


@dataclass(frozen=True, slots=True)
class Accelerations:
    """The three accelerations of Section III, ``a_f > a_o > a > 0``, m/s^2.

    Attributes
    ----------
    a_f : float
        Of the finger while it tears itself loose (phase T2).
    a_o : float
        Of the object by friction, as estimated: ``mu_0 f_N / m``.
    a : float
        Of the finger before and after.
    """

    a_f: float
    a_o: float
    a: float

    def __post_init__(self) -> None:
        _check_positive(a_f=self.a_f, a_o=self.a_o, a=self.a)
        if not self.a < self.a_o:
            raise InputError(f"one DOF: a must be below a_o = {self.a_o!r} m/s^2 so that it sticks, got {self.a!r}")
        if not self.a_f > self.a_o:
            raise InputError(f"one DOF: a_f must be above a_o = {self.a_o!r} m/s^2 so that it slides, got {self.a_f!r}")


@dataclass(frozen=True, slots=True)
class Slide:
    """What one motion of the finger did to an object with some actual friction.

    The slide towards the goal stops within T3 + T4 whatever the friction is: if it went on until T, the object
    would by then move against ``a``, and so the finger, which rests, would slide the other way. Where the slide is not
    at rest at T, it has begun again since, away from the goal.

    Attributes
    ----------
    a_o : float
        Actual acceleration of the object by friction, m/s^2.
    d_T, dd_T : float
        ``d_c`` in m and its derivative in m/s at the end T of the finger's motion.
    slips_in_T1 : bool
        It slides already while the finger accelerates at ``a``, away from the goal, and does so again in T4.
    motion : LineMotion
        ``d_c`` over time, until it rests. The finger stays where it is after T.
    """

    a_o: float
    d_T: float
    dd_T: float
    slips_in_T1: bool
    motion: LineMotion

    @property
    def d(self) -> float:
        """The slide in m, when all has come to rest."""
        return float(self.motion.at(self.motion.breaks[-1]))

    @property
    def slides(self) -> bool:
        """Whether it slides at all."""
        return bool(np.any(self.motion.coefficients))

    @property
    def rests_at_T(self) -> bool:
        """Whether the object rests on the finger when the finger stops. It does if it sticks in T1, and only then."""
        return self.dd_T == 0.0


@dataclass(frozen=True, slots=True)
class Profile:
    """The finger's motion of Section III-C, from rest to rest at the same place, for one intended slide.

    Its times solve eqs. (1) to (3): the finger turns round by symmetry, ends as fast as the object, and slid d_goal.

    Attributes
    ----------
    accelerations : Accelerations
    d_goal : float
        Intended slide in m, not zero. The paper's is negative; a positive one mirrors the motion.

    Examples
    --------
    >>> profile = Profile(Accelerations(a_f=20.0, a_o=5.0, a=4.0), d_goal=-0.1)
    >>> [round(T, 4) for T in (profile.T1, profile.T2, profile.T3, profile.T4)]
    [0.1768, 0.0707, 0.1179, 0.0589]
    >>> round(profile.slide(5.0).d, 12), round(profile.slide(6.0).d, 12)
    (-0.1, -0.084)
    """

    accelerations: Accelerations
    d_goal: float

    def __post_init__(self) -> None:
        if not (np.isfinite(self.d_goal) and self.d_goal != 0.0):
            raise InputError(f"one DOF: d_goal must be a finite length other than zero, got {self.d_goal!r}")

    @property
    def T1(self) -> float:
        """First sticking phase, s, eq. (4)."""
        return self.accelerations.a_f * self.T2 / (2.0 * self.accelerations.a)

    @property
    def T2(self) -> float:
        """Sliding while the finger brakes at ``a_f``, s, eq. (4)."""
        s = self.accelerations
        return float(np.sqrt(2.0 * abs(self.d_goal) * (s.a + s.a_o) / ((s.a + s.a_f) * (s.a_f - s.a_o))))

    @property
    def T3(self) -> float:
        """Sliding until the object has caught up, s, eq. (4)."""
        s = self.accelerations
        return float(np.sqrt(2.0 * abs(self.d_goal) * (s.a_f - s.a_o) / ((s.a + s.a_f) * (s.a + s.a_o))))

    @property
    def T4(self) -> float:
        """Last sticking phase, s: ``T1 - T3``, always positive."""
        return self.T1 - self.T3

    @property
    def T(self) -> float:
        """The whole motion, s."""
        return self.T1 + self.T2 + self.T1

    @property
    def finger(self) -> LineMotion:
        """The motion q_f(t) of the finger: ``a`` for T1, ``-a_f`` for T2, ``a`` for T3 + T4 (if d_goal < 0)."""
        speed = self._phases[0][0] * self.T1
        pieces = zip(self._phases, (0.0, speed, -speed), strict=True)
        return LineMotion.of([Piece(duration, dq, ddq) for (ddq, duration), dq in pieces])

    def slide(self, a_o: float) -> Slide:
        """The slide that comes of it if friction really gives the object ``a_o``, in closed form.

        Parameters
        ----------
        a_o : float
            Actual friction acceleration, m/s^2: any positive number. From ``a`` to ``a_f`` it goes as planned; from
            ``a_f`` on nothing slides; below ``a`` it slips in the sticking phases and is not at rest at the end.
        """
        _check_positive(a_o=a_o)
        pieces: list[Piece] = []
        dd_c = 0.0
        for ddq_f, duration in self._phases:
            dd_c = _slide_on(pieces, dd_c, ddq_f, duration=duration, a_o=a_o)
        d_T, dd_T = float(sum(piece.way for piece in pieces)), dd_c
        if dd_c != 0.0:
            pieces.append(Piece(abs(dd_c) / a_o, dd_c, float(-np.sign(dd_c)) * a_o))
        return Slide(a_o=a_o, d_T=d_T, dd_T=dd_T, slips_in_T1=a_o < self.accelerations.a, motion=LineMotion.of(pieces))

    @property
    def _phases(self) -> list[tuple[float, float]]:
        """Acceleration of the finger and duration of its three phases."""
        way = -float(np.sign(self.d_goal))
        ahead, back = way * self.accelerations.a, -way * self.accelerations.a_f
        return [(ahead, self.T1), (back, self.T2), (ahead, self.T1)]


def _slide_on(pieces: list[Piece], dd_c: float, ddq_f: float, *, duration: float, a_o: float) -> float:
    """Add what the slide does in one phase of the finger; returns the sliding velocity at its end."""
    if dd_c != 0.0:
        ddd_c = float(relative_acceleration(ddq_f, dd_c, a_o))
        stop = -dd_c / ddd_c if ddd_c * dd_c < 0.0 else np.inf
        pieces.append(Piece(min(stop, duration), dd_c, ddd_c))
        if stop > duration:
            return dd_c + ddd_c * duration
        duration -= stop
    ddd_c = float(relative_acceleration(ddq_f, 0.0, a_o))
    pieces.append(Piece(duration, 0.0, ddd_c))
    return ddd_c * duration


def _check_positive(**values: float) -> None:
    for name, value in values.items():
        if not (np.isfinite(value) and value > 0.0):
            raise InputError(f"one DOF: {name} must be a positive number in m/s^2, got {value!r}")


def _finite(name: str, values: FloatArray | float) -> FloatArray:
    array = np.asarray(values, dtype=float)
    if not np.all(np.isfinite(array)):
        raise InputError(f"one DOF: {name} must be finite, got {values!r}")
    return array
