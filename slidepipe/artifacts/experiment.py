"""The experiment file: what is to be regrasped, with what, where to, and in which world it is tried."""

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Annotated, ClassVar

from pydantic import Field

from slidepipe.artifacts.arm_setup import ArmSetup
from slidepipe.artifacts.faults import Fault
from slidepipe.artifacts.iteration_setup import Iteration, upcast_iteration
from slidepipe.artifacts.lab_setup import LabSetup
from slidepipe.artifacts.overrides import apply_overrides
from slidepipe.artifacts.schema import UPCASTS, Artifact, Record, parse
from slidepipe.artifacts.strict_yaml import load
from slidepipe.artifacts.values import Friction, Pose, Positive, Slug
from slidepipe.tick import TICK_S

TICK_TOLERANCE = 1e-6
"""How far from a whole number of ticks a time may be, in ticks."""
Length = Annotated[float, Field(gt=0.0, le=2.0)]
Duration = Annotated[float, Field(gt=0.0, le=60.0)]


class ObjectBlock(Record):
    """The block: its sides along the body's x and y, and its thickness along the plane's normal."""

    size_x_m: Length
    size_y_m: Length
    thickness_m: Length
    mass_kg: Annotated[float, Field(gt=0.0, le=50.0)]


class Grasp(Record):
    """The fingers that press on the block, taken together as one soft contact."""

    finger_count: Annotated[int, Field(ge=1, le=10)]
    normal_force_per_finger_n: Annotated[float, Field(gt=0.0, le=1000.0)]
    contact_radius_m: Annotated[float, Field(gt=0.0, le=0.5)]
    torsion_constant: Annotated[float, Field(gt=0.0, le=1.0)]

    @property
    def normal_force_n(self) -> float:
        """f_N, the normal force of all fingers together, N."""
        return self.finger_count * self.normal_force_per_finger_n

    @property
    def rho_m(self) -> float:
        """Ratio of the largest friction torque to the largest friction force: c a, m."""
        return self.torsion_constant * self.contact_radius_m


class Start(Record):
    """Where everything rests before the motion: the object in {w}, the finger in {b}."""

    object_pose: Pose
    relative_pose: Pose


class Tolerance(Record):
    """How near to the goal is near enough."""

    position_m: Positive
    angle_rad: Positive


class Goal(Record):
    """Where the finger shall be in {b}, and where in {w} the hand comes to rest."""

    relative_pose: Pose
    hand_pose: Pose
    tolerance: Tolerance


class PhaseTimes(Record):
    """Durations of the three phases: the paper's T1, T23 and T4."""

    stick_s: Duration
    slide_s: Duration
    settle_s: Duration


class Workspace(Record):
    """The disc of {w} that the hand stays in."""

    centre_x_m: float
    centre_y_m: float
    radius_m: Annotated[float, Field(gt=0.0, le=10.0)]


class Experiment(Artifact):
    """One experiment; ``friction`` is what the planner believes, ``lab.friction`` what the simulated world has."""

    SCHEMA: ClassVar[str] = "slidepipe.experiment"
    VERSION: ClassVar[int] = 2

    name: Slug
    object: ObjectBlock
    grasp: Grasp
    friction: Friction
    start: Start
    goal: Goal
    motion: PhaseTimes
    workspace: Workspace
    arm: ArmSetup
    iteration: Iteration
    lab: LabSetup

    @property
    def kappa_m_s2(self) -> float:
        """Believed mu f_N / m, the largest acceleration that friction can give the object, m/s^2."""
        return self.friction * self.grasp.normal_force_n / self.object.mass_kg

    @property
    def rho_m(self) -> float:
        """Believed ratio of the largest friction torque to the largest friction force, m."""
        return self.grasp.rho_m

    @property
    def true_kappa_m_s2(self) -> float:
        """The mu f_N / m of the simulated world, m/s^2."""
        force_n = self.grasp.finger_count * self.lab.normal_force_per_finger_n
        return self.lab.friction * force_n / self.object.mass_kg

    def faults(self) -> Iterator[Fault]:
        """Contact points beside the object, a goal that asks for nothing, and times off the control loop's beat."""
        for name in ("start", "goal"):
            pose = getattr(self, name).relative_pose
            yield from self._beside(name, "x_m", pose.x_m, "size_x_m")
            yield from self._beside(name, "y_m", pose.y_m, "size_y_m")
        if self.start.relative_pose == self.goal.relative_pose:
            yield Fault(("goal", "relative_pose"), "must differ from start.relative_pose: there is nothing to slide")

        for name, ticks in (("stick_s", 1), ("slide_s", 2), ("settle_s", 1)):
            yield from self._off_beat(name, ticks * TICK_S)
        yield from self._uneven_steps()

    def _off_beat(self, name: str, beat_s: float) -> Iterator[Fault]:
        value = getattr(self.motion, name)
        if abs(value / beat_s - round(value / beat_s)) > TICK_TOLERANCE:
            yield Fault(("motion", name), f"must be a multiple of {beat_s:g} s of the control loop, got {value!r}")

    def _uneven_steps(self) -> Iterator[Fault]:
        value = self.lab.contact.timestep_s
        if abs(TICK_S / value - round(TICK_S / value)) > TICK_TOLERANCE:
            yield Fault(
                ("lab", "contact", "timestep_s"), f"must divide the control loop's {TICK_S:g} s evenly, got {value!r}"
            )

    def _beside(self, name: str, axis: str, value: float, side: str) -> Iterator[Fault]:
        half = getattr(self.object, side) / 2
        if abs(value) > half:
            yield Fault(
                (name, "relative_pose", axis),
                f"the {name} is outside the object, must be within {-half:g} and {half:g}"
                f" (half of object.{side}), got {value!r}",
            )


UPCASTS[Experiment.SCHEMA, 1] = upcast_iteration


def load_experiment(path: Path, overrides: Iterable[str] = ()) -> Experiment:
    """Read an experiment file, with ``key.key=value`` set over it.

    Raises
    ------
    InputError
        One line for every fault, with file, line and column or with the option that did it.
    NotFoundError
        There is no such file.
    NewerSchemaError
        It was written for a newer slidepipe.
    """
    return parse(Experiment, apply_overrides(load(path), overrides))
