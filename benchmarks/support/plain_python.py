"""One trial of a lone finger as a lab would write it: plain Python, scipy's solve_ivp with events, and no slidepipe."""

import math
from itertools import pairwise

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from support.motions import Case

GRAVITY = 9.81
NUDGE_M_S = 1e-9
"""Sliding velocity with which a slide begins."""
SCANS = 40


class PlainTrial:
    """Stick until the grip gives way, then slide until the sliding velocity vanishes; from one jump to the next.

    ``stop_m_s`` is the sliding velocity that counts as none.
    """

    def __init__(self, case: Case, method: str, rtol: float, stop_m_s: float) -> None:
        finger = case.lone
        self.method, self.rtol, self.stop_m_s = method, rtol, stop_m_s
        self.m, self.inertia = case.block.m, case.block.inertia
        self.force, self.rho = finger.mu * finger.f_N, finger.a * finger.c
        self.breaks = [float(t) for t in case.hand.breaks]
        self.jumps = [t for t, jump in zip(self.breaks, case.hand.jumps, strict=True) if jump]
        self.powers = [[list(axis) for axis in piece.T[:, ::-1].tolist()] for piece in case.hand.coefficients]
        self.start = [float(x) for x in case.r_f_b]

    def run(self) -> np.ndarray:
        """Last relative pose."""
        self.r, self.v = list(self.start), None
        for low, high in pairwise(self.jumps):
            self.piece = [k for k, t in enumerate(self.breaks[:-1]) if low <= t < high]
            self._phase(low, high)
        return np.array(self.r)

    def hand(self, t: float) -> tuple[list[float], list[float], list[float]]:
        """Pose, velocity and acceleration."""
        k = self.piece[0]
        while k < self.piece[-1] and t >= self.breaks[k + 1]:
            k += 1
        s, q, v, a = t - self.breaks[k], [], [], []
        for powers in self.powers[k]:
            x, dx, ddx = 0.0, 0.0, 0.0
            for power in powers:
                ddx = ddx * s + 2.0 * dx
                dx = dx * s + x
                x = x * s + power
            q.append(x)
            v.append(dx)
            a.append(ddx)
        return q, v, a

    def rate(self, t: float, y: np.ndarray) -> list[float]:
        """Rate of place and angle, and of the object's velocity."""
        x, y_b, theta, v_x, v_y, omega = y.tolist()
        _, (h_x, h_y, h_w), _ = self.hand(t)
        c, s = math.cos(theta), math.sin(theta)
        r_x, r_y = c * x - s * y_b, s * x + c * y_b
        d_x, d_y, d_w = h_x - v_x + omega * r_y, h_y - v_y - omega * r_x, h_w - omega
        share = self.force / math.sqrt(d_x * d_x + d_y * d_y + (self.rho * d_w) ** 2)
        f_x, f_y, m_z = share * d_x, share * d_y, share * self.rho**2 * d_w
        turn = (m_z + r_x * f_y - r_y * f_x) / self.inertia
        return [c * d_x + s * d_y, c * d_y - s * d_x, omega, f_x / self.m, f_y / self.m - GRAVITY, turn]

    def speed(self, t: float, y: np.ndarray) -> float:
        """Sliding velocity beyond the one that counts as none: the event that ends a slide."""
        d = self.rate(t, y)
        return math.hypot(d[0], d[1], self.rho * (self.hand(t)[1][2] - d[2])) - self.stop_m_s

    speed.terminal, speed.direction = True, -1

    def load(self, t: float) -> float:
        """Share of the friction that sticking needs, less one."""
        r_x, r_y, b = self._free(t)
        f_x, f_y = self.m * (b[0] + b[2] * r_y), self.m * (b[1] - b[2] * r_x)
        m_z = self.inertia * b[2] - r_x * f_y + r_y * f_x
        return math.hypot(f_x, f_y, m_z / self.rho) / self.force - 1.0

    def _phase(self, low: float, high: float) -> None:
        t, high = low, high - 1e-12
        while t < high:
            if self.v is None:
                t = self._onset(t, high)
                if t >= high:
                    return
                self._let_go(t)
            t = self._slide(t, high)

    def _onset(self, low: float, high: float) -> float:
        if self.load(low) > 0.0:
            return low
        for start, stop in pairwise(np.linspace(low, high, SCANS).tolist()):
            if self.load(stop) > 0.0:
                return brentq(self.load, start, stop, xtol=1e-13)
        return high

    def _free(self, t: float) -> tuple[float, float, list[float]]:
        (_, _, angle), (_, _, omega), (a_x, a_y, alpha) = self.hand(t)
        c, s = math.cos(angle - self.r[2]), math.sin(angle - self.r[2])
        r_x, r_y = c * self.r[0] - s * self.r[1], s * self.r[0] + c * self.r[1]
        return r_x, r_y, [a_x + omega**2 * r_x, a_y + GRAVITY + omega**2 * r_y, alpha]

    def _let_go(self, t: float) -> None:
        """Begin along the direction in which the relative acceleration and the friction agree."""
        r_x, r_y, b = self._free(t)
        g = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-r_y, r_x, 1.0]])
        mobility = g.T @ np.diag([1 / self.m, 1 / self.m, 1 / self.inertia]) @ g
        axes = self.force * np.array([1.0, 1.0, self.rho])

        def over(k: float) -> float:
            return np.linalg.norm(np.linalg.solve(mobility + k * np.diag(axes**-2), b) / axes) - 1.0

        k = brentq(over, 0.0, 1e4, xtol=1e-14)
        way = np.linalg.solve(mobility + k * np.diag(axes**-2), b) / axes**2
        way *= NUDGE_M_S / np.linalg.norm(way * [1.0, 1.0, self.rho])
        (_, _, angle), (h_x, h_y, h_w), _ = self.hand(t)
        omega = h_w - way[2]
        self.v = [h_x - way[0] + omega * r_y, h_y - way[1] - omega * r_x, omega]
        self.theta = angle - self.r[2]

    def _slide(self, t: float, high: float) -> float:
        start = np.array([*self.r[:2], self.theta, *self.v])
        done = solve_ivp(
            self.rate, (t, high), start, self.method, events=self.speed, rtol=self.rtol, atol=1e-3 * self.rtol
        )
        y, end = done.y[:, -1].tolist(), float(done.t[-1])
        self.r, self.theta, self.v = [*y[:2], self.hand(end)[0][2] - y[2]], y[2], y[3:]
        if done.t_events[0].size:
            self.v = None
        return end
