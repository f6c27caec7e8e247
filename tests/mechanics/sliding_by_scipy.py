"""A block in one soft finger, integrated by scipy in {w} from Newton's and Euler's laws alone."""

from itertools import pairwise

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from slidepipe.mechanics.dynamics import Block
from slidepipe.mechanics.hand_motion import HandMotion
from slidepipe.mechanics.limit_surface import SoftFinger

DOWN = np.array([0.0, -9.81, 0.0])
STOPPED_M_S = 1e-6
TIGHT = {"method": "LSODA", "rtol": 1e-11, "atol": 1e-13}


def turn(angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


class Trial:
    """``r`` is the last relative pose in {b}, ``slides`` the (start, end) of every slide."""

    def __init__(self, hand: HandMotion, block: Block, finger: SoftFinger, r_f_b: np.ndarray) -> None:
        self.hand, self.r, self.slides = hand, np.array(r_f_b, dtype=float), []
        self.m = np.array([block.m, block.m, block.m * (block.length**2 + block.width**2) / 12])
        self.axes = finger.mu * finger.f_N * np.array([1.0, 1.0, finger.a * finger.c])
        self.q_o, self.dq_o, sliding = None, None, False
        for low, high in pairwise([*hand.breaks[hand.jumps], hand.breaks[-1] + 0.5]):
            now, inside = low, high - 1e-11
            while now < inside:
                if not sliding:
                    now = self._onset(now, inside)
                    if now >= inside:
                        break
                    self._let_go(now)
                    self.slides.append((now, now))
                end, sliding = self._slide(now, inside)
                self.slides[-1] = (self.slides[-1][0], end)
                now = end if not sliding else high

    def _map(self, offset: np.ndarray) -> np.ndarray:
        return np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-offset[1], offset[0], 1.0]])

    def _need(self, t: float) -> tuple[np.ndarray, np.ndarray]:
        """What sticking asks of the contact, and the offset from the CoM."""
        (_, _, angle), (_, _, omega), ddq = (self.hand.at(np.array([t]), order)[0] for order in range(3))
        offset = turn(angle - self.r[2]) @ (self.r * [1.0, 1.0, 0.0])
        ddq_o = ddq + omega**2 * offset - ddq[2] * np.array([-offset[1], offset[0], 0.0])
        return np.linalg.solve(self._map(offset), self.m * (ddq_o - DOWN)), offset

    def _onset(self, low: float, high: float) -> float:
        def over(t: float) -> float:
            return float(np.linalg.norm(self._need(t)[0] / self.axes)) - 1.0

        times = np.linspace(low, high, 200)
        for start, stop in pairwise(times):
            if over(start) > 0.0:
                return float(start)
            if over(stop) > 0.0:
                return float(brentq(over, start, stop, xtol=1e-14))
        return high

    def _let_go(self, t: float) -> None:
        """The relative acceleration b - W f is along A f, with f on the ellipsoid."""
        need, offset = self._need(t)
        g = self._map(offset)
        w, a = g.T @ np.diag(1.0 / self.m) @ g, np.diag(self.axes**-2.0)

        def f(k: float) -> np.ndarray:
            return np.linalg.solve(w + k * a, w @ need)

        way = a @ f(brentq(lambda k: np.linalg.norm(f(k) / self.axes) - 1.0, 0.0, 1e4, xtol=1e-15))
        q_f, dq_f = (self.hand.at(np.array([t]), order)[0] for order in range(2))
        self.q_o = q_f - np.append(offset[:2], self.r[2])
        slip = 1e-9 * way / np.linalg.norm(way * self.axes / self.axes[0])
        self.dq_o = np.linalg.solve(g.T, dq_f - slip)

    def _slip(self, t: float, state: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        q_f, dq_f = (self.hand.at(np.array([t]), order)[0] for order in range(2))
        g = self._map(q_f - state[:3])
        return dq_f - g.T @ state[3:], g

    def _slide(self, start: float, end: float) -> tuple[float, bool]:
        def rate(t: float, state: np.ndarray) -> np.ndarray:
            slip, g = self._slip(t, state)
            f = self.axes**2 * slip / np.linalg.norm(self.axes * slip)
            return np.concatenate([state[3:], g @ f / self.m + DOWN])

        def speed(t: float, state: np.ndarray) -> float:
            return float(np.linalg.norm(self._slip(t, state)[0] * self.axes / self.axes[0])) - STOPPED_M_S

        speed.terminal, speed.direction = True, -1
        done = solve_ivp(rate, (start, end), np.concatenate([self.q_o, self.dq_o]), events=speed, **TIGHT)
        self.q_o, self.dq_o, now = done.y[:3, -1], done.y[3:, -1], float(done.t[-1])
        apart = self.hand.at(np.array([now]))[0] - self.q_o
        self.r = turn(-self.q_o[2]) @ apart
        return now, not done.t_events[0].size
