"""From a course to a motion of the arm, with every limit checked."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace

import mujoco
import numpy as np

from slidepipe.arm import wam
from slidepipe.arm.dynamics import ArmLoad, HandWrench, arm_load, beside_joint_control, with_wrench
from slidepipe.arm.inverse_kinematics import HandPath, InverseKinematics, JointPath, joint_path
from slidepipe.arm.model import Tool, nominal_model
from slidepipe.errors import InfeasibleError, InputError
from slidepipe.mechanics.dynamics import Block
from slidepipe.mechanics.limit_surface import SoftFinger
from slidepipe.mechanics.planar import MotionPlane
from slidepipe.mechanics.stepping import PlacedFinger
from slidepipe.planning.carried import carried_wrench
from slidepipe.planning.course import Course, CourseMotion, Motion
from slidepipe.planning.limits import Check, Limits, check_arm, check_continuity, check_grasp
from slidepipe.planning.survival import Survival, survival
from slidepipe.planning.three_phase import Regrasp, course_of
from slidepipe.series import FloatArray
from slidepipe.tick import TICK_S

PULLS = (0.0, 0.25, 0.5)
"""Shares of the way from the wished posture to the middle of the joints' ranges that are tried in turn."""
ON_TICK = 1e-6
"""Share of a tick by which a time may miss it."""


@dataclass(frozen=True, slots=True)
class Setup:
    """What a plan is made for: the object, the grip as it is believed, where the plane and the arm are, the limits.

    Attributes
    ----------
    finger : SoftFinger
        All fingers taken together.
    places : (n, 3) or None
        Of single fingers in {f}, with the share of the normal force that each carries; None where they act as one.
    """

    block: Block
    finger: SoftFinger
    plane: MotionPlane
    tool: Tool
    posture_rad: FloatArray
    limits: Limits
    places: FloatArray | None = None

    @property
    def fingers(self) -> tuple[PlacedFinger, ...]:
        """The fingers one by one."""
        places = np.array([[0.0, 0.0, 1.0]]) if self.places is None else self.places
        return tuple(
            PlacedFinger(replace(self.finger, f_N=self.finger.f_N * share), np.array([x, y])) for x, y, share in places
        )

    @property
    def half_size_m(self) -> FloatArray:
        """(2,) half the object's sides."""
        return 0.5 * np.array([self.block.length, self.block.width])


@dataclass(frozen=True, slots=True)
class Plan:
    """A motion with its joint trajectory, sampled every :data:`TICK_S`.

    ``margins`` say how it stands to the grip, the object's face and the workspace, ``limits`` to those of the arm, and
    ``survival`` to wrong friction. ``setup`` is what it was made for, with the grip force that was chosen.
    """

    setup: Setup
    course: Course
    motion: Motion
    joints: JointPath
    load: ArmLoad
    margins: tuple[Check, ...]
    limits: tuple[Check, ...]
    survival: Survival


def plan(regrasp: Regrasp, setup: Setup) -> Plan:
    """Plan a regrasp whose times are given, as the paper does: they are checked, never changed.

    Raises
    ------
    InfeasibleError
        Where a limit is broken: one line for each, with its value, its bound and the time.
    """
    _check_ticks(regrasp)
    return plan_course(course_of(regrasp, setup.block, setup.fingers), setup)


def plan_course(course: Course, setup: Setup) -> Plan:
    """Follow a course with the arm.

    Raises
    ------
    InfeasibleError
        Where a limit is broken: one line for each, with its value, its bound and the time.
    """
    _refuse(grip_checks(course, setup))
    chosen = follow(course, setup)
    _refuse((*chosen.margins, *chosen.limits))
    return chosen


def follow(course: Course, setup: Setup, near: Callable[[FloatArray], FloatArray] | None = None) -> Plan:
    """The plan of a course, whether or not it keeps the limits; raises InfeasibleError where the arm cannot reach.

    ``near`` may tell joint angles (T, 7) near the right ones at times (T,) of one phase.
    """
    motion = CourseMotion(course, setup.block, setup.fingers)
    sampled = motion.sample(_ticks(course))
    model = nominal_model(setup.tool)
    joints = _joints(model, motion, setup, sampled.time_s, near)
    carrying = with_wrench(arm_load(model, joints), model, joints, _carried(motion, sampled.time_s, setup))
    load = beside_joint_control(carrying, joints)
    return Plan(
        setup=setup,
        course=course,
        motion=sampled,
        joints=joints,
        load=load,
        margins=(*_check_grip(sampled, course, setup), *check_continuity(motion)),
        limits=tuple(check_arm(joints, load, setup.limits)),
        survival=survival(course, setup.block, setup.fingers),
    )


def postures(wished_rad: FloatArray) -> Iterator[FloatArray]:
    """The wished posture (7,), then ones drawn towards the middle of the joints' ranges."""
    for pull in PULLS:
        yield (1.0 - pull) * wished_rad + pull * wam.MIDDLE_RAD


def _joints(
    model: mujoco.MjModel,
    motion: CourseMotion,
    setup: Setup,
    time_s: FloatArray,
    near: Callable[[FloatArray], FloatArray] | None,
) -> JointPath:
    """Joint motion with the posture as it is wished, else drawn towards the middle of the joints' ranges.

    Where a joint meets its limit on the way, the posture nearest to the wished one turns a corner.
    """
    refusals: list[InfeasibleError] = []
    for posture in postures(setup.posture_rad):
        try:
            return joint_path(
                InverseKinematics(model, posture),
                lambda at_s: _hand_path(motion, setup, at_s),
                time_s,
                motion.course.boundaries,
                near=None if refusals else near,
            )
        except InfeasibleError as refusal:
            refusals.append(refusal)
    raise refusals[0]


def _carried(motion: CourseMotion, time_s: FloatArray, setup: Setup) -> HandWrench:
    wrenches = (
        carried_wrench(motion.sample(at_s), setup.block, setup.plane) for at_s in (time_s, time_s + 0.5 * TICK_S)
    )
    return HandWrench(*wrenches)


def grip_checks(course: Course, setup: Setup) -> list[Check]:
    """How a course stands to the limits of the grip and the hand; the arm is not asked."""
    sampled = CourseMotion(course, setup.block, setup.fingers).sample(_ticks(course))
    return _check_grip(sampled, course, setup)


def _check_grip(sampled: Motion, course: Course, setup: Setup) -> list[Check]:
    return check_grasp(sampled, course, setup.fingers, setup.half_size_m, setup.limits)


def sticking_share(regrasp: Regrasp, motion: Motion) -> float:
    """Largest share of the friction that a regrasp's motion needs in its sticking phases; the arm is not asked."""
    sliding = (motion.time_s >= regrasp.boundaries[1]) & (motion.time_s < regrasp.boundaries[3])
    return float(np.max(motion.load[~sliding]))


def stick_load(regrasp: Regrasp, setup: Setup) -> float:
    """Share of the friction that a regrasp needs while it sticks, by planning its motion anew."""
    return sticking_share(regrasp, grasp_motion(regrasp, setup))


def grasp_motion(regrasp: Regrasp, setup: Setup) -> Motion:
    """Hand and object of a regrasp on the control loop's ticks, without asking the arm."""
    course = course_of(regrasp, setup.block, setup.fingers)
    return CourseMotion(course, setup.block, setup.fingers).sample(_ticks(course))


def _hand_path(motion: CourseMotion, setup: Setup, time_s: FloatArray) -> HandPath:
    position_m, matrix = setup.plane.lift(motion.hand_poses(time_s))
    return HandPath(time_s, position_m, matrix)


def _ticks(course: Course) -> FloatArray:
    """Sample times, up to the first at which the hand is at rest again."""
    return np.asarray(np.arange(np.ceil(course.edges[-1] / TICK_S - ON_TICK) + 1) * TICK_S)


def _check_ticks(regrasp: Regrasp) -> None:
    counts = regrasp.boundaries / TICK_S
    if not np.allclose(counts, np.round(counts), atol=1e-6):
        raise InputError(
            f"regrasp: its times must fall on the control loop's ticks of {1e3 * TICK_S:g} ms, T23 on two of them: "
            f"got T1 = {regrasp.T1:g} s, T23 = {regrasp.T23:g} s, T4 = {regrasp.T4:g} s"
        )


def _refuse(checks: Iterable[Check]) -> None:
    broken = [str(check) for check in checks if not check.satisfied]
    if broken:
        raise InfeasibleError(*broken)
