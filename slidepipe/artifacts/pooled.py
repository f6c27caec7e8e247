"""What the trials of an experiment tell together: friction with its spread, and how well they repeat."""

from collections.abc import Iterator
from typing import Annotated, ClassVar

from pydantic import Field

from slidepipe.artifacts.estimate import Assumed, Derived, Measured
from slidepipe.artifacts.faults import Fault
from slidepipe.artifacts.schema import Artifact, Record
from slidepipe.artifacts.values import Count, Interval, NotNegative, Pose, Positive, RunId, Slug, UncertainPose

Chance = Annotated[float, Field(ge=0.0, le=1.0)]


class PooledValue(Record):
    """One quantity over the trials, all in its own unit.

    ``within_std`` is the noise of a usual estimate, ``between_std`` the spread of the trials' own values, and
    ``predictive`` where the next trial's value will be; ``same_value_p`` is small where one value is not all there is.
    """

    trials: Count
    value: float
    std: NotNegative
    interval_95: Interval
    within_std: NotNegative
    between_std: NotNegative
    between_interval_95: Interval
    predictive_std: NotNegative
    predictive_interval_95: Interval
    same_value_p: Chance


class PooledTrial(Record):
    """One trial: what was planned, where it ended (``error`` is final minus goal), and whether it stands out."""

    LATER: ClassVar[frozenset[str]] = frozenset({"rho_m", "rho_surprise_p", "rho_outlying"})

    trial: RunId
    estimate: RunId | None
    start_relative_pose: Pose
    goal_relative_pose: Pose
    initial_relative_pose: UncertainPose | None
    final_relative_pose: UncertainPose | None
    error: Pose | None
    error_outlying: bool
    kappa_m_s2: Measured | None
    kappa_surprise_p: Chance | None
    kappa_outlying: bool
    left_out_because: tuple[str, ...]
    rho_m: Measured | None = None
    rho_surprise_p: Chance | None = None
    rho_outlying: bool = False


class Repeatability(Record):
    """Mean of the final errors and their standard deviation about it; null for a single trial."""

    trials: Count
    mean_error: Pose
    std_error: Pose | None


class PooledDocument(Artifact):
    """What is written as ``pooled.yaml``; ``rho_m`` is null where no trial turned enough to tell it."""

    SCHEMA: ClassVar[str] = "slidepipe.pooled"
    LATER: ClassVar[frozenset[str]] = frozenset({"rho_m"})

    experiment: Slug
    trials: tuple[PooledTrial, ...]
    kappa_m_s2: PooledValue | None
    mu: Derived | None
    assumed: Assumed
    between_scale: Positive
    repeatability: Repeatability | None
    notes: tuple[str, ...]
    picture: str | None
    rho_m: PooledValue | None = None

    def faults(self) -> Iterator[Fault]:
        """Friction coefficient without what it follows from."""
        if (self.kappa_m_s2 is None) != (self.mu is None):
            yield Fault(("mu",), "must have a value where kappa_m_s2 has one, and only there")
