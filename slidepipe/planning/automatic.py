"""A motion that the planner finds by itself, for any planar goal, within the limits of grip, hand and arm."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from slidepipe.arm import wam
from slidepipe.arm.inverse_kinematics import InverseKinematics
from slidepipe.arm.local_model import LocalModel, local_model
from slidepipe.arm.model import nominal_model
from slidepipe.errors import InfeasibleError
from slidepipe.mechanics.planar import finger_pose
from slidepipe.planning import assess_kernel as kernel
from slidepipe.planning.course import Course
from slidepipe.planning.planner import Plan, Setup, follow, grip_checks
from slidepipe.planning.search import Found, Search, Task, scaled
from slidepipe.planning.survival import Survival, survival
from slidepipe.planning.wish import Wish
from slidepipe.series import FloatArray

WHOLE_RANGE_RAD = np.array([0.5 * (link.range_rad[1] - link.range_rad[0]) for link in wam.LINKS])
ATTEMPTS = 8
"""How often the arm's local model is corrected by the arm itself."""
TO_SPARE = 0.97
"""Of a limit that the arm broke, beside what its first order missed; much less, and the search ends elsewhere."""
SHRINK = 0.8
"""Of the joints' ranges and the workspace, where the arm cannot reach."""
HALVINGS = 5
"""How finely the nearest goal that can be reached is told."""
WIDEST_FORCE = (0.1, 10.0)
"""Grip forces that are tried, beside the one that does not do, where no motion is found."""


def plan_automatically(task: Task, setup: Setup, wish: Wish) -> Plan:
    """Find the best motion for a wish.

    The arm takes part in the search as its first order about the start; where the arm itself, asked along the motion
    that was found, breaks a limit, that limit is tightened in the first order and the search goes on.

    Parameters
    ----------
    task : Task
    setup : Setup
        The friction in it is what is believed.
    wish : Wish

    Raises
    ------
    InfeasibleError
        No motion is found: the limits that conflict in the one that comes nearest, each with its value, its bound and
        the time, and the nearest goal or grip force for which there is one.
    """
    arm, refusal = local_arm(task, setup), None
    for _ in range(ATTEMPTS):
        search = Search(task, setup, wish, arm)
        found = search.best()
        if not found.feasible:
            break
        try:
            chosen = follow(search.course(found), _with_force(setup, found.force))
        except InfeasibleError as out_of_reach:
            refusal = out_of_reach
            arm = arm.tightened(half=np.full(7, SHRINK))
            continue
        broken = [str(check) for check in (*chosen.margins, *chosen.limits) if not check.satisfied]
        if not broken:
            return chosen
        refusal = InfeasibleError(*broken)
        arm = _tightened(arm, chosen)
    if refusal is not None:
        raise InfeasibleError(*refusal.lines, ARM_WORDS)
    raise InfeasibleError(*_conflicts(search, found), *_nearest(search))


ARM_WORDS = "no gentler motion does better: move arm.plane, change arm.posture_rad or raise arm.limits"


def local_arm(task: Task, setup: Setup) -> LocalModel:
    """The arm's first order about the start of a task."""
    model, limits = nominal_model(setup.tool), setup.limits
    return local_model(
        model,
        InverseKinematics(model, setup.posture_rad),
        setup.plane,
        finger_pose(task.q_o_start, task.r_start),
        speed_rad_s=limits.joint_speed_rad_s,
        acceleration_rad_s2=limits.joint_acceleration_rad_s2,
        torque_n_m=limits.joint_torque_n_m,
        elbow_speed_m_s=limits.elbow_speed_m_s,
    )


def _tightened(arm: LocalModel, chosen: Plan) -> LocalModel:
    """The local model with the limits that the arm itself broke tightened by as much."""
    limits, joints = chosen.setup.limits, chosen.joints
    off = np.max(np.abs(joints.position_rad - arm.middle_rad), axis=0)
    speed = np.max(np.abs(joints.velocity_rad_s), axis=0)
    acceleration = np.max(np.abs(joints.acceleration_rad_s2), axis=0)
    torque = np.max(np.abs(chosen.load.torque_n_m), axis=0)
    elbow = np.max(chosen.load.elbow_speed_m_s)
    return arm.tightened(
        half=_factor(off, WHOLE_RANGE_RAD),
        speed=_factor(speed, limits.joint_speed_rad_s),
        acceleration=_factor(acceleration, limits.joint_acceleration_rad_s2),
        torque=_factor(torque, limits.joint_torque_n_m),
        elbow=float(_factor(np.array([elbow]), np.array([limits.elbow_speed_m_s]))[0]),
    )


def _factor(reached: FloatArray, bound: FloatArray) -> FloatArray:
    return np.where(reached > bound, TO_SPARE * bound / reached, 1.0)


def _with_force(setup: Setup, share: float) -> Setup:
    return replace(setup, finger=replace(setup.finger, f_N=setup.finger.f_N * share))


def _conflicts(search: Search, found: Found) -> list[str]:
    """The limits that the nearest motion breaks."""
    setup = _with_force(search.setup, found.force)
    share = (1.0 - search.wish.friction_error) * setup.limits.stick_load
    strict = replace(setup, limits=replace(setup.limits, stick_load=share))
    course = search.course(found)
    broken = [str(check) for check in grip_checks(course, strict) if not check.satisfied]
    broken += _arm_conflicts(course, strict, float(found.figures[kernel.ARM_SHARE]))
    outcome = survival(course, setup.block, setup.fingers)
    if outcome.friction_error < search.wish.friction_error:
        broken.append(_too_little(outcome, search.wish.friction_error))
    return broken or ["no motion was found that keeps every limit at once, though one breaks none of them by itself"]


def _arm_conflicts(course: Course, setup: Setup, share: float) -> list[str]:
    """What the arm says of a course; ``share`` is what its first order took it to ask of a limit."""
    try:
        broken = [str(check) for check in follow(course, setup).limits if not check.satisfied]
    except InfeasibleError as out_of_reach:
        return list(out_of_reach.lines)
    if share > 1.0 and not broken:
        broken = [f"arm: {share:.3g} times a joint's limit, to first order about the start, beyond 1"]
    return broken


def _too_little(outcome: Survival, asked: float) -> str:
    why = outcome.why_below if outcome.below <= outcome.above else outcome.why_above
    return f"friction error survived: {outcome.friction_error:.3g}, less than {asked:.3g} that is asked: there {why}"


def _nearest(search: Search) -> Iterator[str]:
    """The nearest goal and the nearest grip force for which there is a motion."""
    low, high = 0.0, 1.0
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        nearer = Search(scaled(search.task, middle), search.setup, search.wish, search.arm)
        low, high = (middle, high) if nearer.best().feasible else (low, middle)
    if low > 0.0:
        r = scaled(search.task, low).r_goal
        yield (
            f"nearest goal on the way: {100 * low:.0f} % of it, the finger at "
            f"[{1e3 * r[0]:.2f} mm, {1e3 * r[1]:.2f} mm, {1e3 * r[2]:.1f} mrad] in the body frame"
        )
    wide = replace(search.wish, force_range=WIDEST_FORCE)
    for_force = Search(search.task, search.setup, wide, search.arm, nearest_force=True)
    found = for_force.best()
    if found.feasible:
        force = found.force * search.setup.finger.f_N
        yield f"nearest normal force: {force:.3g} N of all fingers together, instead of {search.setup.finger.f_N:.3g} N"
