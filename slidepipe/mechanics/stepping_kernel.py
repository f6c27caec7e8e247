"""Implicit time stepping of an object in n soft fingers of one hand: unconditionally stable, and sticking is exact.

Over a step h the hand moves from one sample to the next, and each contact's force is such that at the end of the step
it either has the hand's velocity or slides along its own friction (see :mod:`slidepipe.mechanics.contact_kernel`). One
contact is solved outright, several in turn until none changes; where that takes long, close to sticking, all at once
(see :mod:`slidepipe.mechanics.norm_kernel`). The state is the relative pose r_f_b and the object's
velocity: where every contact sticks, r_f_b stays the same to the last bit.

``contacts`` (n, 4) holds mu f_N, c a, and the place of each in {f}; ``shapes`` and ``curves`` are those of
:mod:`slidepipe.mechanics.norm_kernel`.
"""

import numpy as np
from numba import njit, prange

from slidepipe.mechanics.contact_kernel import contact_force
from slidepipe.mechanics.norm_kernel import frictions, share_used, smallest_sum

FAST = {"cache": True, "error_model": "numpy", "fastmath": {"contract", "arcp", "nsz"}}
GRAVITY = 9.81
SWEEPS = 60
SETTLED = 1e-13
"""Share of the largest force below which a change in it ends the sweeps."""
STUCK = 1e-9
"""Share of what friction changes in a step below which a sliding velocity is rounding, and all contacts stick."""


@njit(**FAST)
def force_of(shape, curves, inverse_m, inverse_i, force, rho, r_x, r_y, b_x, b_y, b_w, k):
    """:func:`contact_force` of a contact of any shape."""
    if shape < 0:
        return contact_force(None, inverse_m, inverse_i, force, rho, r_x, r_y, b_x, b_y, b_w, k)
    return contact_force(curves[shape], inverse_m, inverse_i, force, rho, r_x, r_y, b_x, b_y, b_w, k)


@njit(**FAST)
def step_one(h, inverse_m, inverse_i, contact, curve, q_f, moved, r, v, k):
    """One step with one contact at the origin of {f}; ``moved`` is the hand's velocity. Returns k, zero if it stuck."""
    theta = q_f[2] - r[2]
    c, s = np.cos(theta), np.sin(theta)
    r_x, r_y = c * r[0] - s * r[1], s * r[0] + c * r[1]
    v[1] -= h * GRAVITY
    b_x = moved[0] - v[0] + v[2] * r_y
    b_y = moved[1] - v[1] - v[2] * r_x
    b_w = moved[2] - v[2]
    h_m, h_i = h * inverse_m, h * inverse_i
    f_x, f_y, m_z, k = contact_force(curve, h_m, h_i, contact[0], contact[1], r_x, r_y, b_x, b_y, b_w, k)
    v[0] += h_m * f_x
    v[1] += h_m * f_y
    v[2] += h_i * (m_z + r_x * f_y - r_y * f_x)
    if k > 0.0:
        d_x = moved[0] - v[0] + v[2] * r_y
        d_y = moved[1] - v[1] - v[2] * r_x
        r[0] += h * (c * d_x + s * d_y)
        r[1] += h * (-s * d_x + c * d_y)
        r[2] += h * (moved[2] - v[2])
    return k


@njit(**FAST)
def sweep(h, inverse_m, inverse_i, contacts, shapes, curves, offsets, moved, v, forces):
    """Solve the contacts in turn once; returns the largest change of a force and whether any slides."""
    change, slides = 0.0, False
    for i in range(len(contacts)):
        x, y = offsets[i, 0], offsets[i, 1]
        f_x, f_y, m_z = forces[i, 0], forces[i, 1], forces[i, 2]
        v[0] -= h * inverse_m * f_x
        v[1] -= h * inverse_m * f_y
        v[2] -= h * inverse_i * (m_z + x * f_y - y * f_x)
        b_x = moved[0] - moved[2] * offsets[i, 3] - v[0] + v[2] * y
        b_y = moved[1] + moved[2] * offsets[i, 2] - v[1] - v[2] * x
        h_m, h_i, b_w = h * inverse_m, h * inverse_i, moved[2] - v[2]
        f_x, f_y, m_z, k = force_of(
            shapes[i], curves, h_m, h_i, contacts[i, 0], contacts[i, 1], x, y, b_x, b_y, b_w, 0.0
        )
        v[0] += h * inverse_m * f_x
        v[1] += h * inverse_m * f_y
        v[2] += h * inverse_i * (m_z + x * f_y - y * f_x)
        share = abs(f_x - forces[i, 0]) + abs(f_y - forces[i, 1]) + abs(m_z - forces[i, 2]) / contacts[i, 1]
        change = max(change, share / contacts[i, 0])
        forces[i, 0], forces[i, 1], forces[i, 2] = f_x, f_y, m_z
        slides = slides or k > 0.0
    return change, slides


@njit(**FAST)
def moves(h, inverse_m, inverse_i, contacts, hand, v):
    """Whether the object's velocity differs from the hand's, at the CoM; if not, it becomes the same."""
    force, moment = 0.0, 0.0
    for i in range(len(contacts)):
        force += contacts[i, 0]
        moment += contacts[i, 0] * contacts[i, 1]
    along = max(abs(hand[0] - v[0]), abs(hand[1] - v[1]))
    if along > STUCK * h * inverse_m * force or abs(hand[2] - v[2]) > STUCK * h * inverse_i * moment:
        return True
    v[0], v[1], v[2] = hand[0], hand[1], hand[2]
    return False


@njit(**FAST)
def hold(h, inverse_m, inverse_i, contacts, shapes, curves, offsets, hand, v, forces):
    """Try whether the contacts hold the object, each by its stiffness S_i^2; if so, v and forces are set to that.

    Where this sharing of the load fails another may hold it: then it is for the sweeps to find.
    """
    w_x, w_y = (hand[0] - v[0]) / (h * inverse_m), (hand[1] - v[1]) / (h * inverse_m)
    w_t = (hand[2] - v[2]) / (h * inverse_i)
    total, mean_x, mean_y, spin = 0.0, 0.0, 0.0, 0.0
    for i in range(len(contacts)):
        square, x, y = contacts[i, 0] ** 2, offsets[i, 0], offsets[i, 1]
        total += square
        mean_x += square * x
        mean_y += square * y
        spin += square * (contacts[i, 1] ** 2 + x * x + y * y)
    mean_x, mean_y = mean_x / total, mean_y / total
    turn = (w_t + mean_y * w_x - mean_x * w_y) / (spin - total * (mean_x * mean_x + mean_y * mean_y))
    along_x, along_y = w_x / total + mean_y * turn, w_y / total - mean_x * turn
    for i in range(len(contacts)):
        d_x, d_y = along_x - offsets[i, 1] * turn, along_y + offsets[i, 0] * turn
        force = contacts[i, 0]
        if share_used(shapes[i], curves, force * d_x, force * d_y, force * contacts[i, 1] * turn) > 1.0:
            return False
    for i in range(len(contacts)):
        square = contacts[i, 0] ** 2
        forces[i, 0] = square * (along_x - offsets[i, 1] * turn)
        forces[i, 1] = square * (along_y + offsets[i, 0] * turn)
        forces[i, 2] = square * contacts[i, 1] ** 2 * turn
    v[0], v[1], v[2] = hand[0], hand[1], hand[2]
    return True


@njit(**FAST)
def settle(h, inverse_m, inverse_i, contacts, shapes, curves, offsets, hand, v, forces):
    """Solve all contacts at once; ``hand`` is the hand's velocity at the CoM. Returns (residual, whether they slide).

    Of the relative velocities x at the CoM, the one that minimises |x - x_free|_M^2 / 2 h + sum_i h_i(S_i G_i^T x), h_i
    the norm for an ellipsoid.
    """
    n = len(contacts)
    K, e, x, g = np.zeros((n, 3, 3)), np.empty((n, 3)), np.empty(3), np.empty((n, 3))
    free, root_m, root_i = np.empty(3), np.sqrt(h * inverse_m), np.sqrt(h * inverse_i)
    for i in range(n):
        a, b = offsets[i, 0], offsets[i, 1]
        v[0] -= h * inverse_m * forces[i, 0]
        v[1] -= h * inverse_m * forces[i, 1]
        v[2] -= h * inverse_i * (forces[i, 2] + a * forces[i, 1] - b * forces[i, 0])
    for axis in range(3):
        free[axis] = hand[axis] - v[axis]
    for i in range(n):
        force, moment = contacts[i, 0], contacts[i, 0] * contacts[i, 1]
        a, b = offsets[i, 0], offsets[i, 1]
        K[i, 0, 0], K[i, 0, 2], e[i, 0] = force * root_m, -force * b * root_i, force * (free[0] - b * free[2])
        K[i, 1, 1], K[i, 1, 2], e[i, 1] = force * root_m, force * a * root_i, force * (free[1] + a * free[2])
        K[i, 2, 2], e[i, 2] = moment * root_i, moment * free[2]
    smallest_sum(1.0, K, e, x, g, shapes, curves)
    slip, whole, residual, best = 0.0, 0.0, 0.0, np.empty((1, 1, 3))
    for i in range(n):
        z = K[i] @ x + e[i]
        size = np.sqrt(z[0] * z[0] + z[1] * z[1] + z[2] * z[2])
        slip, whole = max(slip, size), max(whole, np.sqrt(e[i, 0] ** 2 + e[i, 1] ** 2 + e[i, 2] ** 2))
        if size > 0.0:
            frictions(shapes[i : i + 1], curves, z.reshape(1, 1, 3), best)
            residual = max(residual, np.max(np.abs(best[0, 0] - g[i])))
    for i in range(n):
        forces[i, 0], forces[i, 1] = contacts[i, 0] * g[i, 0], contacts[i, 0] * g[i, 1]
        forces[i, 2] = contacts[i, 0] * contacts[i, 1] * g[i, 2]
    slides = slip > STUCK * whole
    # The object's velocity is told by x, and where it sticks by the hand alone.
    v[0] = hand[0] - (free[0] + root_m * x[0] if slides else 0.0)
    v[1] = hand[1] - (free[1] + root_m * x[1] if slides else 0.0)
    v[2] = hand[2] - (free[2] + root_i * x[2] if slides else 0.0)
    return (residual if slides else 0.0), slides


@njit(**FAST)
def step_many(h, inverse_m, inverse_i, contacts, shapes, curves, q_f, moved, r, v, offsets, forces, hand):
    """One step with several contacts; returns how much they disagree, as a share of their friction."""
    theta = q_f[2] - r[2]
    c, s = np.cos(theta), np.sin(theta)
    r_x, r_y = c * r[0] - s * r[1], s * r[0] + c * r[1]
    c_f, s_f = np.cos(q_f[2]), np.sin(q_f[2])
    for i in range(len(contacts)):
        offsets[i, 2] = c_f * contacts[i, 2] - s_f * contacts[i, 3]
        offsets[i, 3] = s_f * contacts[i, 2] + c_f * contacts[i, 3]
        offsets[i, 0], offsets[i, 1] = r_x + offsets[i, 2], r_y + offsets[i, 3]
    v[1] -= h * GRAVITY
    hand[0], hand[1], hand[2] = moved[0] + moved[2] * r_y, moved[1] - moved[2] * r_x, moved[2]
    if hold(h, inverse_m, inverse_i, contacts, shapes, curves, offsets, hand, v, forces):
        return 0.0
    for i in range(len(contacts)):
        # Start from the last step's forces: the object's velocity is told with them.
        v[0] += h * inverse_m * forces[i, 0]
        v[1] += h * inverse_m * forces[i, 1]
        v[2] += h * inverse_i * (forces[i, 2] + offsets[i, 0] * forces[i, 1] - offsets[i, 1] * forces[i, 0])
    change, slides = 1.0, True
    for _ in range(SWEEPS):
        change, slides = sweep(h, inverse_m, inverse_i, contacts, shapes, curves, offsets, moved, v, forces)
        if change < SETTLED:
            slides = slides and moves(h, inverse_m, inverse_i, contacts, hand, v)
            break
    if change >= SETTLED:
        change, slides = settle(h, inverse_m, inverse_i, contacts, shapes, curves, offsets, hand, v, forces)
    if slides:
        d_x = moved[0] - v[0] + v[2] * r_y
        d_y = moved[1] - v[1] - v[2] * r_x
        r[0] += h * (c * d_x + s * d_y)
        r[1] += h * (-s * d_x + c * d_y)
        r[2] += h * (moved[2] - v[2])
    return change


@njit(**FAST)
def run_lone(time_s, q_f, m, inertia, contact, curve, r, v, path):
    """:func:`run_samples` for one contact at the origin of {f}; ``curve`` tells its surface, None an ellipsoid."""
    moved, k, slid = np.empty(3), 0.0, 0
    inverse_m, inverse_i = 1.0 / m, 1.0 / inertia
    if len(path):
        path[0] = r
    for step in range(len(time_s) - 1):
        h = time_s[step + 1] - time_s[step]
        rate = 1.0 / h
        for axis in range(3):
            moved[axis] = (q_f[step + 1, axis] - q_f[step, axis]) * rate
        r_0, r_1, r_2 = r[0], r[1], r[2]
        k = step_one(h, inverse_m, inverse_i, contact, curve, q_f[step], moved, r, v, k)
        slid += r_0 != r[0] or r_1 != r[1] or r_2 != r[2]
        if len(path):
            for axis in range(3):
                path[step + 1, axis] = r[axis]
    return slid, 0.0


@njit(**FAST)
def run_samples(time_s, q_f, m, inertia, contacts, shapes, curves, r, v, path):
    """Step through the samples of a hand, (T,) and (T, 3); ``path`` (T, 3) receives r_f_b, or is empty.

    Returns (steps that slid, largest residual of the sweeps).
    """
    moved, hand, slid, residual = np.empty(3), np.empty(3), 0, 0.0
    offsets, forces = np.empty((len(contacts), 4)), np.zeros((len(contacts), 3))
    inverse_m, inverse_i = 1.0 / m, 1.0 / inertia
    if len(path):
        path[0] = r
    for step in range(len(time_s) - 1):
        h = time_s[step + 1] - time_s[step]
        rate = 1.0 / h
        for axis in range(3):
            moved[axis] = (q_f[step + 1, axis] - q_f[step, axis]) * rate
        r_0, r_1, r_2 = r[0], r[1], r[2]
        apart = step_many(
            h, inverse_m, inverse_i, contacts, shapes, curves, q_f[step], moved, r, v, offsets, forces, hand
        )
        residual = max(residual, apart)
        slid += r_0 != r[0] or r_1 != r[1] or r_2 != r[2]
        if len(path):
            for axis in range(3):
                path[step + 1, axis] = r[axis]
    return slid, residual


@njit(parallel=True, **FAST)
def run_lone_batch(time_s, q_f, bodies, contacts, curve, r, v):
    """Many parameter sets on all cores: ``bodies`` (N, 3) m, I, hand scale; ``contacts`` (N, 2); r and v (N, 3)."""
    for trial in prange(len(bodies)):
        scaled = q_f[0] + bodies[trial, 2] * (q_f - q_f[0])
        m, inertia, path = bodies[trial, 0], bodies[trial, 1], np.empty((0, 3))
        run_lone(time_s, scaled, m, inertia, contacts[trial], curve, r[trial], v[trial], path)
