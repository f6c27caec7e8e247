"""A plan as files: ``plan.yaml``, the reference as MCAP, and the experiment that it was made for."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from slidepipe.artifacts.draft import Draft
from slidepipe.artifacts.experiment import Experiment
from slidepipe.artifacts.plan import (
    Belief,
    FrictionPoint,
    LimitCheck,
    Phase,
    PhaseName,
    PlanDocument,
    Robustness,
    Slide,
)
from slidepipe.artifacts.recording_series import Series, write_series
from slidepipe.artifacts.recording_writer import RecordingWriter
from slidepipe.artifacts.schema import dump_model
from slidepipe.artifacts.values import Planar, Pose
from slidepipe.mechanics.planar import MotionPlane
from slidepipe.planning.limits import Check
from slidepipe.planning.planner import Plan
from slidepipe.planning.survival import SURVIVED
from slidepipe.series import FloatArray, IntArray, JointSeries, PoseSeries
from slidepipe.stages.motions import objective_words
from slidepipe.stages.translate import motion_plane

PLAN, REFERENCE, EXPERIMENT = "plan", "reference", "experiment"
"""Roles of a plan's files."""
REFERENCE_FILE = "reference.mcap"
EDGE_S = 1e-9
MAP_POINTS = 15
"""Frictions in a plan's map."""
ANGLE_STEP_RAD, SPEED_STEP_RAD_S, TORQUE_STEP_N_M = 2.0**-26, 2.0**-20, 2.0**-10
"""A reference is rounded to what no drive could tell apart, which halves the size of every recording of it."""
REFERENCE_JOINTS, REFERENCE_HAND, REFERENCE_OBJECT = "/reference/joints", "/reference/hand", "/reference/object"


@dataclass(frozen=True, slots=True)
class Occasion:
    """Why a plan was made: which trial it is for, from which estimate, and with which friction."""

    trial: int
    reason: str
    previous_estimate: str | None
    friction: float
    friction_std: float | None


def write_plan(draft: Draft, plan: Plan, experiment: Experiment, occasion: Occasion) -> PlanDocument:
    """Write a plan into a draft, and report its main figures in the manifest."""
    document = _document(plan, experiment, occasion)
    text = dump_model(document)
    draft.add(PLAN, "plan.yaml").write_text(text, encoding="utf-8")
    draft.add(EXPERIMENT, "experiment.yaml").write_text(dump_model(experiment), encoding="utf-8")
    provenance = {"run": draft.run_id, "experiment": experiment.name, "clock": "from the start of the motion"}
    with RecordingWriter(draft.add(REFERENCE, REFERENCE_FILE), provenance, {"plan.yaml": text.encode()}) as writer:
        write_series(writer, _reference(plan, motion_plane(experiment)))
    draft.report("believed_friction", occasion.friction, std=occasion.friction_std, unit="1")
    draft.report("duration", float(plan.motion.time_s[-1]), unit="s")
    draft.report("friction_error_survived", plan.survival.friction_error, unit="1")
    draft.report("peak_hand_speed", float(np.max(np.linalg.norm(plan.motion.dq_f[:, :2], axis=1))), unit="m/s")
    return document


def _document(plan: Plan, experiment: Experiment, occasion: Occasion) -> PlanDocument:
    course, motion = plan.course, plan.motion
    force = plan.setup.finger.f_N
    kappa = occasion.friction * force / experiment.object.mass_kg
    return PlanDocument(
        experiment=experiment.name,
        trial=occasion.trial,
        reason=occasion.reason,
        previous_estimate=occasion.previous_estimate,
        believed=Belief(
            friction=occasion.friction,
            friction_std=occasion.friction_std,
            kappa_m_s2=kappa,
            rho_m=experiment.grasp.rho_m,
        ),
        start_relative_pose=Pose.of(course.r_start),
        goal_relative_pose=Pose.of(course.r_goal),
        object_start_pose=Pose.of(course.q_o_start),
        hand_start_pose=Pose.of(motion.q_f[0]),
        hand_end_pose=Pose.of(motion.q_f[-1]),
        phases=_phases(plan),
        object_velocity_at_slide=_planar(course.dq_o_slide),
        slide=Slide(
            start_s=course.slide_s,
            switch_s=course.slide_s + course.T2,
            stop_s=course.stop_s,
            relative_acceleration=_planar(course.ddr),
            braking_acceleration=_planar(course.ddr_brake),
        ),
        margins=tuple(_check(check) for check in plan.margins),
        limits=tuple(_check(check) for check in plan.limits),
        reference_file=REFERENCE_FILE,
        objective=objective_words(experiment),
        normal_force_n=force,
        robustness=_robustness(plan, experiment.motion.friction_error, occasion.friction),
    )


def _phases(plan: Plan) -> tuple[Phase, ...]:
    """Phases with the object's acceleration where it is constant."""
    course, motion = plan.course, plan.motion
    edges = [float(edge) for edge in (0.0, course.slide_s, course.stop_s, course.edges[4], course.edges[5])]
    names: tuple[PhaseName, ...] = ("stick", "slide", "catch", "settle")
    phases = []
    for name, start, stop in zip(names, edges[:-1], edges[1:], strict=True):
        inside = (motion.time_s >= start - EDGE_S) & (motion.time_s < stop - EDGE_S)
        if not np.any(inside):
            continue
        ddq_o = motion.ddq_o[inside]
        constant = name != "slide" and np.allclose(ddq_o, ddq_o[0], rtol=1e-9, atol=1e-9)
        phases.append(
            Phase(name=name, start_s=start, stop_s=stop, object_acceleration=_planar(ddq_o[0]) if constant else None)
        )
    return tuple(phases)


def _robustness(plan: Plan, within: float, friction: float) -> Robustness:
    found = plan.survival
    shown = np.unique(np.round(np.linspace(0, len(found.ratio) - 1, MAP_POINTS)).astype(int))
    return Robustness(
        friction_error=found.friction_error,
        below=found.below,
        binds_below=found.why_below,
        above=found.above,
        binds_above=found.why_above,
        contraction=found.contraction(within),
        contraction_within=within,
        map=tuple(
            FrictionPoint(
                friction=float(friction * found.ratio[index]),
                relative_pose=Pose.of(found.r_f_b[index]),
                error_share=float(found.error[index]),
                survived=bool(found.verdict[index] == SURVIVED),
            )
            for index in shown
        ),
    )


def _reference(plan: Plan, plane: MotionPlane) -> Series:
    stamps = np.round(1e9 * plan.motion.time_s).astype(np.int64)
    return Series(
        joints={
            REFERENCE_JOINTS: JointSeries(
                stamp_ns=stamps,
                position_rad=_rounded(plan.joints.position_rad, ANGLE_STEP_RAD),
                velocity_rad_s=_rounded(plan.joints.velocity_rad_s, SPEED_STEP_RAD_S),
                effort_n_m=_rounded(plan.load.feedforward_n_m, TORQUE_STEP_N_M),
            )
        },
        poses={
            REFERENCE_HAND: _in_space(stamps, plan.motion.q_f, plane),
            REFERENCE_OBJECT: _in_space(stamps, plan.motion.q_o, plane),
        },
    )


def _rounded(values: FloatArray, step: float) -> FloatArray:
    return np.asarray(np.round(values / step) * step)


def _in_space(stamps: IntArray, poses: FloatArray, plane: MotionPlane) -> PoseSeries:
    position, matrix = plane.lift(poses)
    quaternion = Rotation.from_matrix(matrix).as_quat(canonical=True)
    return PoseSeries(stamps, position, quaternion, np.arange(len(stamps), dtype=np.int64))


def _check(check: Check) -> LimitCheck:
    return LimitCheck(
        name=check.name,
        value=check.value,
        bound=check.bound,
        unit=check.unit,
        time_s=check.time_s,
        satisfied=check.satisfied,
    )


def _planar(values: FloatArray) -> Planar:
    x, y, theta = (float(value) for value in values)
    return x, y, theta
