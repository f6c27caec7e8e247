"""Implicit time stepping of an object in n soft fingers of one hand: unconditionally stable, and sticking is exact.

Over a step h the hand moves from one sample to the next, and each contact's force is such that at the end of the step
it either has the hand's velocity or slides along its own friction (see :mod:`slidepipe.mechanics.contact_kernel`). One
contact is solved outright, several in turn until none changes. The state is the relative pose r_f_b and the object's
velocity: where every contact sticks, r_f_b stays the same to the last bit.
"""

import numpy as np
from numba import njit, prange

from slidepipe.mechanics.contact_kernel import contact_force

FAST = {"cache": True, "error_model": "numpy", "fastmath": {"contract", "arcp", "nsz"}}
GRAVITY = 9.81
SWEEPS = 400
SETTLED = 1e-13
"""Share of the largest force below which a change in it ends the sweeps."""


@njit(**FAST)
def step_one(h, inverse_m, inverse_i, contact, q_f, moved, r, v, k):
    """One step with one contact at the origin of {f}; ``moved`` is the hand's velocity. Returns k, zero if it stuck."""
    theta = q_f[2] - r[2]
    c, s = np.cos(theta), np.sin(theta)
    r_x, r_y = c * r[0] - s * r[1], s * r[0] + c * r[1]
    v[1] -= h * GRAVITY
    b_x = moved[0] - v[0] + v[2] * r_y
    b_y = moved[1] - v[1] - v[2] * r_x
    b_w = moved[2] - v[2]
    f_x, f_y, m_z, k = contact_force(h * inverse_m, h * inverse_i, contact[0], contact[1], r_x, r_y, b_x, b_y, b_w, k)
    v[0] += h * inverse_m * f_x
    v[1] += h * inverse_m * f_y
    v[2] += h * inverse_i * (m_z + r_x * f_y - r_y * f_x)
    if k > 0.0:
        d_x = moved[0] - v[0] + v[2] * r_y
        d_y = moved[1] - v[1] - v[2] * r_x
        r[0] += h * (c * d_x + s * d_y)
        r[1] += h * (-s * d_x + c * d_y)
        r[2] += h * (moved[2] - v[2])
    return k


@njit(**FAST)
def sweep(h, inverse_m, inverse_i, contacts, offsets, moved, v, forces):
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
        f_x, f_y, m_z, k = contact_force(
            h * inverse_m, h * inverse_i, contacts[i, 0], contacts[i, 1], x, y, b_x, b_y, moved[2] - v[2], 0.0
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
def step_many(h, inverse_m, inverse_i, contacts, q_f, moved, r, v, offsets, forces):
    """One step with several contacts; ``contacts`` (n, 4) holds mu f_N, c a, and the place of each in {f}.

    Returns how much the last sweep still changed.
    """
    theta = q_f[2] - r[2]
    c, s = np.cos(theta), np.sin(theta)
    r_x, r_y = c * r[0] - s * r[1], s * r[0] + c * r[1]
    c_f, s_f = np.cos(q_f[2]), np.sin(q_f[2])
    for i in range(len(contacts)):
        offsets[i, 2] = c_f * contacts[i, 2] - s_f * contacts[i, 3]
        offsets[i, 3] = s_f * contacts[i, 2] + c_f * contacts[i, 3]
        offsets[i, 0], offsets[i, 1] = r_x + offsets[i, 2], r_y + offsets[i, 3]
        # Start from the last step's forces: the object's velocity is told with them.
        v[0] += h * inverse_m * forces[i, 0]
        v[1] += h * inverse_m * forces[i, 1]
        v[2] += h * inverse_i * (forces[i, 2] + offsets[i, 0] * forces[i, 1] - offsets[i, 1] * forces[i, 0])
    v[1] -= h * GRAVITY
    change, slides = 1.0, True
    for _ in range(SWEEPS):
        change, slides = sweep(h, inverse_m, inverse_i, contacts, offsets, moved, v, forces)
        if change < SETTLED:
            break
    if slides:
        d_x = moved[0] - v[0] + v[2] * r_y
        d_y = moved[1] - v[1] - v[2] * r_x
        r[0] += h * (c * d_x + s * d_y)
        r[1] += h * (-s * d_x + c * d_y)
        r[2] += h * (moved[2] - v[2])
    return change


@njit(**FAST)
def run_samples(time_s, q_f, m, inertia, contacts, r, v, path):
    """Step through the samples of a hand, (T,) and (T, 3); ``path`` (T, 3) receives r_f_b, or is empty.

    Returns (steps that slid, largest residual of the sweeps).
    """
    moved, k, slid, residual = np.empty(3), 0.0, 0, 0.0
    offsets, forces = np.empty((len(contacts), 4)), np.zeros((len(contacts), 3))
    if len(path):
        path[0] = r
    for step in range(len(time_s) - 1):
        h = time_s[step + 1] - time_s[step]
        for axis in range(3):
            moved[axis] = (q_f[step + 1, axis] - q_f[step, axis]) / h
        before = r[0]
        if len(contacts) == 1 and contacts[0, 2] == 0.0 and contacts[0, 3] == 0.0:
            k = step_one(h, 1.0 / m, 1.0 / inertia, contacts[0], q_f[step], moved, r, v, k)
        else:
            residual = max(
                residual, step_many(h, 1.0 / m, 1.0 / inertia, contacts, q_f[step], moved, r, v, offsets, forces)
            )
        slid += before != r[0]
        if len(path):
            path[step + 1] = r
    return slid, residual


@njit(parallel=True, **FAST)
def run_samples_batch(time_s, q_f, bodies, contacts, r, v):
    """Many parameter sets on all cores: ``bodies`` (N, 3) m, I, hand scale; ``contacts`` (N, n, 4); r and v (N, 3)."""
    for trial in prange(len(bodies)):
        scaled = q_f[0] + bodies[trial, 2] * (q_f - q_f[0])
        run_samples(
            time_s, scaled, bodies[trial, 0], bodies[trial, 1], contacts[trial], r[trial], v[trial], np.empty((0, 3))
        )
