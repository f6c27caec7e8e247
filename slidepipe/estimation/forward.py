"""Many sliding blocks at once: the object under a given hand, for the joint fit's residuals and derivatives."""

from dataclasses import dataclass

import numpy as np

from slidepipe.mechanics.dynamics import GRAVITY
from slidepipe.series import FloatArray


@dataclass(frozen=True, slots=True)
class SlidingBlocks:
    """B blocks that slide under B hands, eq. (20) without the sticking.

    Attributes
    ----------
    step_s : float
        Time step of the fourth-order Runge-Kutta rule.
    hand : (N + 1, B, 3)
        Pose of each hand in {w} at every *half* step.
    hand_velocity : (N + 1, B, 3)
        Its time derivative.
    kappa : (B,)
        mu f_N / m, m/s^2.
    rho_m : (B,)
        Torsion constant times contact radius, m.
    mass_per_inertia : float
        m / I, 1/m^2.
    soft_m_s : float
        Sliding speed below which friction fades, so that a block that would stick gives finite derivatives: by the
        fourth power of speed, 0.3 % too little at three times this speed.
    """

    step_s: float
    hand: FloatArray
    hand_velocity: FloatArray
    kappa: FloatArray
    rho_m: FloatArray
    mass_per_inertia: float
    soft_m_s: float

    def rate(self, at: int, state: FloatArray) -> FloatArray:
        """Time derivative (6, B) of ``[x, y, theta, vx, vy, omega]`` (6, B) at a half step."""
        q_f, dq_f = self.hand[at], self.hand_velocity[at]
        x, y = q_f[:, 0] - state[0], q_f[:, 1] - state[1]
        vx, vy = dq_f[:, 0] - state[3] + state[5] * y, dq_f[:, 1] - state[4] - state[5] * x
        spin = self.rho_m * (dq_f[:, 2] - state[5])
        force = self.kappa / ((vx * vx + vy * vy + spin * spin) ** 2 + self.soft_m_s**4) ** 0.25
        fx, fy = force * vx, force * vy
        turn = self.mass_per_inertia * (self.rho_m * force * spin + x * fy - y * fx)
        slope = np.empty_like(state)
        slope[:3], slope[3], slope[4], slope[5] = state[3:], fx, fy - GRAVITY, turn
        return slope

    def run(self, start: FloatArray) -> FloatArray:
        """States (N / 2 + 1, 6, B) at the whole steps from the first states (6, B)."""
        h, states = self.step_s, [start]
        for at in range(0, len(self.hand) - 1, 2):
            state = states[-1]
            k1 = self.rate(at, state)
            k2 = self.rate(at + 1, state + 0.5 * h * k1)
            k3 = self.rate(at + 1, state + 0.5 * h * k2)
            k4 = self.rate(at + 2, state + h * k3)
            states.append(state + (h / 6.0) * (k1 + 2.0 * k2 + 2.0 * k3 + k4))
        return np.stack(states)
