"""A hand motion that is the same to the last bit wherever it is computed.

Libraries of linear algebra sum in an order that depends on where an array lies in memory, so that the same plan differs
in its last bits from one process to the next. Here its poses are rounded to a grid that no arm could tell apart, and
the polynomials through them are found by plain arithmetic, one operation after the other.
"""

import math

import numpy as np

from slidepipe.mechanics.hand_motion import HandMotion

GRID = 2.0**-36
"""1.5e-11 m or rad: that the last bits of a pose decide where it is rounded to is a chance of one in 100,000."""


def rounded(hand: HandMotion) -> HandMotion:
    """Motion through the same poses, rounded to :data:`GRID`, at the Chebyshev nodes of every piece.

    Examples
    --------
    >>> t = np.linspace(0.0, 1.0, 3)
    >>> hand = HandMotion.from_samples(t, np.stack([t**3, t, 0 * t], 1), np.stack([3 * t**2, t**0, 0 * t], 1),
    ...                                np.stack([6 * t, 0 * t, 0 * t], 1))
    >>> bool(np.abs(rounded(hand).at(np.array([0.3])) - hand.at(np.array([0.3]))).max() < 1e-10)
    True
    """
    coefficients = np.empty_like(hand.coefficients)
    for piece, (start, stop) in enumerate(zip(hand.breaks[:-1].tolist(), hand.breaks[1:].tolist(), strict=True)):
        nodes = _nodes(hand.degree, stop - start)
        for axis in range(3):
            powers = hand.coefficients[piece, :, axis].tolist()
            values = [round(_value(powers, node) / GRID) * GRID for node in nodes]
            coefficients[piece, :, axis] = _interpolate(nodes, values)
    return HandMotion(hand.breaks, coefficients, hand.jumps)


def _nodes(degree: int, length: float) -> list[float]:
    return [0.5 * length * (1.0 - math.cos(math.pi * k / degree)) for k in range(degree + 1)]


def _value(powers: list[float], t: float) -> float:
    total = 0.0
    for power in reversed(powers):
        total = total * t + power
    return total


def _interpolate(nodes: list[float], values: list[float]) -> list[float]:
    """Powers of the polynomial through some points: Newton's divided differences, multiplied out."""
    differences = list(values)
    for order in range(1, len(nodes)):
        for k in range(len(nodes) - 1, order - 1, -1):
            differences[k] = (differences[k] - differences[k - 1]) / (nodes[k] - nodes[k - order])
    powers = [0.0] * len(nodes)
    for node, difference in zip(reversed(nodes), reversed(differences), strict=True):
        powers = [low - node * high for low, high in zip([0.0, *powers[:-1]], powers, strict=True)]
        powers[0] += difference
    return powers
