"""Section III's experiment carried out by the planar simulation, which knows nothing of its closed forms.

A hand that falls freely feels no gravity. It moves along the horizontal through the object's centre of mass, so that
friction does not turn the object: what is left of the plane is one degree of freedom.
"""

import numpy as np

from slidepipe.mechanics.dynamics import GRAVITY, Block
from slidepipe.mechanics.hand_motion import HandMotion
from slidepipe.mechanics.limit_surface import SoftFinger
from slidepipe.mechanics.one_dof import Profile
from slidepipe.mechanics.simulate import simulate
from slidepipe.series import FloatArray

TOLERANCE = 1e-13
"""Error of a step, m: trial after trial what is left to slide becomes shorter."""
LENGTHS = 1e6
"""Length of the block in intended slides: Section III's object has no edge."""
FINGER_A_M, FINGER_C = 0.02, 0.6
"""Of the contact, which resists a turning that does not happen."""


def falling_hand(profile: Profile, rest_s: float) -> HandMotion:
    """The finger's motion along x in free fall, and ``rest_s`` more of the fall without moving along x."""
    line = profile.finger
    breaks = np.append(line.breaks, line.breaks[-1] + rest_s)
    x = np.vstack([line.coefficients, [float(line.at(line.breaks[-1])), 0.0, 0.0]])
    coefficients = np.zeros((len(x), 3, 3))
    coefficients[:, :, 0] = x
    for piece, start in enumerate(breaks[:-1]):
        coefficients[piece, :, 1] = -0.5 * GRAVITY * start**2, -GRAVITY * start, -0.5 * GRAVITY
    return HandMotion(breaks, coefficients, np.ones(len(breaks), dtype=bool))


def stopping_time(profile: Profile, a_o: float) -> float:
    """Time after the motion's end, s, within which an object rests whose friction gives it ``a_o``."""
    fastest = profile.accelerations.a * profile.T1
    return 2.0 * fastest / a_o + 0.01


def simulated_slide(profile: Profile, *, mu: float, f_N: float, m: float) -> float:
    """How far the finger slides, m, in ``profile``'s motion under an actual friction, by planar simulation.

    Parameters
    ----------
    profile : Profile
        The finger's motion, whatever friction it was planned for.
    mu, f_N, m : float
        Actual friction, normal force in N and mass in kg.

    Raises
    ------
    InputError
        A value that is not positive.

    Examples
    --------
    >>> from slidepipe.mechanics.one_dof import Accelerations
    >>> profile = Profile(Accelerations(a_f=20.0, a_o=5.0, a=4.0), d_goal=-0.1)
    >>> round(simulated_slide(profile, mu=0.6, f_N=10.0, m=1.0), 9)
    -0.084
    """
    rest_s = stopping_time(profile, mu * f_N / m)
    hand = falling_hand(profile, rest_s)
    side = LENGTHS * abs(profile.d_goal)
    outcome = simulate(
        hand,
        Block(side, side, m),
        SoftFinger(mu, f_N, FINGER_A_M, FINGER_C),
        _AT_CENTRE,
        tolerance=TOLERANCE,
        until_s=float(hand.breaks[-1]),
    )
    return float(outcome.r_f_b[0])


_AT_CENTRE: FloatArray = np.zeros(3)
