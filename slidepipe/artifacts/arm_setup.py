"""The arm's part of the experiment file."""

from typing import Annotated, Literal

from pydantic import Field

from slidepipe.artifacts.schema import Record
from slidepipe.artifacts.values import Positive

Joints = Annotated[tuple[float, ...], Field(min_length=7, max_length=7)]
"""One number for each joint."""
PositiveJoints = Annotated[tuple[Positive, ...], Field(min_length=7, max_length=7)]


Within = Annotated[float, Field(ge=-10.0, le=10.0)]
"""Coordinate of what an arm that is a metre long may reach: what lies outside is in another unit."""


class PlaneSetup(Record):
    """The vertical plane of motion {w} in the arm's base frame."""

    origin_m: tuple[Within, Within, Within]
    heading_rad: float


class ToolSetup(Record):
    """From the flange to the contact point along the wrist axis, and the turn of {f} about it."""

    length_m: Annotated[float, Field(ge=0.0, le=2.0)]
    angle_rad: float


class ArmLimits(Record):
    """What a motion may ask of the arm."""

    joint_speed_rad_s: PositiveJoints
    joint_torque_n_m: PositiveJoints
    tip_speed_m_s: Positive
    elbow_speed_m_s: Positive
    hand_acceleration_m_s2: Positive | None = None
    joint_acceleration_rad_s2: PositiveJoints | None = None


class ArmSetup(Record):
    """The arm, where the motion happens in its reach, and what it may do; the redundancy keeps near ``posture_rad``."""

    model: Literal["wam7"]
    plane: PlaneSetup
    tool: ToolSetup
    posture_rad: Joints
    limits: ArmLimits
