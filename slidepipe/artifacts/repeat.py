"""One plan executed many times: how well it repeats, as the paper's Fig. 12 shows it."""

from typing import Annotated, ClassVar

from pydantic import Field

from slidepipe.artifacts.schema import Artifact, Record
from slidepipe.artifacts.trial import Outcome
from slidepipe.artifacts.values import Count, Planar, Pose, RunId, Slug


class Repetition(Record):
    """One execution: error of the final relative pose from the goal as estimated, and as it truly was."""

    repetition: Annotated[int, Field(ge=1)]
    execute: RunId
    estimate: RunId
    outcome: Outcome
    error: Pose | None
    true_error: Pose | None


class Repeatability(Record):
    """Mean and standard deviation of errors along x, y (m) and theta (rad); ``std`` is null for a single one."""

    trials: Count
    mean: Planar
    std: Planar | None


class RepeatDocument(Artifact):
    """What is written as ``repeat.yaml``; ``estimated`` and ``true`` are null where no trial held the object."""

    SCHEMA: ClassVar[str] = "slidepipe.repeat"

    experiment: Slug
    plan: RunId
    rows: tuple[Repetition, ...]
    lost: Count
    estimated: Repeatability | None
    true: Repeatability | None
