"""From a regrasp to a motion of the arm, with every limit checked."""

from dataclasses import dataclass

import numpy as np

from slidepipe.arm.dynamics import ArmLoad, arm_load
from slidepipe.arm.inverse_kinematics import HandPath, InverseKinematics, JointPath, differentiate
from slidepipe.arm.model import Tool, nominal_model
from slidepipe.errors import InfeasibleError, InputError
from slidepipe.mechanics.dynamics import Block
from slidepipe.mechanics.limit_surface import SoftFinger
from slidepipe.mechanics.planar import MotionPlane
from slidepipe.planning.limits import Check, Limits, check_arm, check_grasp
from slidepipe.planning.three_phase import Motion, Regrasp, ThreePhaseMotion
from slidepipe.series import FloatArray
from slidepipe.tick import TICK_S


@dataclass(frozen=True, slots=True)
class Setup:
    """What a plan is made for: the object, the grip as it is believed, where the plane and the arm are, the limits."""

    block: Block
    finger: SoftFinger
    plane: MotionPlane
    tool: Tool
    posture_rad: FloatArray
    limits: Limits


@dataclass(frozen=True, slots=True)
class Plan:
    """A motion with its joint trajectory, sampled every :data:`TICK_S`.

    ``margins`` say how it stands to the grip, the object's face and the workspace, ``limits`` to those of the arm.
    """

    regrasp: Regrasp
    dq_o_slide: FloatArray
    ddq_o_stick: FloatArray
    ddq_o_settle: FloatArray
    motion: Motion
    joints: JointPath
    load: ArmLoad
    margins: tuple[Check, ...]
    limits: tuple[Check, ...]


def plan(regrasp: Regrasp, setup: Setup) -> Plan:
    """Plan one regrasp.

    Raises
    ------
    InfeasibleError
        Where a limit is broken: one line for each, with its value, its bound and the time.
    """
    motion, sampled, margins = _plan_grasp(regrasp, setup)
    _refuse(margins)
    joints, load = _plan_arm(sampled, regrasp, setup)
    limits = check_arm(joints, load, setup.limits)
    _refuse(limits)
    return Plan(
        regrasp=regrasp,
        dq_o_slide=motion.dq_o_slide,
        ddq_o_stick=motion.ddq_o_stick,
        ddq_o_settle=motion.ddq_o_settle,
        motion=sampled,
        joints=joints,
        load=load,
        margins=tuple(margins),
        limits=tuple(limits),
    )


def sticking_share(regrasp: Regrasp, motion: Motion) -> float:
    """Largest share of the friction that a regrasp's motion needs in its sticking phases; the arm is not asked."""
    sliding = (motion.time_s >= regrasp.boundaries[1]) & (motion.time_s < regrasp.boundaries[3])
    return float(np.max(motion.load[~sliding]))


def stick_load(regrasp: Regrasp, setup: Setup) -> float:
    """Share of the friction that a regrasp needs while it sticks, by planning its motion anew."""
    return sticking_share(regrasp, grasp_motion(regrasp, setup))


def grasp_motion(regrasp: Regrasp, setup: Setup) -> Motion:
    """Hand and object of a regrasp on the control loop's ticks, without asking the arm."""
    return _plan_grasp(regrasp, setup)[1]


def _plan_grasp(regrasp: Regrasp, setup: Setup) -> tuple[ThreePhaseMotion, Motion, list[Check]]:
    motion = ThreePhaseMotion(regrasp, setup.block, setup.finger)
    sampled = motion.sample(_ticks(regrasp))
    half_size_m = 0.5 * np.array([setup.block.length, setup.block.width])
    return motion, sampled, check_grasp(sampled, regrasp, half_size_m, setup.limits)


def _plan_arm(motion: Motion, regrasp: Regrasp, setup: Setup) -> tuple[JointPath, ArmLoad]:
    model = nominal_model(setup.tool)
    position_m, matrix = setup.plane.lift(motion.q_f)
    angles = InverseKinematics(model, setup.posture_rad).solve(HandPath(motion.time_s, position_m, matrix))
    joints = differentiate(motion.time_s, angles, regrasp.boundaries)
    return joints, arm_load(model, joints)


def _ticks(regrasp: Regrasp) -> FloatArray:
    """Sample times, at every boundary among others."""
    counts = regrasp.boundaries / TICK_S
    if not np.allclose(counts, np.round(counts), atol=1e-6):
        raise InputError(
            f"regrasp: its times must fall on the control loop's ticks of {1e3 * TICK_S:g} ms, T23 on two of them: "
            f"got T1 = {regrasp.T1:g} s, T23 = {regrasp.T23:g} s, T4 = {regrasp.T4:g} s"
        )
    return np.asarray(np.arange(round(counts[-1]) + 1) * TICK_S)


def _refuse(checks: list[Check]) -> None:
    broken = [str(check) for check in checks if not check.satisfied]
    if broken:
        raise InfeasibleError(*broken)
