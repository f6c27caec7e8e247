"""A motion that the planner finds by itself, for any planar goal, within the limits of grip, hand and arm."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from slidepipe.arm.inverse_kinematics import InverseKinematics
from slidepipe.arm.local_model import LocalModel, local_model
from slidepipe.arm.model import nominal_model
from slidepipe.errors import InfeasibleError
from slidepipe.mechanics.planar import finger_pose
from slidepipe.planning import assess_kernel as kernel
from slidepipe.planning.arm_along import ArmAlong, ArmAsked
from slidepipe.planning.course import Course
from slidepipe.planning.planner import Plan, Setup, follow, grip_checks
from slidepipe.planning.search import FORCE_FIRST, Found, Search, Task, scaled
from slidepipe.planning.survival import Survival, survival
from slidepipe.planning.tighten import tightened_arm, tightened_hand
from slidepipe.planning.wish import Wish
from slidepipe.series import FloatArray

ATTEMPTS = 12
"""How often the arm's local model is corrected by the arm itself."""
CARE = 0.01
"""By how much more of the arm's limits each attempt keeps off: what its local model misses changes with the motion."""
SHRINK, SHRINKS = 0.8, 3
"""Of how far the hand went, where the arm cannot follow; and how often."""
BINDING, ROOM, PATIENCE = 0.97, 0.9, 1
"""Share of the arm's limits from which on they hold the search back, and below which they wrongly did; and how often
it goes on for that alone."""
FAR_RAD = 0.5
"""Turn of the hand from where the arm's local model was taken, from which on it is taken anew."""
ALIKE = 1e-3
"""Friction errors that differ by less are the same."""
FURTHER = 1.6
"""Power of the nearest grip force beside the believed one that the search alone finds, up to which the arm is asked."""
OFFERED = 4
"""Attempts at a goal or a grip force that is offered."""
NEARER = (0.95, 0.7)
"""Of the way to the nearest goal that the search alone can reach, where the arm takes part."""
HALVINGS = 5
"""How finely the nearest goal that can be reached is told."""
WIDEST_FORCE = (0.1, 10.0)
"""Grip forces that are tried, beside the one that does not do, where no motion is found."""


def plan_automatically(task: Task, setup: Setup, wish: Wish) -> Plan:
    """Find the best motion for a wish.

    The arm takes part in the search as its second order about the start. The arm itself is then asked at a few places
    along the motion that was found; where it breaks a limit, the search goes on from there and knows what the second
    order missed. Only a motion that does is followed tick by tick.

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
    seeking = _Seeking(task, setup, wish)
    chosen = seeking.plan()
    if chosen is not None:
        return chosen
    raise InfeasibleError(*seeking.conflicts(), *_nearest(seeking))


def find_plan(task: Task, setup: Setup, wish: Wish) -> Plan | None:
    """The best motion for a wish as :func:`plan_automatically` finds it, or None: nothing is explained or offered."""
    try:
        return _Seeking(task, setup, wish).plan()
    except InfeasibleError:
        return None


class _Seeking:
    """The search and the arm in turns: each knows more of the other with every attempt."""

    def __init__(self, task: Task, setup: Setup, wish: Wish, near: FloatArray | None = None) -> None:
        self.task, self.setup, self.wish = task, setup, wish
        self._first_arm = self.arm = local_arm(task, setup)
        self._asked = ArmAsked(nominal_model(setup.tool), setup.posture_rad, setup.plane)
        self._offsets: FloatArray | None = None
        self._near = near
        self._refusal: list[str] = []
        self._patience, self._unreachable = PATIENCE, 0
        self._learns = True
        """Whether what the local model missed helps; else limits are tightened by as much as they were broken."""
        self._looks = True
        """Whether the local model is taken anew where the hand is turned far."""
        self._within = setup
        """With the workspace that the arm was found to reach, and what breaks a limit between nodes kept off it."""

    def plan(self, attempts: int = ATTEMPTS) -> Plan | None:
        """The first motion that keeps every limit, or None."""
        for attempt in range(attempts):
            self._search = Search(
                self.task,
                self._within,
                self.wish,
                self.arm.tightened_evenly(1.0 - (attempt + 1) * CARE * self._learns),
                offsets=self._offsets,
            )
            self._found = self._search.best(self._near)
            if not self._found.feasible:
                if not self._start_afresh():
                    return None
                continue
            try:
                chosen = self._followed(last=attempt == attempts - 1)
            except InfeasibleError as out_of_reach:
                self._reach_less(out_of_reach)
                if self._unreachable > SHRINKS:
                    return None
                continue
            if chosen is not None:
                return chosen
        return None

    def _start_afresh(self) -> bool:
        """Forget where the last search ended, then the arm elsewhere, then all it missed; whether there was any."""
        if self._near is None and self._offsets is None:
            return False
        if self._near is None:
            self._learns = self._looks and self.arm.pose is not self._first_arm.pose
            self._looks, self._offsets, self.arm = False, None, self._first_arm
        self._near = None
        return True

    def _reach_less(self, refusal: InfeasibleError) -> None:
        self._refusal, self._near, self._offsets = list(refusal.lines), None, None
        self._unreachable += 1
        radius = SHRINK * float(self._found.figures[kernel.OFF_CENTRE])
        self._within = replace(self._within, limits=replace(self._within.limits, workspace_radius_m=radius))

    def _followed(self, *, last: bool) -> Plan | None:
        """The plan of what was found if it keeps every limit; else the next search knows what it missed."""
        found = self._found
        course, held = self._search.course(found), _with_force(self.setup, found.force)
        if self._learns:
            self._look_from(finger_pose(course.q_o_slide, course.r_start))
            along = self._along()
            self._offsets, self._near = along.offsets, found.population
            if not last and self._searches_on(along.offsets):
                return None
            chosen = follow(course, held, along.near)
        else:
            chosen = follow(course, held)
        self._refusal = [str(check) for check in (*chosen.margins, *chosen.limits) if not check.satisfied]
        if not self._refusal and chosen.survival.friction_error >= self.wish.friction_error - ALIKE:
            return chosen
        if not self._refusal:
            self._refusal = [_too_little(chosen.survival, self.wish.friction_error)]
            self._near = None
        self.arm, self._within = tightened_arm(self.arm, chosen), tightened_hand(self._within, chosen)
        return None

    def _look_from(self, pose: FloatArray) -> None:
        """Expand the arm about a pose of the hand, in place of one that is turned far from it."""
        if self._looks and abs(pose[2] - self.arm.pose[2]) > FAR_RAD:
            self.arm, self._offsets = arm_about(pose, self.setup), None

    def _along(self) -> ArmAlong:
        offsets = self._search.no_offsets() if self._offsets is None else self._offsets
        return self._asked.along(self.arm, offsets, *self._search.nodes(self._found))

    def _searches_on(self, offsets: FloatArray) -> bool:
        """Whether the arm breaks a limit along what was found, or the search was held back for nothing."""
        knowing = Search(self.task, self.setup, self.wish, self.arm, offsets=offsets)
        share = float(knowing.assess(self._found.choice[None])[0, kernel.ARM_SHARE])
        held_back = self._found.figures[kernel.ARM_SHARE] > BINDING and share < ROOM and self._patience > 0
        self._patience -= held_back
        return share > 1.0 or held_back

    def conflicts(self) -> list[str]:
        """What is in the way, after a plan was not found."""
        if self._refusal:
            return [*self._refusal, ARM_WORDS]
        return _conflicts(self._search, self._found)


ARM_WORDS = "no gentler motion does better: move arm.plane, change arm.posture_rad or raise arm.limits"


def local_arm(task: Task, setup: Setup) -> LocalModel:
    """The arm's second order about the start of a task."""
    return arm_about(finger_pose(task.q_o_start, task.r_start), setup)


def arm_about(pose: FloatArray, setup: Setup) -> LocalModel:
    """The arm's second order about a pose (3,) of the hand in {w}; raises InfeasibleError where it is out of reach."""
    model, limits = nominal_model(setup.tool), setup.limits
    return local_model(
        model,
        InverseKinematics(model, setup.posture_rad),
        setup.plane,
        pose,
        speed_rad_s=limits.joint_speed_rad_s,
        acceleration_rad_s2=limits.joint_acceleration_rad_s2,
        torque_n_m=limits.joint_torque_n_m,
        elbow_speed_m_s=limits.elbow_speed_m_s,
    )


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
    """What the arm says of a course; ``share`` is what its second order took it to ask of a limit."""
    try:
        broken = [str(check) for check in follow(course, setup).limits if not check.satisfied]
    except InfeasibleError as out_of_reach:
        return list(out_of_reach.lines)
    if share > 1.0 and not broken:
        broken = [f"arm: {share:.3g} times a joint's limit, to second order about the start, beyond 1"]
    return broken


def _too_little(outcome: Survival, asked: float) -> str:
    why = outcome.why_below if outcome.below <= outcome.above else outcome.why_above
    return f"friction error survived: {outcome.friction_error:.3g}, less than {asked:.3g} that is asked: there {why}"


def _nearest(seeking: _Seeking) -> Iterator[str]:
    """The nearest goal and the nearest grip force for which there is a motion, each planned to the end."""
    task, setup, wish = seeking.task, seeking.setup, seeking.wish
    low, high = 0.0, 1.0
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        nearer = Search(scaled(task, middle), setup, wish, seeking.arm)
        low, high = (middle, high) if nearer.best(starts=1).feasible else (low, middle)
    for share in low * np.array(NEARER) if low > 0.0 else ():
        goal = scaled(task, float(share))
        if _Seeking(goal, setup, wish).plan(OFFERED) is None:
            continue
        r = goal.r_goal
        yield (
            f"nearest goal on the way: {100 * share:.0f} % of it, the finger at "
            f"[{1e3 * r[0]:.2f} mm, {1e3 * r[1]:.2f} mm, {1e3 * r[2]:.1f} mrad] in the body frame"
        )
        break
    for_force = Search(task, setup, replace(wish, force_range=WIDEST_FORCE), seeking.arm)
    for_force.weights[kernel.FOR_FORCE] = FORCE_FIRST
    found = for_force.best()
    if not found.feasible:
        return
    low, high = sorted((found.force, found.force**FURTHER))
    chosen = _Seeking(task, setup, replace(wish, force_range=(low, high)), found.population).plan(OFFERED)
    if chosen is not None:
        force = chosen.setup.finger.f_N
        yield f"nearest normal force: {force:.3g} N of all fingers together, instead of {setup.finger.f_N:.3g} N"
