"""What happened in one execution, and, from a simulated lab only, what was true in it."""

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from slidepipe.artifacts.schema import Artifact, Record
from slidepipe.artifacts.values import Count, Friction, NotNegative, Pose, Positive, RunId, Stamp

Outcome = Literal["held", "lost"]


class FrameCounts(Record):
    """How many frames the cameras took, and in how many a body was not tracked."""

    taken: Count
    hand_missing: Count
    object_missing: Count
    longest_gap_s: NotNegative


class TrackingError(Record):
    """How far the hand was from its reference."""

    position_rms_m: NotNegative
    position_peak_m: NotNegative
    angle_rms_rad: NotNegative
    angle_peak_rad: NotNegative


class TrialDocument(Artifact):
    """What is written as ``trial.yaml``; the lab's outcome is what its operator or simulation saw."""

    SCHEMA: ClassVar[str] = "slidepipe.trial"

    plan: RunId
    lab: Annotated[str, Field(min_length=1)]
    seed: Annotated[int, Field(ge=0)] | None
    outcome: Outcome
    started_ns: Stamp
    finished_ns: Stamp
    frames: FrameCounts
    tracking_error: TrackingError | None
    recording_file: str


class TruthDocument(Artifact):
    """What is written as ``truth.yaml``: the simulated world's own values, which no estimate may read.

    The times of sliding count from the start of the motion, and are null where nothing slid.
    """

    SCHEMA: ClassVar[str] = "slidepipe.truth"

    friction: Friction
    normal_force_per_finger_n: Positive
    kappa_m_s2: Positive
    rho_m: Positive
    initial_relative_pose: Pose
    final_relative_pose: Pose
    slide_start_s: float | None
    slide_stop_s: float | None
    outcome: Outcome
