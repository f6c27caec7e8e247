"""What a calibration motion tells of the cameras, the hand's markers and the clocks, each with its uncertainty."""

from typing import ClassVar

from slidepipe.artifacts.schema import Artifact, Record
from slidepipe.artifacts.values import Count, NotNegative, RunId, Slug

Vector = tuple[float, float, float]


class Placement(Record):
    """Pose of one frame in another: position and rotation vector, each with one standard deviation."""

    position_m: Vector
    position_std_m: Vector
    rotation_rad: Vector
    rotation_std_rad: Vector


class Tilt(Record):
    """Rotation vector, in the object's markers, from their z axis to the normal of the motion plane."""

    rotation_rad: Vector
    std_rad: Vector


class CalibrationDocument(Artifact):
    """What is written as ``calibration.yaml``.

    ``hand_markers`` are in {f}: along z their deviation is large after a motion in a plane, and does not matter for
    another in it. ``object_tilt`` is null where the object was not there. ``heading_rad`` is the motion plane's in
    the base frame, ``lean_rad`` how far it leans out of the vertical.
    """

    SCHEMA: ClassVar[str] = "slidepipe.calibration"

    trial: RunId
    experiment: Slug
    cameras_in_base: Placement
    hand_markers: Placement
    object_tilt: Tilt | None
    heading_rad: float
    lean_rad: float
    plane_std_rad: NotNegative
    down_in_cameras: Vector
    down_std_rad: NotNegative
    joints_late_s: float
    joints_late_std_s: NotNegative
    turn_rad: NotNegative
    rms_m: NotNegative
    rms_rad: NotNegative
    frames: Count
    outliers: Count
    notes: tuple[str, ...]
