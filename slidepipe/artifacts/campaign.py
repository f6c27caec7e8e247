"""A whole loop of trials: one row each, with the truth beside the estimate where the lab was simulated."""

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from slidepipe.artifacts.schema import UPCASTS, Artifact, Data, Record
from slidepipe.artifacts.trial import Outcome
from slidepipe.artifacts.values import Interval, NotNegative, Pose, RunId, Slug, UncertainPose

CampaignOutcome = Literal["converged", "out of trials", "no progress", "lost", "no plan"]
"""How a campaign ended: within tolerance; its budget is spent; too many trials brought nothing; the object is gone; or
no motion within the limits would correct what is left."""


class CampaignRuns(Record):
    """The runs of one trial; null where the loop ended before."""

    plan: RunId
    execute: RunId | None
    estimate: RunId | None


class CampaignRow(Record):
    """One trial: planned, reached (as estimated) and true final relative pose; its error is from the goal.

    ``expected_error_m`` is what was expected to be left, and its 95 % interval; null for the first trial.
    """

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
    expected_error_m: NotNegative | None = None
    expected_interval_95_m: Interval | None = None
    worse: bool = False


class CampaignDocument(Artifact):
    """What is written as ``campaign.yaml``; ``what_to_do`` is for the person, null where there is nothing to do."""

    SCHEMA: ClassVar[str] = "slidepipe.campaign"
    VERSION: ClassVar[int] = 2

    experiment: Slug
    rows: tuple[CampaignRow, ...]
    converged: bool
    outcome: CampaignOutcome
    stopped_because: str | None
    what_to_do: str | None
    pictures: tuple[str, ...]


def _with_outcome(data: Data) -> Data:
    """Version 1 told the outcome by what stood beside it."""
    rows = data.get("rows")
    last = rows[-1] if isinstance(rows, list) and rows else {}
    if data.get("converged"):
        outcome = "converged"
    elif isinstance(last, dict) and last.get("outcome") == "lost":
        outcome = "lost"
    else:
        outcome = "out of trials" if data.get("stopped_because") is None else "no plan"
    return {**data, "outcome": outcome, "what_to_do": None}


UPCASTS[CampaignDocument.SCHEMA, 1] = _with_outcome
