"""What a recording tells: the clock, the slide, the relative poses and the friction, each with its uncertainty."""

from collections.abc import Iterator
from typing import ClassVar

from slidepipe.artifacts.faults import Fault
from slidepipe.artifacts.schema import UPCASTS, Artifact, Data, Record
from slidepipe.artifacts.values import Count, Interval, NotNegative, Positive, RunId, UncertainPose

NORMAL_FORCE_RELATIVE_STD, MASS_RELATIVE_STD = 0.05, 0.01
"""What a gripper's force and a scale are taken to be good for, where nobody says better."""


class ClockFit(Record):
    """Camera clock on the host's: its offset, its rate, and the standard deviation of what the fit leaves."""

    offset_s: float
    rate_ppm: float
    residual_std_s: NotNegative


class JointClock(Record):
    """Cameras against the joint log: how late their stamps were, and how gravity is turned in their plane of motion."""

    offset_s: float
    offset_std_s: NotNegative
    gravity_angle_rad: float
    gravity_angle_std_rad: NotNegative


class Smoothing(Record):
    """Mean normalised innovation squared of x, y and theta while moving; one where the smoother's model holds."""

    hand_nis: tuple[NotNegative, NotNegative, NotNegative]
    object_nis: tuple[NotNegative, NotNegative, NotNegative]
    relative_nis: tuple[NotNegative, NotNegative, NotNegative]


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


class Budget(Record):
    """Where the uncertainty of mu comes from, each over its value; of force and mass so much is assumed."""

    kappa_relative_std: NotNegative
    normal_force_relative_std: NotNegative
    mass_relative_std: NotNegative
    mu_relative_std: NotNegative


class Fit(Record):
    """How well the poses fit, from when to when they were used, and what kappa hangs on.

    ``sticking_agrees`` tells whether the rests around the slide entered; the changes are those of the logarithm of
    kappa for a growth of friction with speed, and for a turn of gravity.
    """

    chi_square: NotNegative
    outlier_share: NotNegative
    frames: Count
    start_s: float
    stop_s: float
    sticking_agrees: bool
    kappa_change_per_growth_s_m: float
    kappa_change_per_gravity_rad: float


class FrictionEstimate(Record):
    """Friction from the slide: mu f_N / m is measured, c a where the slide turned; mu alone rests on what is assumed.

    ``mu`` and its interval take force and mass as exact, as a plan does that assumes the same; ``mu_budget`` does not.
    What the experiment leaves open and the trial tells: ``growth_s_m`` of friction with sliding speed, ``static_share``
    (mu_s / mu_k), ``inverse_exponent`` of the pressure (0 even, 0.5 Hertz, 1 a cone). What it does not tell is null.
    """

    LATER: ClassVar[frozenset[str]] = frozenset({"growth_s_m", "static_share", "inverse_exponent"})

    kappa_m_s2: Measured
    rho_m: Measured | None
    mu: Derived
    assumed: Assumed
    mu_budget: Budget | None
    fit: Fit | None
    growth_s_m: Measured | None = None
    static_share: Measured | None = None
    inverse_exponent: Measured | None = None


class EstimateDocument(Artifact):
    """What is written as ``estimate.yaml``; a friction that is null has its reason beside it."""

    SCHEMA: ClassVar[str] = "slidepipe.estimate"
    VERSION: ClassVar[int] = 2

    trial: RunId
    clock: ClockFit
    joints: JointClock | None
    frames_used: Count
    outliers: Count | None
    smoothing: Smoothing | None
    initial_relative_pose: UncertainPose | None
    final_relative_pose: UncertainPose | None
    lost: str | None
    slide: SlideFound | None
    friction: FrictionEstimate | None
    friction_missing_because: str | None
    not_told: tuple[str, ...]
    notes: tuple[str, ...]
    series_file: str

    def faults(self) -> Iterator[Fault]:
        """Friction or a final pose without value and without reason, or with both."""
        if (self.friction is None) == (self.friction_missing_because is None):
            yield Fault(("friction",), "must have either a value or, in friction_missing_because, a reason")
        if (self.final_relative_pose is None) == (self.lost is None):
            yield Fault(("final_relative_pose",), "must have either a value or, in lost, a reason")


def _first_to_second(data: Data) -> Data:
    """Version 1 knew neither the joints' clock nor the fit's quality, and told only kappa and mu of the friction."""
    friction = data.get("friction")
    if isinstance(friction, dict):
        friction = friction | {"rho_m": None, "mu_budget": None, "fit": None}
    new: Data = {"joints": None, "outliers": None, "smoothing": None, "not_told": []}
    return data | new | {"friction": friction}


UPCASTS[EstimateDocument.SCHEMA, 1] = _first_to_second
