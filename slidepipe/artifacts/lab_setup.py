"""The simulated world's part of the experiment file: what friction, tracking and cameras really are."""

from typing import Annotated, Literal

from pydantic import Field

from slidepipe.artifacts.schema import Record
from slidepipe.artifacts.values import Friction, NotNegative, Share


class TrackerSetup(Record):
    """How the arm follows: as a WAM does, or perfectly.

    ``mass_error`` is by how much the real links are heavier than the feedforward believes; ``joint_friction_scale``
    multiplies the joint friction that it believes.
    """

    kind: Literal["wam", "perfect"] = "wam"
    feedforward: bool = True
    mass_error: Annotated[float, Field(gt=-1.0, le=1.0)] = 0.05
    joint_friction_scale: NotNegative = 1.0


class OffsetSetup(Record):
    """Where a frame really is in the one that it is taken for: position, and rotation vector."""

    position_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rotation_rad: tuple[float, float, float] = (0.0, 0.0, 0.0)


class CameraSetup(Record):
    """The motion capture: its noise (one standard deviation), its losses, its clock and its frames.

    ``frame`` is the cameras' own in the arm's base frame, ``hand_markers`` and ``object_markers`` are what they track,
    in {f} and in {b}; ``slidepipe calibrate`` finds the first two.
    """

    rate_hz: Annotated[float, Field(gt=0.0, le=2000.0)] = 360.0
    position_noise_m: NotNegative = 0.0003
    angle_noise_rad: NotNegative = 0.003
    dropout_share: Share = 0.02
    clock_offset_s: float = 12.3
    clock_drift_ppm: Annotated[float, Field(ge=-1e4, le=1e4)] = 20.0
    latency_s: Annotated[float, Field(ge=0.0, le=10.0)] = 0.006
    latency_jitter_s: Annotated[float, Field(ge=0.0, le=10.0)] = 0.0004
    frame: OffsetSetup = OffsetSetup()
    hand_markers: OffsetSetup = OffsetSetup()
    object_markers: OffsetSetup = OffsetSetup()


class ContactSetup(Record):
    """How stiff the simulated contact is, and how finely time is cut."""

    timestep_s: Annotated[float, Field(ge=1e-6, le=0.002)] = 2.5e-05
    solref_s: Annotated[float, Field(gt=0.0, le=1.0)] = 0.0001
    impratio: Annotated[float, Field(ge=1.0)] = 1000.0


class GraspError(Record):
    """By how much the finger is first put down beside ``start.relative_pose``, which the planner believes."""

    x_m: Annotated[float, Field(ge=-0.1, le=0.1)] = 0.0
    y_m: Annotated[float, Field(ge=-0.1, le=0.1)] = 0.0
    theta_rad: Annotated[float, Field(ge=-1.0, le=1.0)] = 0.0


class Scatter(Record):
    """What differs from trial to trial in the same world, one standard deviation each.

    The shares are of ``friction`` and of the normal force; ``grasp_`` is how a finger is put down anew.
    """

    friction_share: Annotated[float, Field(ge=0.0, le=0.3)] = 0.0
    normal_force_share: Annotated[float, Field(ge=0.0, le=0.3)] = 0.0
    grasp_position_m: Annotated[float, Field(ge=0.0, le=0.01)] = 0.0
    grasp_angle_rad: Annotated[float, Field(ge=0.0, le=0.3)] = 0.0


class LabSetup(Record):
    """The simulated world."""

    seed: Annotated[int, Field(ge=0, lt=2**63)]
    friction: Friction
    normal_force_per_finger_n: Annotated[float, Field(gt=0.0, le=1000.0)]
    tracker: TrackerSetup = TrackerSetup()
    cameras: CameraSetup = CameraSetup()
    contact: ContactSetup = ContactSetup()
    grasp_error: GraspError = GraspError()
    scatter: Scatter = Scatter()
