"""The same planning problem for optimisers that others wrote: the shortest motion of Section VIII-A within all limits.

scipy's SLSQP takes our own compiled figures and differentiates them by differences. CasADi with IPOPT gets the problem
written out again, symbolically and for a slide through the centre of mass, with exact derivatives.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import minimize

from slidepipe.arm import wam
from slidepipe.mechanics.dynamics import GRAVITY
from slidepipe.planning import assess_kernel as kernel
from slidepipe.planning.arm_kernel import FAR_M, FAR_RAD
from slidepipe.planning.search import Search
from slidepipe.series import FloatArray

STEP = 1e-2
"""Of SLSQP's differences: durations are rounded to a tenth of a millisecond."""


@dataclass(frozen=True, slots=True)
class Answer:
    """A peer's motion: how long it takes, s, and by what share it breaks the limits, as our own figures tell."""

    length_s: float
    excess: float
    choice: FloatArray


def middle(search: Search) -> FloatArray:
    """A start that leans to no side: the middle of every range, times in their logarithms; the angle as it stands."""
    low, high = search.bounds
    return 0.5 * (low + high)


def by_slsqp(search: Search, start: FloatArray) -> Answer:
    """Minimise the time with scipy."""
    low, high = search.bounds

    def figures(x: FloatArray) -> FloatArray:
        return search.assess_one(np.clip(x, low, high))

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
    turns = _Turning(task.q_o_start[2], turn, T1, task.r_start)
    moving = _Moving(ca, T1, (T2, T3, Tc, T4), (hand_tear, hand_brake, hand_brake, sticking))
    for node in (*turns.nodes(ca, sticking), *moving.nodes(turns.end(ca, sticking))):
        for row in _arm_rows(search, ca, node):
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


@dataclass(frozen=True, slots=True)
class _Node:
    """The hand's pose, velocity and acceleration, each (3,) symbolic."""

    pose: Any
    velocity: Any
    acceleration: Any


@dataclass(frozen=True, slots=True)
class _Turning:
    """The hand while the object sticks and is brought to speed and turned on a cubic."""

    angle: float
    turn: Any
    duration: Any
    r: FloatArray

    def nodes(self, ca: Any, acceleration: Any) -> list[_Node]:
        """At the start, in the middle and at the end."""
        return [self._at(ca, acceleration, share) for share in (0.0, 0.5, 1.0)]

    def end(self, ca: Any, acceleration: Any) -> _Node:
        """Where the slide starts."""
        return self._at(ca, acceleration, 1.0)

    def _at(self, ca: Any, acceleration: Any, share: float) -> _Node:
        t = share * self.duration
        angle = self.angle + self.turn * (3.0 * share**2 - 2.0 * share**3)
        rate = self.turn * (6.0 * share - 6.0 * share**2) / self.duration
        change = self.turn * (6.0 - 12.0 * share) / self.duration**2
        c, s = ca.cos(angle), ca.sin(angle)
        arm = ca.vertcat(c * self.r[0] - s * self.r[1], s * self.r[0] + c * self.r[1])
        across = ca.vertcat(-arm[1], arm[0])
        return _Node(
            ca.vertcat(0.5 * t**2 * acceleration + arm, angle + self.r[2]),
            ca.vertcat(t * acceleration + rate * across, rate),
            ca.vertcat(acceleration + change * across - rate**2 * arm, change),
        )


@dataclass(frozen=True, slots=True)
class _Moving:
    """The hand over phases of constant acceleration, in which it does not turn."""

    ca: Any
    before: Any
    durations: tuple[Any, ...]
    accelerations: tuple[Any, ...]

    def nodes(self, start: _Node) -> list[_Node]:
        """At the start and at the end of each phase."""
        found, pose, velocity = [], start.pose, start.velocity
        for duration, acceleration in zip(self.durations, self.accelerations, strict=True):
            even = self.ca.vertcat(acceleration, 0.0)
            found.append(_Node(pose, velocity, even))
            pose = pose + duration * velocity + 0.5 * duration**2 * even
            velocity = velocity + duration * even
            found.append(_Node(pose, velocity, even))
        return found


def _arm_rows(search: Search, ca: Any, node: _Node) -> list[Any]:
    """The arm's local model: what a node asks of every joint and of the elbow beside its limits."""
    arm, far = search.arm, np.array([FAR_M, FAR_M, FAR_RAD])
    apart, v, a = node.pose - arm.pose, node.velocity, node.acceleration
    near = ca.fmin(ca.fmax(apart, -far), far)
    rows, speeds, changes = [], [], []
    for joint in range(7):
        xx, yy, tt, xy, xt, yt = arm.curvature[joint]
        bend = ca.DM([[xx, xy, xt], [xy, yy, yt], [xt, yt, tt]])
        rate = arm.rates[joint] + ca.mtimes(bend, near)
        angle = arm.angles_rad[joint] + ca.dot(rate, apart) - 0.5 * ca.dot(ca.mtimes(bend, near), near)
        speeds.append(ca.dot(rate, v))
        changes.append(ca.dot(rate, a) + ca.dot(v, ca.mtimes(bend, v)))
        rows.append((angle - arm.middle_rad[joint]) / arm.half_rad[joint])
        rows.append(speeds[-1] / arm.speed_rad_s[joint])
    for joint in range(7):
        torque = arm.weight_n_m[joint] + ca.dot(ca.DM(arm.mass[joint]), ca.vertcat(*changes))
        drag = wam.COULOMB_FRICTION[joint] + wam.VISCOUS_FRICTION[joint] * ca.fabs(speeds[joint])
        rows.append((ca.fabs(torque) + drag) / arm.torque_n_m[joint])
    elbow = ca.mtimes(ca.DM(arm.elbow), ca.vertcat(*speeds))
    return [*(ca.fabs(row) for row in rows), ca.sumsqr(elbow) / arm.elbow_speed_m_s**2]


def _answer(search: Search, choice: FloatArray) -> Answer:
    told = search.assess(choice[None])[0]
    return Answer(float(told[kernel.LENGTH_S]), float(told[kernel.EXCESS]), choice)
