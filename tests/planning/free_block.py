"""A block in a pinch, simulated from the hand's positions alone: scipy with events, and none of slidepipe's mechanics.

Stick until the contact cannot bear it; then slide under the ellipsoid's friction until the sliding velocity vanishes.
All of it in the plane, poses ``[x, y, theta]`` in m and rad, about Newton's and Euler's laws written out here.
"""

from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import BSpline, make_interp_spline
from scipy.optimize import brentq

STOPPED_M_S = 1e-6
"""Where a slide counts as over; turning counts by the torsion radius."""
TIGHT = {"method": "DOP853", "rtol": 1e-10, "atol": 1e-12}


def turned(theta: float, v: np.ndarray) -> np.ndarray:
    c, s = np.cos(theta), np.sin(theta)
    return np.array([c * v[0] - s * v[1], s * v[0] + c * v[1]])


def quarter(v: np.ndarray) -> np.ndarray:
    return np.array([-v[1], v[0]])


@dataclass
class FreeBlock:
    """A block of a mass and sides, held by a friction force and a torsion radius (the paper's ``mu f_N`` and ``c a``).

    ``slides`` collects the (start, end) of every slide.
    """

    mass_kg: float
    sides_m: tuple[float, float]
    friction_n: float
    torsion_radius_m: float
    slides: list[tuple[float, float]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.inertia = self.mass_kg * (self.sides_m[0] ** 2 + self.sides_m[1] ** 2) / 12
        self.axes = self.friction_n * np.array([1.0, 1.0, self.torsion_radius_m])

    def follow(self, time_s: np.ndarray, q_f: np.ndarray, breaks_s: np.ndarray, r_b: np.ndarray) -> np.ndarray:
        """Final pose of the finger in the body frame, for hand poses (T, 3) that are smooth between the breaks."""
        self._r, self._dr, self._state = np.array(r_b, dtype=float), np.zeros(3), None
        for start, end in pairwise(breaks_s):
            piece = (time_s > start - 1e-9) & (time_s < end + 1e-9)
            hand = make_interp_spline(time_s[piece] - start, q_f[piece], k=5)
            self._follow_piece(hand, start, end - start)
        return self._r

    def _follow_piece(self, hand: BSpline, offset_s: float, length_s: float) -> None:
        now, sliding = 0.0, bool(np.any(self._dr))
        while now < length_s - 1e-12:
            if not sliding and self._need(hand, now)[1] <= 1.0:
                now, sliding = self._stick(hand, now, length_s), True
                if now >= length_s - 1e-12:
                    return
            if not np.any(self._dr):
                self._begin_slide(hand, now)
            began, now = now, self._slide(hand, now, length_s)
            self.slides.append((offset_s + began, offset_s + now))
            sliding = bool(np.any(self._dr))

    def _need(self, hand: BSpline, t: float) -> tuple[np.ndarray, float]:
        """Contact wrench in {b} that keeps the block on the finger, and its share of the friction."""
        theta = float(hand(t)[2] - self._r[2])
        _, omega, alpha = (float(hand(t, order)[2]) for order in range(3))
        arm = turned(theta, self._r[:2])
        linear = hand(t, 2)[:2] - alpha * quarter(arm) + omega**2 * arm
        force = self.mass_kg * (linear + np.array([0.0, 9.81]))
        moment = self.inertia * alpha - (arm[0] * force[1] - arm[1] * force[0])
        wrench = np.append(turned(-theta, force), moment)
        return wrench, float(np.linalg.norm(wrench / self.axes))

    def _stick(self, hand: BSpline, start: float, end: float) -> float:
        times = np.linspace(start, end, 400)
        over = np.array([self._need(hand, t)[1] for t in times]) - 1.0
        if not np.any(over > 0):
            return end
        first = int(np.argmax(over > 0))
        return float(brentq(lambda t: self._need(hand, t)[1] - 1.0, times[first - 1], times[first], xtol=1e-13))

    def _begin_slide(self, hand: BSpline, t: float) -> None:
        """Which way it gives: square to the ellipsoid where it is nearest to the needed wrench in mobility."""
        need, _ = self._need(hand, t)
        x, y = self._r[:2]
        g = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-y, x, 1.0]])
        mobility = g.T @ np.diag(1 / np.array([self.mass_kg, self.mass_kg, self.inertia])) @ g
        a = np.diag(self.axes**-2.0)

        def wrench(k: float) -> np.ndarray:
            return np.linalg.solve(mobility + k * a, mobility @ need)

        k = brentq(lambda k: np.linalg.norm(wrench(k) / self.axes) - 1.0, 0.0, 1e3, xtol=1e-15)
        way = self.axes**-2.0 * wrench(k)
        self._dr = 1e-9 * way / np.linalg.norm(way * [1, 1, self.torsion_radius_m])

    def _slide(self, hand: BSpline, start: float, end: float) -> float:
        def rate(t: float, state: np.ndarray) -> np.ndarray:
            r, dr = state[:3], state[3:]
            theta = float(hand(t)[2]) - r[2]
            omega = float(hand(t, 1)[2]) - dr[2]
            wrench = self.axes**2 * dr / np.linalg.norm(self.axes * dr)
            force = turned(theta, wrench[:2])
            block = force / self.mass_kg - [0.0, 9.81]
            alpha = (wrench[2] + r[0] * wrench[1] - r[1] * wrench[0]) / self.inertia
            relative = turned(-theta, hand(t, 2)[:2] - block)
            inertial = 2 * omega * quarter(dr[:2]) + alpha * quarter(r[:2]) - omega**2 * r[:2]
            return np.concatenate([dr, relative - inertial, [float(hand(t, 2)[2]) - alpha]])

        def speed(_: float, state: np.ndarray) -> float:
            return float(np.linalg.norm(state[3:] * [1, 1, self.torsion_radius_m])) - STOPPED_M_S

        speed.terminal, speed.direction = True, -1
        done = solve_ivp(rate, (start, end), np.concatenate([self._r, self._dr]), events=speed, **TIGHT)
        self._r, self._dr = done.y[:3, -1], done.y[3:, -1]
        if done.t_events[0].size:
            self._dr = np.zeros(3)
        return float(done.t[-1])
