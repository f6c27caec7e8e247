"""Robust least squares of hand, block and friction: the normal equations, and Levenberg's steps through them.

A measured planar pose counts by Student's t of three dimensions over its weighted distance, so that an outlier pulls
less the farther it is. The hand's jerk and every parameter may be held by a normal prior; one that is infinitely
certain is a constant.
"""

import numpy as np
from numba import njit

from slidepipe.estimation.linear_kernel import factor, solve
from slidepipe.estimation.slide_kernel import hand_of, slide, sticking_start
from slidepipe.estimation.stage_kernel import FAST, PHYSICS, START

STICKS, FREE = 0, 1
"""How the block starts: held by the hand, or with a pose and a velocity of its own."""
GRAVITY = 9.81
CERTAIN = 1e24
"""Information of a constant."""
SMALLEST, LARGEST = 1e-10, 1e10
"""Of Levenberg's damping."""
SETTLED = 3e-3
"""A step that would gain less than this in twice the log-likelihood is not worth taking."""


@njit(**FAST)
def predict(z, frame, clock, curve, times, pose, jacobian, path):
    """Block at the sorted ``times`` for parameters z (P,).

    ``frame`` is kind of start, m/I; ``clock`` is first knot, knot interval, opening time, step, number of steps, and in
    how many of the first it sticks whatever friction it takes; ``curve`` the limit surface, None the ellipsoid.
    """
    count = (len(z) - START - PHYSICS) // 3
    c = z[: 3 * count].reshape(3, count)
    start, law = z[3 * count : 3 * count + START], z[3 * count + START :]
    physics = np.array(
        [
            np.exp(law[0]),
            np.exp(law[1]),
            frame[1],
            law[2],
            GRAVITY * np.sin(law[3]),
            -GRAVITY * np.cos(law[3]),
        ]
    )
    y, S = np.empty(6), np.zeros((6, len(z)))
    if frame[0] == STICKS:
        w, hand = np.empty((3, 4)), np.empty((2, 3))
        low = hand_of(c, clock[0], clock[1], clock[2], w, hand)
        sticking_start(start[:3], hand, w, low, clock[1], y, S)
    else:
        y[:] = start
        for i in range(6):
            S[i, 3 * count + i] = 1.0
    steps, held = int(clock[4]), int(clock[5])
    slide(c, clock[0], clock[1], y, S, clock[2], clock[3], steps, held, physics, curve, times, pose, jacobian, path)


@njit(**FAST)
def distances(z, clock, block, hand, pose, squares, hand_squares):
    """Squared weighted distances of the block's (M,) and the hand's (K,) poses, in place.

    ``block`` and ``hand`` are stamps, measured poses and their noise (3,).
    """
    _, measured, noise = block
    for t in range(len(measured)):
        squares[t] = 0.0
        for i in range(3):
            e = (pose[t, i] - measured[t, i]) / noise[i]
            squares[t] += e * e
    hand_times, hand_measured, hand_noise = hand
    count = (len(z) - START - PHYSICS) // 3
    c = z[: 3 * count].reshape(3, count)
    w, at = np.empty((3, 4)), np.empty((2, 3))
    for t in range(len(hand_times)):
        hand_of(c, clock[0], clock[1], hand_times[t], w, at)
        hand_squares[t] = 0.0
        for i in range(3):
            e = (at[0, i] - hand_measured[t, i]) / hand_noise[i]
            hand_squares[t] += e * e


@njit(**FAST)
def misfit(z, frame, clock, curve, block, hand, nu, pose, jacobian, path, squares, hand_squares):
    """Predict all poses and compare them; twice the negative log-likelihood, up to a constant."""
    predict(z, frame, clock, curve, block[0], pose, jacobian, path)
    distances(z, clock, block, hand, pose, squares, hand_squares)
    return cost_of(squares, nu) + cost_of(hand_squares, nu)


@njit(**FAST)
def prior_equations(z, knot, jerk, mean, information, H, g):
    """Add the hand's jerk, of density ``jerk`` (3,), and the parameters' priors to H and g; returns their cost."""
    count = (len(z) - START - PHYSICS) // 3
    cost = 0.0
    third = (-1.0, 3.0, -3.0, 1.0)
    for axis in range(3):
        scale = 1.0 / (knot**5 * jerk[axis])
        for k in range(count - 3):
            at = axis * count + k
            value = -z[at] + 3.0 * z[at + 1] - 3.0 * z[at + 2] + z[at + 3]
            cost += scale * value * value
            for i in range(4):
                g[at + i] += scale * third[i] * value
                for j in range(4):
                    H[at + i, at + j] += scale * third[i] * third[j]
    for i in range(len(z)):
        off = z[i] - mean[i]
        cost += information[i] * off * off
        g[i] += information[i] * off
        H[i, i] += information[i]
    return cost


@njit(**FAST)
def measured_equations(z, clock, block, hand, nu, pose, jacobian, squares, hand_squares, H, g):
    """Add what was measured to H and g."""
    _, measured, noise = block
    hand_times, hand_measured, hand_noise = hand
    count = (len(z) - START - PHYSICS) // 3
    size = len(z)
    for t in range(len(squares)):
        weight = (nu + 3.0) / (nu + squares[t])
        for i in range(3):
            scale = weight / (noise[i] * noise[i])
            e, row = pose[t, i] - measured[t, i], jacobian[t, i]
            for p in range(size):
                if row[p] != 0.0:
                    a = scale * row[p]
                    g[p] += a * e
                    for q in range(p, size):
                        H[p, q] += a * row[q]
    for p in range(size):
        for q in range(p):
            H[p, q] = H[q, p]
    w, at_hand = np.empty((3, 4)), np.empty((2, 3))
    c = z[: 3 * count].reshape(3, count)
    for t in range(len(hand_times)):
        low = hand_of(c, clock[0], clock[1], hand_times[t], w, at_hand)
        weight = (nu + 3.0) / (nu + hand_squares[t])
        for axis in range(3):
            scale = weight / (hand_noise[axis] * hand_noise[axis])
            e = at_hand[0, axis] - hand_measured[t, axis]
            for i in range(4):
                at = axis * count + low + i
                g[at] += scale * w[0, i] * e
                for j in range(4):
                    H[at, axis * count + low + j] += scale * w[0, i] * w[0, j]


@njit(**FAST)
def cost_of(squares, nu):
    """Twice the negative log-likelihood of squared weighted distances, up to a constant."""
    total = 0.0
    for t in range(len(squares)):
        total += (nu + 3.0) * np.log1p(squares[t] / nu)
    return total


@njit(**FAST)
def fit(z, frame, clock, curve, block, hand, jerk, mean, information, nu, most):
    """Find the most likely parameters from z on, in place.

    Returns the information matrix there, of which the second is the part of the priors, the squared distances of the
    block's and the hand's poses, the block's path, the step that was left to go, twice the negative log-likelihood,
    and the number of steps.
    """
    size, seen, knot = len(z), len(block[0]), clock[1]
    pose, path = np.empty((seen, 3)), np.empty((int(clock[4]) + 1, 7))
    jacobian, none = np.empty((seen, 3, size)), np.empty((0, 3, size))
    squares, hand_squares = np.empty(seen), np.empty(len(hand[0]))
    H, g, prior, waste = np.zeros((size, size)), np.zeros(size), np.zeros((size, size)), np.zeros(size)
    L, scale, step, trial = np.zeros((size, size)), np.empty(size), np.zeros(size), np.empty(size)
    damping, taken, cost = 1e-3, 0, np.inf
    while taken < most:
        taken += 1
        cost = misfit(z, frame, clock, curve, block, hand, nu, pose, jacobian, path, squares, hand_squares)
        H[:], g[:] = 0.0, 0.0
        measured_equations(z, clock, block, hand, nu, pose, jacobian, squares, hand_squares, H, g)
        cost += prior_equations(z, knot, jerk, mean, information, H, g)
        if not factor(H, SMALLEST, L, scale):
            break
        solve(L, scale, -g, step)
        if -np.dot(g, step) < SETTLED:
            break
        better = False
        while not better and damping < LARGEST:
            if factor(H, damping, L, scale):
                solve(L, scale, -g, step)
                trial[:] = z + step
                new = misfit(trial, frame, clock, curve, block, hand, nu, pose, none, path, squares, hand_squares)
                waste[:], prior[:] = 0.0, 0.0
                new += prior_equations(trial, knot, jerk, mean, information, prior, waste)
                better = new < cost
            damping = max(0.1 * damping, SMALLEST) if better else 10.0 * damping
        if not better:
            break
        z[:] = trial
    prior[:], waste[:] = 0.0, 0.0
    prior_equations(z, knot, jerk, mean, information, prior, waste)
    misfit(z, frame, clock, curve, block, hand, nu, pose, none, path, squares, hand_squares)
    factor(H, SMALLEST, L, scale)
    solve(L, scale, -g, step)
    return H, prior, squares, hand_squares, path, step, cost, taken


@njit(**FAST)
def bias_of(z, frame, clock, curve, block, nu, squares, covariance, scatter, signs):
    """Box's bias (P,) of the estimate: what second derivatives of the block's poses make of the noise.

    The trace of second derivatives times ``scatter``, the covariance of the estimate from the noise alone, is the mean
    of second differences along random combinations of its factor, by rows of ``signs`` (K, P).
    """
    times, _, noise = block
    size, steps = len(z), int(clock[4])
    pose, ahead, behind = np.empty((len(times), 3)), np.empty((len(times), 3)), np.empty((len(times), 3))
    path, curved = np.empty((steps + 1, 7)), np.zeros((len(times), 3))
    jacobian, none = np.empty((len(times), 3, size)), np.empty((0, 3, size))
    predict(z, frame, clock, curve, times, pose, jacobian, path)
    L, scale, direction = np.zeros((size, size)), np.empty(size), np.empty(size)
    factor(scatter, 1e-9, L, scale)
    for k in range(len(signs)):
        for i in range(size):
            direction[i] = 0.0
            for j in range(i + 1):
                direction[i] += L[i, j] * signs[k, j]
            direction[i] /= scale[i]
        predict(z + direction, frame, clock, curve, times, ahead, none, path)
        predict(z - direction, frame, clock, curve, times, behind, none, path)
        curved += ahead + behind - 2.0 * pose
    gradient = np.zeros(size)
    for t in range(len(times)):
        weight = (nu + 3.0) / (nu + squares[t])
        for i in range(3):
            pull = weight * curved[t, i] / (len(signs) * noise[i] * noise[i])
            for p in range(size):
                gradient[p] += pull * jacobian[t, i, p]
    bias = np.zeros(size)
    for i in range(size):
        for j in range(size):
            bias[i] -= 0.5 * covariance[i, j] * gradient[j]
    return bias
