"""Section III in the plane: a hand that falls freely feels no gravity, and moves along a line beside its fall."""

import numpy as np

from slidepipe.mechanics.hand_motion import HandMotion
from slidepipe.mechanics.one_dof import Profile

GRAVITY = 9.81
BRAKE = 4.0


def falling_hand(profile: Profile, heading: float) -> HandMotion:
    """The finger's motion along a heading in free fall; then the fall is braked, gently enough to stick."""
    way = np.array([np.cos(heading), np.sin(heading), 0.0])
    line, up = profile.finger, np.array([0.0, 1.0, 0.0])
    pieces = []
    for start, (q, dq, half) in zip(line.breaks[:-1], line.coefficients, strict=True):
        fall = np.outer([-0.5 * GRAVITY * start**2, -GRAVITY * start, -0.5 * GRAVITY], up)
        pieces.append(np.outer([q, dq, half], way) + fall)
    end = line.breaks[-1]
    bottom = float(line.at(end)) * way - 0.5 * GRAVITY * end**2 * up
    pieces.append(np.array([bottom, -GRAVITY * end * up, 0.5 * BRAKE * up]))
    breaks = np.append(line.breaks, end + GRAVITY * end / BRAKE)
    return HandMotion(breaks, np.array(pieces), np.ones(len(breaks), dtype=bool))
