"""The plan: what motion was chosen, why, and how near it comes to every limit."""

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from slidepipe.artifacts.schema import Artifact, Record
from slidepipe.artifacts.values import Friction, NotNegative, Planar, Pose, Positive, RunId, Slug


class Belief(Record):
    """What the planner took for true: mu, mu f_N / m, and c a; ``friction_std`` is null where nobody measured it."""

    friction: Friction
    friction_std: NotNegative | None
    kappa_m_s2: Positive
    rho_m: Positive


class Phase(Record):
    """One phase; the object's acceleration in {w} is null where it is not constant."""

    name: Literal["stick", "slide", "settle"]
    start_s: NotNegative
    stop_s: NotNegative
    object_acceleration: Planar | None


class Slide(Record):
    """The bang-bang slide: ``relative_acceleration`` in {b} until ``switch_s``, its opposite from there."""

    start_s: NotNegative
    switch_s: NotNegative
    stop_s: NotNegative
    relative_acceleration: Planar


class LimitCheck(Record):
    """A quantity at its worst moment beside its bound."""

    name: str
    value: float
    bound: float
    unit: str
    time_s: float
    satisfied: bool


class PlanDocument(Artifact):
    """What is written as ``plan.yaml``."""

    SCHEMA: ClassVar[str] = "slidepipe.plan"

    experiment: Slug
    trial: Annotated[int, Field(ge=1)]
    reason: str
    previous_estimate: RunId | None
    believed: Belief
    start_relative_pose: Pose
    goal_relative_pose: Pose
    object_start_pose: Pose
    hand_start_pose: Pose
    hand_end_pose: Pose
    phases: tuple[Phase, ...]
    object_velocity_at_slide: Planar
    slide: Slide
    margins: tuple[LimitCheck, ...]
    limits: tuple[LimitCheck, ...]
    reference_file: str
