"""What happened in one execution, and, from a simulated lab only, what was true in it."""

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from slidepipe.artifacts.schema import UPCASTS, Artifact, Data, Record
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


class StreamReport(Record):
    """How a real-time stream went.

    ``late_*`` is how late ticks began, ``late_share`` the share of those later than 1 ms, ``longest_gap_s`` the longest
    time that the arm was without a command; ``states_lost`` and ``frames_missing`` never arrived, ``records_lost`` did
    and were not recorded; ``not_permitted`` says what the machine did not let the streamer keep time with.
    """

    ticks: Count
    late_p50_s: float
    late_p99_s: float
    late_max_s: float
    late_share: Annotated[float, Field(ge=0.0, le=1.0)]
    longest_gap_s: NotNegative
    commands: Count
    states: Count
    states_lost: Count
    frames_missing: Count
    records_lost: Count
    not_permitted: tuple[str, ...]


class TrialDocument(Artifact):
    """What is written as ``trial.yaml``; the lab's outcome is what its operator or simulation saw.

    From ``started_ns`` to ``finished_ns`` the motion lasted; both are the time of the stop where it did not begin.
    ``stopped`` says why the arm was stopped on its way, ``invalid`` why the trial must not be estimated; ``stream`` is
    null where the lab was simulated in virtual time.
    """

    SCHEMA: ClassVar[str] = "slidepipe.trial"
    VERSION: ClassVar[int] = 2

    plan: RunId
    lab: Annotated[str, Field(min_length=1)]
    seed: Annotated[int, Field(ge=0)] | None
    outcome: Outcome
    started_ns: Stamp
    finished_ns: Stamp
    frames: FrameCounts
    tracking_error: TrackingError | None
    recording_file: str
    stopped: str | None = None
    invalid: str | None = None
    stream: StreamReport | None = None


def _of_version_1(data: Data) -> Data:
    """Trials before there were real-time labs: none was stopped."""
    return {**data, "stopped": None, "invalid": None, "stream": None}


UPCASTS[TrialDocument.SCHEMA, 1] = _of_version_1


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
