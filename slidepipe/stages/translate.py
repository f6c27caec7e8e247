"""From the words of the experiment file to the values that the rooms work with."""

import numpy as np

from slidepipe.arm.model import Tool
from slidepipe.artifacts.experiment import Experiment
from slidepipe.artifacts.values import Pose
from slidepipe.errors import InputError
from slidepipe.lab.cameras import CameraSettings
from slidepipe.lab.simulated import Tracker
from slidepipe.lab.world import ContactSettings, WorldSettings
from slidepipe.mechanics.dynamics import Block
from slidepipe.mechanics.limit_surface import SoftFinger
from slidepipe.mechanics.planar import MotionPlane
from slidepipe.planning.limits import Limits
from slidepipe.planning.planner import Setup
from slidepipe.planning.three_phase import Regrasp
from slidepipe.series import FloatArray

PINCH = 2
"""Fingers of the gripper in the simulated lab."""


def vector(pose: Pose) -> FloatArray:
    """``[x, y, theta]`` of a pose record."""
    return np.array(pose.vector)


def motion_plane(experiment: Experiment) -> MotionPlane:
    """The plane of motion in the arm's base frame."""
    plane = experiment.arm.plane
    return MotionPlane(np.array(plane.origin_m), plane.heading_rad)


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
        ),
    )


def first_regrasp(experiment: Experiment) -> Regrasp:
    """The motion that the experiment asks for."""
    return Regrasp(
        q_o_start=vector(experiment.start.object_pose),
        r_start=vector(experiment.start.relative_pose),
        r_goal=vector(experiment.goal.relative_pose),
        q_f_end=vector(experiment.goal.hand_pose),
        T1=experiment.motion.stick_s,
        T23=experiment.motion.slide_s,
        T4=experiment.motion.settle_s,
    )


def world(experiment: Experiment) -> WorldSettings:
    """The simulated world as the experiment's ``lab`` section says it is."""
    lab, thing = experiment.lab, experiment.object
    if experiment.grasp.finger_count != PINCH:
        raise InputError(
            f"grasp.finger_count: the simulated lab's gripper has {PINCH} fingers, got {experiment.grasp.finger_count}"
        )
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
    )
