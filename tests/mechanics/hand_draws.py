"""Hands, and blocks in them, for the tests of the simulations."""

from dataclasses import replace

import numpy as np
from hypothesis import strategies as st
from paper_cases import BLOCK, LINEAR, ROTATIONAL, linear_finger, rotational_finger

from slidepipe.mechanics.dynamics import Block
from slidepipe.mechanics.hand_motion import HandMotion
from slidepipe.mechanics.planar import object_pose, rotation
from slidepipe.planning.three_phase import ThreePhaseMotion

CASES = {"linear": (LINEAR, linear_finger()), "rotational": (ROTATIONAL, rotational_finger())}
HANDS = {name: ThreePhaseMotion(regrasp, BLOCK, finger).hand_motion() for name, (regrasp, finger) in CASES.items()}
STARTS = st.builds(
    lambda x, y, t: np.array([x, y, t]), st.floats(-0.02, 0.02), st.floats(-0.03, 0.03), st.floats(-3, 3)
)
SPEEDS = st.builds(lambda *v: np.array(v), st.floats(-1, 1), st.floats(-1, 1), st.floats(-10, 10))
SHAKES = st.lists(st.tuples(st.floats(-30, 30), st.floats(-30, 30), st.floats(-300, 300)), min_size=1, max_size=4)


def shaken(accelerations: list[tuple[float, float, float]], spell_s: float = 0.05) -> HandMotion:
    """A hand that takes one acceleration after another, each forth, back twice as long and forth again."""
    q, dq, pieces = np.zeros(3), np.zeros(3), []
    for ddq in np.array(accelerations):
        for sign in (1.0, -1.0, -1.0, 1.0):
            pieces.append([q, dq, 0.5 * sign * ddq])
            q, dq = q + dq * spell_s + 0.5 * sign * ddq * spell_s**2, dq + sign * ddq * spell_s
    breaks = spell_s * np.arange(len(pieces) + 1)
    return HandMotion(breaks, np.array(pieces), np.ones(len(breaks), dtype=bool))


def seen_from(hand: HandMotion, offset: np.ndarray, mirror: float = 1.0) -> HandMotion:
    """The same motion elsewhere, and mirrored about the vertical if ``mirror`` is -1."""
    coefficients = hand.coefficients * np.array([mirror, 1.0, mirror])
    coefficients[:, 0] += offset
    return replace(hand, coefficients=coefficients)


def stopped(velocity: np.ndarray) -> HandMotion:
    """A hand that comes up to a velocity in 0.1 s and stops within a millisecond."""
    up, down = 0.5 * velocity / 0.1, -0.5 * velocity / 1e-3
    pieces = [[np.zeros(3), np.zeros(3), up], [0.05 * velocity, velocity, down]]
    return HandMotion(np.array([0.0, 0.1, 0.101]), np.array(pieces), np.ones(3, dtype=bool))


def energy(block: Block, q_f: np.ndarray, r_b: np.ndarray, dr_b: np.ndarray) -> np.ndarray:
    """Mechanical energy (T,) of a block that slides, (T, 3) in {b}, in a hand that rests at ``q_f``."""
    q_o = object_pose(q_f, r_b)
    arm, slip = (np.einsum("tij,tj->ti", rotation(q_o[:, 2]), values * [1.0, 1.0, 0.0]) for values in (r_b, dr_b))
    omega = -dr_b[:, 2]
    v_x, v_y = -slip[:, 0] + omega * arm[:, 1], -slip[:, 1] - omega * arm[:, 0]
    return 0.5 * block.m * (v_x**2 + v_y**2) + 0.5 * block.inertia * omega**2 + block.m * 9.81 * q_o[:, 1]


def samples(hand: HandMotion, step_s: float, rest_s: float = 0.1) -> tuple[np.ndarray, np.ndarray]:
    """Times from the start to a rest after the end, and the hand's poses."""
    time_s = step_s * np.arange(round((hand.breaks[-1] + rest_s) / step_s) + 1)
    return time_s, hand.at(time_s)
