"""Why the next plan is as it is: what was wrong, what is expected now, and what was changed in between."""

from typing import Annotated, ClassVar

from pydantic import Field

from slidepipe.artifacts.iteration_setup import Way
from slidepipe.artifacts.schema import Artifact, Record
from slidepipe.artifacts.values import Interval, NotNegative, Pose, RunId, Slug


class ErrorOf(Record):
    """Of a relative pose from the goal's: along each coordinate, and as distance and angle."""

    pose: Pose
    position_m: NotNegative
    angle_rad: NotNegative


class ExpectedError(Record):
    """What simulation expects to be left after the next trial, median and 95 % interval over ``draws`` worlds.

    The worlds have the friction's interval, the uncertainty of where the finger is, and ``model_miss_share``: by which
    share of the slide the model was wrong about the trials before.
    """

    position_m: NotNegative
    position_interval_95_m: Interval
    angle_rad: NotNegative
    angle_interval_95_rad: Interval
    lost_share: Annotated[float, Field(ge=0.0, le=1.0)]
    within_tolerance_share: Annotated[float, Field(ge=0.0, le=1.0)]
    model_miss_share: NotNegative
    draws: Annotated[int, Field(ge=1)]


class FrictionView(Record):
    """Friction that a plan is made for: its value, the interval that the next trial's lies in, and where it is from."""

    value: float
    interval_95: Interval | None
    source: str


class WhyDocument(Artifact):
    """What is written as ``why.yaml``; ``error_before`` is null where the object was lost and put back."""

    SCHEMA: ClassVar[str] = "slidepipe.why"

    experiment: Slug
    trial: Annotated[int, Field(ge=2)]
    previous_estimate: RunId
    way: Way
    error_before: ErrorOf | None
    friction_before: FrictionView
    friction_after: FrictionView
    expected_after: ExpectedError
    changed: tuple[str, ...]
