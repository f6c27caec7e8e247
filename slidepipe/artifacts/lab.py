"""The lab file: how a laboratory is reached, what it may do, and when it is given up."""

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from slidepipe.artifacts.arm_setup import Joints, PositiveJoints
from slidepipe.artifacts.faults import Fault
from slidepipe.artifacts.lab_names import labs
from slidepipe.artifacts.schema import Artifact, Record, parse
from slidepipe.artifacts.shapes import HOST
from slidepipe.artifacts.strict_yaml import load
from slidepipe.artifacts.values import NotNegative, Positive, Slug
from slidepipe.artifacts.wording import instead
from slidepipe.errors import NotFoundError

Host = Annotated[str, Field(pattern=HOST)]
"""An IPv4 address: of one interface, never of all."""
Port = Annotated[int, Field(ge=1, le=65535)]
Seconds = Annotated[float, Field(gt=0.0, le=3600.0)]


class Endpoint(Record):
    """An address and a UDP port."""

    host: Host
    port: Port


class MoveSetup(Record):
    """How fast the arm goes to the start pose and home."""

    speed_rad_s: PositiveJoints
    acceleration_rad_s2: PositiveJoints
    jerk_rad_s3: PositiveJoints


class LabArmLimits(Record):
    """What this laboratory's arm may do; ``torque_beyond_gravity_n_m`` is the clip of the program that drives it."""

    joint_lower_rad: Joints
    joint_upper_rad: Joints
    joint_speed_rad_s: PositiveJoints
    torque_beyond_gravity_n_m: PositiveJoints
    elbow_speed_m_s: Positive
    tracking_error_rad: PositiveJoints
    jump_rad: Positive


class ArmLink(Record):
    """How the arm is driven.

    ``dialect`` is what its program speaks: ``positions`` is the vendor's own example, ``velocities`` wam_teleop,
    ``bridge`` our own program. ``driver_timeout_s`` is how long that program goes on without a command, ``link_wait_s``
    how long the arm is given to follow where the dialect does not tell whether it does.
    """

    dialect: Literal["positions", "velocities", "bridge"]
    local: Endpoint
    remote: Endpoint
    driver_timeout_s: Seconds
    link_wait_s: NotNegative
    gripper_force_n: NotNegative
    home_pose_rad: Joints
    limits: LabArmLimits
    approach: MoveSetup


class FramePose(Record):
    """Pose of a frame in another."""

    position_m: tuple[float, float, float]
    quaternion_xyzw: tuple[float, float, float, float]


class TrackedSetup(Record):
    """A rigid body of the cameras, by its name or its number, and our frame in it."""

    body: str | int
    offset: FramePose = FramePose(position_m=(0.0, 0.0, 0.0), quaternion_xyzw=(0.0, 0.0, 0.0, 1.0))


class CameraLink(Record):
    """How the cameras are heard: NatNet; ``frame`` is theirs in the arm's base frame, once its z axis points up."""

    server: Host
    interface: Host
    transport: Literal["unicast", "multicast"]
    multicast_group: Host
    command_port: Port
    data_port: Port
    rate_hz: Annotated[float, Field(gt=0.0, le=2000.0)]
    up_axis: Literal["y", "z"]
    frame: FramePose
    hand: TrackedSetup
    object: TrackedSetup


class Timeouts(Record):
    """How long to wait, s: for an answer, for the arm to follow; and while it moves, for its states, frames, object."""

    connect_s: Seconds
    link_s: Seconds
    arm_s: Seconds
    cameras_s: Seconds
    object_s: Seconds


class StopSetup(Record):
    """How long a stop along the path takes, and how long the arm is held after it."""

    slow_down_s: Seconds
    hold_s: Seconds


class Pauses(Record):
    """How long the arm rests on either side of the motion, half a second at least, and holds at home in the end."""

    rest_s: Annotated[float, Field(ge=0.5, le=60.0)]
    hold_s: NotNegative


class LabDocument(Artifact):
    """What is written as ``labs/NAME.yaml``."""

    SCHEMA: ClassVar[str] = "slidepipe.lab"

    name: Slug
    arm: ArmLink
    cameras: CameraLink
    timeouts: Timeouts
    stop: StopSetup
    pauses: Pauses

    def faults(self) -> Iterator[Fault]:
        """Ranges that are none, a home outside them, frames that are not turned, and ports given twice."""
        limits = self.arm.limits
        for joint, (low, at, high) in enumerate(
            zip(limits.joint_lower_rad, self.arm.home_pose_rad, limits.joint_upper_rad, strict=True)
        ):
            if not low <= at <= high:
                yield Fault(
                    ("arm", "home_pose_rad", joint),
                    f"must be within the joint's limits {low:g} and {high:g} rad, got {at} rad",
                )
        if self.arm.local == self.arm.remote:
            yield Fault(("arm", "local"), "must differ from arm.remote: both ends cannot have the same port")
        for path in (("cameras", "frame"), ("cameras", "hand", "offset"), ("cameras", "object", "offset")):
            yield from self._turned(path)
        if self.timeouts.arm_s > self.arm.driver_timeout_s * 10:
            yield Fault(
                ("timeouts", "arm_s"), "must be at most ten times arm.driver_timeout_s: the arm is limp by then"
            )

    def _turned(self, path: tuple[str, ...]) -> Iterator[Fault]:
        pose: object = self
        for key in path:
            pose = getattr(pose, key)
        if isinstance(pose, FramePose):
            length = sum(part**2 for part in pose.quaternion_xyzw) ** 0.5
            if abs(length - 1.0) > 1e-3:
                yield Fault((*path, "quaternion_xyzw"), f"must have the length 1, got {length:.4g}")


def find_lab(name: str, beside: Path) -> Path:
    """Path of a lab's file: ``name`` is a path, or a name beside the experiments or in ``experiments``.

    Raises
    ------
    NotFoundError
        There is none; names those that are there.
    """
    if name.endswith((".yaml", ".yml")) or "/" in name:
        path = Path(name)
        if not path.is_file():
            raise NotFoundError(f"lab {name}: there is no such file")
        return path
    there = labs(beside)
    if name not in there:
        raise NotFoundError(f"lab {name}: no {beside / 'labs' / name}.yaml, {instead(name, list(there))}")
    return there[name]


def load_lab(path: Path) -> LabDocument:
    """Read a lab file.

    Raises
    ------
    InputError
        One line for every fault, with file, line and column.
    """
    return parse(LabDocument, load(path))
