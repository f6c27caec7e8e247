"""A whole loop of trials: one row each, with the truth beside the estimate where the lab was simulated."""

from typing import Annotated, ClassVar

from pydantic import Field

from slidepipe.artifacts.schema import Artifact, Record
from slidepipe.artifacts.trial import Outcome
from slidepipe.artifacts.values import Interval, NotNegative, Pose, RunId, Slug, UncertainPose


class CampaignRuns(Record):
    """The runs of one trial; null where the loop ended before."""

    plan: RunId
    execute: RunId | None
    estimate: RunId | None


class CampaignRow(Record):
    """One trial: planned, reached (as estimated) and true final relative pose; its error is from the goal."""

    trial: Annotated[int, Field(ge=1)]
    runs: CampaignRuns
    outcome: Outcome | None
    planned_relative_pose: Pose
    reached_relative_pose: UncertainPose | None
    true_relative_pose: Pose | None
    error_m: NotNegative | None
    error_rad: NotNegative | None
    true_error_m: NotNegative | None
    true_error_rad: NotNegative | None
    believed_friction: float
    estimated_friction: float | None
    estimated_friction_interval_95: Interval | None
    true_friction: float | None


class CampaignDocument(Artifact):
    """What is written as ``campaign.yaml``."""

    SCHEMA: ClassVar[str] = "slidepipe.campaign"

    experiment: Slug
    rows: tuple[CampaignRow, ...]
    converged: bool
    stopped_because: str | None
    pictures: tuple[str, ...]
