"""The same planning problem for optimisers that others wrote: the shortest motion of Section VIII-A within all limits.

scipy's SLSQP takes our own compiled figures and differentiates them by differences. CasADi with IPOPT gets the problem
written out again, symbolically and for a slide through the centre of mass, with exact derivatives.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize

from slidepipe.mechanics.dynamics import GRAVITY
from slidepipe.planning import assess_kernel as kernel
from slidepipe.planning.search import Search
from slidepipe.series import FloatArray

STEP = 1e-2
"""Of SLSQP's differences: durations are rounded to a tenth of a millisecond."""


@dataclass(frozen=True, slots=True)
class Answer:
    """A peer's motion: how long it takes, s, and whether it keeps every limit (by at most a per mille)."""

    length_s: float
    feasible: bool
    choice: FloatArray


def middle(search: Search) -> FloatArray:
    """A start that leans to no side: the middle of every range, times in their logarithms; the angle as it stands."""
    low, high = search.bounds
    return 0.5 * (low + high)


def by_slsqp(search: Search, start: FloatArray) -> Answer:
    """Minimise the time with scipy."""
    low, high = search.bounds

    def figures(x: FloatArray) -> FloatArray:
        return search.assess(np.clip(x, low, high)[None])[0]

    def within(x: FloatArray) -> FloatArray:
        told, bound = figures(x), search.limits
        load = (1.0 - search.wish.friction_error) * bound[5]
        return np.array(
            [
                1.0 - told[kernel.HAND_ACCELERATION] / bound[0],
                1.0 - told[kernel.HAND_SPEED] / bound[1],
                1.0 - told[kernel.OFF_CENTRE] / bound[4],
                1.0 - told[kernel.ARM_SHARE],
                load - told[kernel.LOAD_BEFORE],
                load - told[kernel.LOAD_AFTER],
            ]
        )

    found = minimize(
        lambda x: figures(x)[kernel.LENGTH_S],
        start,
        method="SLSQP",
        bounds=list(zip(low, high, strict=True)),
        constraints={"type": "ineq", "fun": within},
        options={"maxiter": 200, "eps": STEP, "ftol": 1e-5},
    )
    return _answer(search, np.clip(found.x, low, high))


def casadi_solver(search: Search) -> Callable[[FloatArray], Answer]:
    """Build IPOPT's problem once; what is returned solves it from a start.

    Raises
    ------
    ImportError
        casadi is not installed.
    """
    import casadi as ca  # noqa: PLC0415  # a peer that may be missing

    body, wish, bound = search.setup, search.wish, search.limits
    task, kappa = search.task, body.finger.mu * body.finger.f_N / body.block.m
    d, rho = (task.r_goal - task.r_start)[:2], body.finger.a * body.finger.c
    length = float(np.linalg.norm(d))
    x = ca.SX.sym("x", kernel.CHOICES)
    theta, T1, T2 = x[kernel.ANGLE], ca.exp(x[kernel.LOG_STICK]), ca.exp(x[kernel.LOG_TEAR])
    T3, Tc, T4 = T2 * ca.exp(x[kernel.LOG_BRAKE]), T2 * x[kernel.CATCH_SHARE], ca.exp(x[kernel.LOG_SETTLE])
    c, s = ca.cos(theta), ca.sin(theta)
    u = ca.vertcat(c * d[0] - s * d[1], s * d[0] + c * d[1]) / length
    down = ca.vertcat(0.0, -GRAVITY)
    tear = 2.0 * length / (T2 * (T2 + T3))
    brake = tear * T2 / T3
    hand_tear, hand_brake = u * (kappa + tear) + down, u * (kappa - brake) + down
    gained = (kappa * u + down) * (T2 + T3) + hand_brake * Tc
    sticking = -gained / (T1 + T4)
    start_velocity = sticking * T1
    top_velocity = start_velocity + hand_tear * T2
    turn = theta - task.q_o_start[2]

    def load(r: FloatArray, angle: object, acceleration: object, spin: object) -> object:
        ca_, sa = ca.cos(angle), ca.sin(angle)
        w_x, w_y = acceleration[0], acceleration[1] + GRAVITY
        f_x, f_y = ca_ * w_x + sa * w_y, -sa * w_x + ca_ * w_y
        moment = body.block.inertia / body.block.m * spin - r[0] * f_y + r[1] * f_x
        return ca.sqrt(f_x**2 + f_y**2 + (moment / rho) ** 2 + 1e-12) / kappa

    allowed = (1.0 - wish.friction_error) * bound[5]
    constraints, upper = [], []
    for share in np.linspace(0.0, 1.0, 5):
        angle = task.q_o_start[2] + turn * (3.0 * share**2 - 2.0 * share**3)
        spin = turn * (6.0 - 12.0 * share) / T1**2
        constraints.append(load(task.r_start, angle, sticking, spin))
        upper.append(allowed)
    constraints += [load(task.r_goal, theta, sticking, 0.0), load(task.r_goal, theta, hand_brake, 0.0)]
    upper += [allowed, allowed]
    for row in _joint_rows(search, ca, (hand_tear, hand_brake, sticking), (start_velocity, top_velocity)):
        constraints.append(row)
        upper.append(1.0)
    for acceleration in (hand_tear, hand_brake):
        if np.isfinite(bound[0]):
            constraints.append(ca.sumsqr(acceleration) / bound[0] ** 2)
            upper.append(1.0)
    constraints.append(ca.sumsqr(top_velocity) / bound[1] ** 2)
    upper.append(1.0)
    # More friction must not keep it from sliding, less must not carry it too far: the straight slide's formula.
    error = wish.friction_error
    constraints += [error * kappa / tear, (1.0 + error * kappa / tear) / (1.0 - error * kappa / brake) / 1.75]
    upper += [1.0, 1.0]
    low, high = search.bounds
    problem = {"x": x, "f": T1 + T2 + T3 + Tc + T4, "g": ca.vertcat(*constraints)}
    quiet = {"ipopt.print_level": 0, "print_time": 0, "ipopt.sb": "yes", "ipopt.tol": 1e-6}
    solver = ca.nlpsol("plan", "ipopt", problem, quiet)

    def solve(start: FloatArray) -> Answer:
        told = solver(x0=start, lbx=low, ubx=high, lbg=-np.inf, ubg=upper)
        return _answer(search, np.clip(np.array(told["x"]).ravel(), low, high))

    return solve


def _joint_rows(search: Search, ca: object, accelerations: tuple, velocities: tuple) -> list:
    """The arm's first order: torques and speeds of every joint beside their limits."""
    arm, rows = search.arm, []
    for joint in range(7):
        for acceleration in accelerations:
            torque = arm.torques[joint, 0] * acceleration[0] + arm.torques[joint, 1] * acceleration[1]
            rows.append(ca.fabs(torque + arm.weight_n_m[joint]) / arm.torque_n_m[joint])
        for velocity in velocities:
            speed = arm.rates[joint, 0] * velocity[0] + arm.rates[joint, 1] * velocity[1]
            rows.append(ca.fabs(speed) / arm.speed_rad_s[joint])
    return rows


def _answer(search: Search, choice: FloatArray) -> Answer:
    told = search.assess(choice[None])[0]
    return Answer(float(told[kernel.LENGTH_S]), bool(told[kernel.EXCESS] < 1e-3), choice)
