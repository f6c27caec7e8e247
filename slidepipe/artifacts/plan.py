"""The plan: what motion was chosen, why, and how near it comes to every limit."""

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from slidepipe.artifacts.schema import UPCASTS, Artifact, Data, Record
from slidepipe.artifacts.values import Friction, NotNegative, Planar, Pose, Positive, RunId, Slug


class Belief(Record):
    """What the planner took for true: mu, mu f_N / m, and c a; ``friction_std`` is null where nobody measured it."""

    friction: Friction
    friction_std: NotNegative | None
    kappa_m_s2: Positive
    rho_m: Positive


PhaseName = Literal["stick", "slide", "catch", "settle"]


class Phase(Record):
    """One phase; the object's acceleration in {w} is null where it is not constant."""

    name: PhaseName
    start_s: NotNegative
    stop_s: NotNegative
    object_acceleration: Planar | None


class Slide(Record):
    """The bang-bang slide: ``relative_acceleration`` in {b} until ``switch_s``, from there ``braking_acceleration``.

    Where the latter is null it is the opposite of the former.
    """

    start_s: NotNegative
    switch_s: NotNegative
    stop_s: NotNegative
    relative_acceleration: Planar
    braking_acceleration: Planar | None = None


class FrictionPoint(Record):
    """Where the finger would end on the object under one friction; ``error_share`` is what is left of the way."""

    friction: Positive
    relative_pose: Pose
    error_share: NotNegative
    survived: bool


class Robustness(Record):
    """What wrong friction does to the plan, from simulated trials.

    ``friction_error`` is the largest share by which the friction may be wrong either way such that the finger stays
    on the object, the object does not turn away, and the finger ends nearer to the goal than it began;
    ``contraction`` is the largest share of the error that is left while the friction is wrong by no more than
    ``contraction_within``.
    """

    friction_error: NotNegative
    below: NotNegative
    binds_below: str
    above: NotNegative
    binds_above: str
    contraction: NotNegative
    contraction_within: NotNegative
    map: tuple[FrictionPoint, ...]


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
    VERSION: ClassVar[int] = 2

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
    objective: str | None = None
    normal_force_n: Positive | None = None
    robustness: Robustness | None = None


def _first_to_second(data: Data) -> Data:
    """Version 1 said nothing of objectives, the normal force, a braking of its own and wrong friction."""
    return data


UPCASTS[PlanDocument.SCHEMA, 1] = _first_to_second
