"""From the words of the experiment file to the values that the rooms work with."""

from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from slidepipe.arm.model import Tool
from slidepipe.artifacts.experiment import Experiment
from slidepipe.artifacts.lab_setup import GraspError, OffsetSetup, Scatter
from slidepipe.artifacts.values import Pose
from slidepipe.errors import InputError
from slidepipe.lab.cameras import CameraSettings, Offset
from slidepipe.lab.simulated import Tracker
from slidepipe.lab.world import ContactSettings, WorldSettings
from slidepipe.mechanics.dynamics import Block
from slidepipe.mechanics.limit_surface import SoftFinger
from slidepipe.mechanics.planar import MotionPlane
from slidepipe.planning.limits import Limits
from slidepipe.planning.planner import Setup
from slidepipe.planning.three_phase import Regrasp
from slidepipe.series import FloatArray, PoseSeries

SCATTER_STREAM = 1
"""Keeps what differs from trial to trial apart from the cameras' noise."""
PINCH = 2
"""Fingers of the gripper in the simulated lab."""


def vector(pose: Pose) -> FloatArray:
    """``[x, y, theta]`` of a pose record."""
    return np.array(pose.vector)


def motion_plane(experiment: Experiment) -> MotionPlane:
    """The plane of motion in the arm's base frame."""
    plane = experiment.arm.plane
    return MotionPlane(np.array(plane.origin_m), plane.heading_rad)


def hand_in_plane(poses: PoseSeries, experiment: Experiment) -> FloatArray:
    """Poses in the base frame as (T, 3) in {w}, the angle without jumps."""
    matrices = Rotation.from_quat(poses.quaternion_xyzw).as_matrix()
    planar: FloatArray = motion_plane(experiment).project(poses.position_m, matrices)
    planar[:, 2] = np.unwrap(planar[:, 2])
    return planar


def block(experiment: Experiment) -> Block:
    """The object as mechanics sees it."""
    thing = experiment.object
    return Block(thing.size_x_m, thing.size_y_m, thing.mass_kg)


def tool(experiment: Experiment) -> Tool:
    """Where the finger frame is on the flange."""
    return Tool(experiment.arm.tool.length_m, experiment.arm.tool.angle_rad)


def setup(experiment: Experiment, friction: float) -> Setup:
    """What a plan is made for, with the friction that is believed."""
    grasp, arm, workspace = experiment.grasp, experiment.arm, experiment.workspace
    return Setup(
        block=block(experiment),
        finger=SoftFinger(friction, grasp.normal_force_n, grasp.contact_radius_m, grasp.torsion_constant),
        plane=motion_plane(experiment),
        tool=tool(experiment),
        posture_rad=np.array(arm.posture_rad),
        limits=Limits(
            workspace_centre_m=np.array([workspace.centre_x_m, workspace.centre_y_m]),
            workspace_radius_m=workspace.radius_m,
            joint_speed_rad_s=np.array(arm.limits.joint_speed_rad_s),
            joint_torque_n_m=np.array(arm.limits.joint_torque_n_m),
            tip_speed_m_s=arm.limits.tip_speed_m_s,
            elbow_speed_m_s=arm.limits.elbow_speed_m_s,
            **_optional_limits(experiment),
        ),
        places=None if grasp.places is None else np.array([[p.x_m, p.y_m, p.force_share] for p in grasp.places]),
    )


def _optional_limits(experiment: Experiment) -> dict[str, Any]:
    """Limits that an experiment may leave out."""
    given, region = experiment.arm.limits, experiment.goal.hand_region
    found: dict[str, Any] = {}
    if given.hand_acceleration_m_s2 is not None:
        found["hand_acceleration_m_s2"] = given.hand_acceleration_m_s2
    if given.joint_acceleration_rad_s2 is not None:
        found["joint_acceleration_rad_s2"] = np.array(given.joint_acceleration_rad_s2)
    if region is not None:
        found |= {"region_centre_m": np.array([region.centre_x_m, region.centre_y_m])}
        found |= {"region_radius_m": region.radius_m}
    return found


def first_regrasp(experiment: Experiment) -> Regrasp:
    """The motion that an experiment asks for by its times."""
    times, hand_pose = experiment.motion.times, experiment.goal.hand_pose
    if hand_pose is None:
        raise InputError("goal.hand_pose: is required where the times of the motion are given")
    return Regrasp(
        q_o_start=vector(experiment.start.object_pose),
        r_start=vector(experiment.start.relative_pose),
        r_goal=vector(experiment.goal.relative_pose),
        q_f_end=vector(hand_pose),
        T1=times.stick_s,
        T23=times.slide_s,
        T4=times.settle_s,
    )


def scattered(experiment: Experiment, trial: int, repetition: int = 0) -> Experiment:
    """Experiment with the world as it is in one trial, drawn by ``lab.scatter``; the same draw for the same trial."""
    lab, scatter = experiment.lab, experiment.lab.scatter
    if scatter == Scatter():
        return experiment
    draw = np.random.default_rng([lab.seed, trial, repetition, SCATTER_STREAM]).standard_normal(5)
    grasp_m, error = scatter.grasp_position_m, lab.grasp_error
    changed = {
        "friction": lab.friction * float(np.exp(scatter.friction_share * draw[0])),
        "normal_force_per_finger_n": lab.normal_force_per_finger_n
        * float(np.exp(scatter.normal_force_share * draw[1])),
        "grasp_error": GraspError(
            x_m=error.x_m + grasp_m * float(draw[2]),
            y_m=error.y_m + grasp_m * float(draw[3]),
            theta_rad=error.theta_rad + scatter.grasp_angle_rad * float(draw[4]),
        ),
    }
    return experiment.model_copy(update={"lab": lab.model_copy(update=changed)})


def world(experiment: Experiment) -> WorldSettings:
    """The simulated world as the experiment's ``lab`` section says it is."""
    lab, thing = experiment.lab, experiment.object
    if experiment.grasp.finger_count != PINCH:
        raise InputError(
            f"grasp.finger_count: the simulated lab's gripper has {PINCH} fingers, got {experiment.grasp.finger_count}"
        )
    if experiment.grasp.places is not None:
        raise InputError("grasp.places: the simulated lab's gripper presses at the hand's origin alone: leave it out")
    return WorldSettings(
        block_size_m=np.array([thing.size_x_m, thing.size_y_m, thing.thickness_m]),
        block_mass_kg=thing.mass_kg,
        friction=lab.friction,
        normal_force_per_finger_n=lab.normal_force_per_finger_n,
        rho_m=experiment.grasp.rho_m,
        tool=tool(experiment),
        plane=motion_plane(experiment),
        prescribed=tracker(experiment) is Tracker.PERFECT,
        mass_error=lab.tracker.mass_error,
        joint_friction_scale=lab.tracker.joint_friction_scale,
        contact=ContactSettings(lab.contact.timestep_s, lab.contact.solref_s, lab.contact.impratio),
    )


def tracker(experiment: Experiment) -> Tracker:
    """How the simulated arm follows its commands."""
    wanted = experiment.lab.tracker
    if wanted.kind == "perfect":
        return Tracker.PERFECT
    return Tracker.FEEDFORWARD if wanted.feedforward else Tracker.VENDOR


def cameras(experiment: Experiment) -> CameraSettings:
    """What the simulated cameras do to the truth."""
    seen = experiment.lab.cameras
    return CameraSettings(
        rate_hz=seen.rate_hz,
        position_noise_m=seen.position_noise_m,
        angle_noise_rad=seen.angle_noise_rad,
        dropout_share=seen.dropout_share,
        clock_offset_s=seen.clock_offset_s,
        clock_drift_ppm=seen.clock_drift_ppm,
        latency_s=seen.latency_s,
        latency_jitter_s=seen.latency_jitter_s,
        frame=_offset(seen.frame),
        hand_markers=_offset(seen.hand_markers),
        object_markers=_offset(seen.object_markers),
    )


def _offset(offset: OffsetSetup) -> Offset:
    return Offset(np.array(offset.position_m), np.array(offset.rotation_rad))
