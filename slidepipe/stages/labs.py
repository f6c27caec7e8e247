"""From the words of a lab file to the values that the lab's processes work with."""

from dataclasses import dataclass

import numpy as np

from slidepipe.artifacts.experiment import Experiment
from slidepipe.artifacts.lab import Endpoint, FramePose, LabDocument, TrackedSetup
from slidepipe.lab.approach import MoveLimits, Pauses
from slidepipe.lab.camera_frame import CameraFrame, RigidPose, UpAxis
from slidepipe.lab.loop import LoopSettings
from slidepipe.lab.natnet.settings import NatNetSettings, TrackedBody, Transport
from slidepipe.lab.safety import SafetyLimits
from slidepipe.lab.transport import Address
from slidepipe.series import FloatArray


@dataclass(frozen=True, slots=True)
class LabSettings:
    """Everything that the streamer is told of a lab.

    Attributes
    ----------
    dialect : str
    local, remote : Address
        Of this host and of the arm's.
    cameras : NatNetSettings
    home_rad : (7,)
    moves : MoveLimits
    pauses : Pauses
    safety : SafetyLimits
    loop : LoopSettings
    connect_s, link_wait_s, driver_timeout_s, gripper_n : float
    """

    dialect: str
    local: Address
    remote: Address
    cameras: NatNetSettings
    home_rad: FloatArray
    moves: MoveLimits
    pauses: Pauses
    safety: SafetyLimits
    loop: LoopSettings
    connect_s: float
    link_wait_s: float
    driver_timeout_s: float
    gripper_n: float


def lab_settings(lab: LabDocument, experiment: Experiment) -> LabSettings:
    """Translate a lab file; how far an object may be from the hand that holds it, the experiment tells."""
    arm = lab.arm
    return LabSettings(
        dialect=arm.dialect,
        local=address(arm.local),
        remote=address(arm.remote),
        cameras=camera_settings(lab),
        home_rad=np.array(arm.home_pose_rad),
        moves=MoveLimits(
            np.array(arm.approach.speed_rad_s),
            np.array(arm.approach.acceleration_rad_s2),
            np.array(arm.approach.jerk_rad_s3),
        ),
        pauses=Pauses(lab.pauses.rest_s, lab.pauses.hold_s),
        safety=SafetyLimits(
            tracking_error_rad=np.array(arm.limits.tracking_error_rad),
            lower_rad=np.array(arm.limits.joint_lower_rad),
            upper_rad=np.array(arm.limits.joint_upper_rad),
            link_timeout_s=lab.timeouts.arm_s,
            mocap_timeout_s=lab.timeouts.cameras_s,
            object_timeout_s=lab.timeouts.object_s,
            object_reach_m=float(np.hypot(experiment.object.size_x_m, experiment.object.size_y_m)) / 2,
        ),
        loop=LoopSettings(lab.timeouts.link_s, arm.limits.jump_rad, lab.stop.slow_down_s, lab.stop.hold_s),
        connect_s=lab.timeouts.connect_s,
        link_wait_s=arm.link_wait_s,
        driver_timeout_s=arm.driver_timeout_s,
        gripper_n=arm.gripper_force_n,
    )


def address(endpoint: Endpoint) -> Address:
    """Translate an endpoint."""
    return Address(endpoint.host, endpoint.port)


def camera_settings(lab: LabDocument) -> NatNetSettings:
    """Translate how the cameras are reached."""
    cameras = lab.cameras
    return NatNetSettings(
        server=cameras.server,
        interface=cameras.interface,
        hand=_body(cameras.hand),
        object=_body(cameras.object),
        transport=Transport(cameras.transport),
        group=cameras.multicast_group,
        command_port=cameras.command_port,
        data_port=cameras.data_port,
        frame=CameraFrame(UpAxis(cameras.up_axis), _pose(cameras.frame)),
        timeout_s=lab.timeouts.connect_s,
    )


def _body(tracked: TrackedSetup) -> TrackedBody:
    return TrackedBody(tracked.body, _pose(tracked.offset))


def _pose(pose: FramePose) -> RigidPose:
    return RigidPose(pose.position_m, pose.quaternion_xyzw)
