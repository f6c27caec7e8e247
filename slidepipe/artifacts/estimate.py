"""What a recording tells: the clock, the slide, the relative poses and the friction, each with its uncertainty."""

from collections.abc import Iterator
from typing import ClassVar

from slidepipe.artifacts.faults import Fault
from slidepipe.artifacts.schema import Artifact, Record
from slidepipe.artifacts.values import Count, Interval, NotNegative, Positive, RunId, UncertainPose


class ClockFit(Record):
    """Camera clock on the host's: its offset, its rate, and the standard deviation of what the fit leaves."""

    offset_s: float
    rate_ppm: float
    residual_std_s: NotNegative


class SlideFound(Record):
    """When the object slid in the fingers, from the start of the trial on the host's clock."""

    start_s: float
    stop_s: float


class Measured(Record):
    """A value with one standard deviation and its 95 % interval."""

    value: float
    std: NotNegative
    interval_95: Interval


class Derived(Record):
    """A value that follows from another by an assumption; its 95 % interval does not cover the assumption."""

    value: float
    interval_95: Interval


class Assumed(Record):
    """What the recording cannot tell and the friction coefficient rests on."""

    normal_force_n: Positive
    mass_kg: Positive
    rho_m: Positive


class FrictionEstimate(Record):
    """Friction from the slide: mu f_N / m is measured, mu alone rests on what is assumed."""

    kappa_m_s2: Measured
    mu: Derived
    assumed: Assumed


class EstimateDocument(Artifact):
    """What is written as ``estimate.yaml``; a friction that is null has its reason beside it."""

    SCHEMA: ClassVar[str] = "slidepipe.estimate"

    trial: RunId
    clock: ClockFit
    frames_used: Count
    initial_relative_pose: UncertainPose | None
    final_relative_pose: UncertainPose | None
    lost: str | None
    slide: SlideFound | None
    friction: FrictionEstimate | None
    friction_missing_because: str | None
    notes: tuple[str, ...]
    series_file: str

    def faults(self) -> Iterator[Fault]:
        """Friction or a final pose without value and without reason, or with both."""
        if (self.friction is None) == (self.friction_missing_because is None):
            yield Fault(("friction",), "must have either a value or, in friction_missing_because, a reason")
        if (self.final_relative_pose is None) == (self.lost is None):
            yield Fault(("final_relative_pose",), "must have either a value or, in lost, a reason")
