"""Section III's experiment: its file, its plan and its trials."""

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from slidepipe.artifacts.faults import Fault
from slidepipe.artifacts.overrides import apply_overrides
from slidepipe.artifacts.schema import Artifact, Record, parse
from slidepipe.artifacts.strict_yaml import load
from slidepipe.artifacts.values import Friction, NotNegative, Positive, Slug

OneDofOutcome = Literal["converged", "out of trials", "nothing slides", "grows"]


class OneDofExperiment(Artifact):
    """A finger shakes an object along a line until it slides; the paper's symbols stand beside the keys.

    ``tearing_acceleration_m_s2`` is a_f, ``acceleration_m_s2`` is a, ``slide_m`` d_goal and ``friction_error`` epsilon.
    """

    SCHEMA: ClassVar[str] = "slidepipe.one_dof"

    name: Slug
    mass_kg: Annotated[float, Field(gt=0.0, le=50.0)]
    normal_force_n: Annotated[float, Field(gt=0.0, le=1000.0)]
    friction: Friction
    friction_error: Annotated[float, Field(ge=0.0, lt=1.0)]
    true_frictions: Annotated[tuple[Friction, ...], Field(min_length=1, max_length=100)]
    acceleration_m_s2: Positive
    tearing_acceleration_m_s2: Positive
    slide_m: Annotated[float, Field(ge=-2.0, le=2.0)]
    tolerance_m: Positive
    trials: Annotated[int, Field(ge=1, le=100)]

    @property
    def friction_acceleration_m_s2(self) -> float:
        """Believed a_o = mu f_N / m."""
        return self.friction * self.normal_force_n / self.mass_kg

    def faults(self) -> Iterator[Fault]:
        """Accelerations that cannot stick or cannot slide, and a slide of nothing."""
        a_o = self.friction_acceleration_m_s2
        told = f"the believed friction acceleration a_o = mu f_N / m = {a_o:.6g} m/s^2"
        if not self.acceleration_m_s2 < a_o:
            yield Fault(
                ("acceleration_m_s2",), f"must be below {told}, else nothing sticks, got {self.acceleration_m_s2!r}"
            )
        if not self.tearing_acceleration_m_s2 > a_o:
            yield Fault(
                ("tearing_acceleration_m_s2",),
                f"must be above {told}, else nothing slides, got {self.tearing_acceleration_m_s2!r}",
            )
        if abs(self.slide_m) <= self.tolerance_m:
            yield Fault(("slide_m",), f"must be longer than tolerance_m = {self.tolerance_m!r}, got {self.slide_m!r}")


class ConditionCheck(Record):
    """One of Theorem 1's conditions at ``friction_error``, and below which error it holds."""

    name: str
    left_m_s2: float
    relation: Literal["<", ">"]
    right_m_s2: float
    satisfied: bool
    holds_below: float


class OneDofPlan(Artifact):
    """What is written as ``one_dof_plan.yaml``: the times of eq. (4), the profile, and what Theorem 1 promises.

    ``profile`` holds the finger's (from s, to s, acceleration m/s^2); ``contraction_bound`` is the largest share of the
    distance that a trial may leave, null where the conditions do not all hold.
    """

    SCHEMA: ClassVar[str] = "slidepipe.one_dof_plan"

    experiment: Slug
    friction: float
    friction_acceleration_m_s2: Positive
    slide_m: float
    T1_s: Positive
    T2_s: Positive
    T3_s: Positive
    T4_s: Positive
    profile: tuple[tuple[float, float, float], ...]
    peak_speed_m_s: NotNegative
    peak_travel_m: NotNegative
    friction_error: NotNegative
    conditions: tuple[ConditionCheck, ...]
    eps_star: NotNegative
    eps_star_bound_by: str
    contraction_bound: NotNegative | None

    @property
    def converges(self) -> bool:
        """Whether Theorem 1 promises that repeating converges for every friction within ``friction_error``."""
        return all(condition.satisfied for condition in self.conditions)


class OneDofTrial(Record):
    """One trial: what was left to slide, how far it slid, what is left then, and the share ``factor`` that is left."""

    left_before_m: float
    slid_m: float
    left_after_m: float
    factor: NotNegative


class OneDofSeries(Record):
    """The trials under one true friction.

    ``error`` is that friction's relative error; ``inside`` whether it is within ``friction_error``. ``within_bound`` is
    null where there is no bound to keep to.
    """

    friction: float
    error: float
    inside: bool
    trials: tuple[OneDofTrial, ...]
    largest_factor: NotNegative
    within_bound: bool | None
    outcome: OneDofOutcome
    said: str


class OneDofTrials(Artifact):
    """What is written as ``one_dof_trials.yaml``; ``verdict`` is of the frictions inside the allowed interval."""

    SCHEMA: ClassVar[str] = "slidepipe.one_dof_trials"

    experiment: Slug
    simulation: str
    friction_error: NotNegative
    eps_star: NotNegative
    contraction_bound: NotNegative | None
    tolerance_m: Positive
    series: tuple[OneDofSeries, ...]
    confirmed: bool
    verdict: str


def load_one_dof(path: Path, overrides: Iterable[str] = ()) -> OneDofExperiment:
    """Read a one-DOF experiment file, with ``key=value`` set over it; errors as ``load_experiment``'s."""
    return parse(OneDofExperiment, apply_overrides(load(path), overrides))
