"""The experiment file: what is to be regrasped, with what, where to, and in which world it is tried."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from math import pi
from pathlib import Path
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from slidepipe.artifacts.arm_setup import ArmSetup
from slidepipe.artifacts.estimation_setup import EstimationSetup
from slidepipe.artifacts.faults import Fault, MissingKey
from slidepipe.artifacts.iteration_setup import Iteration, upcast_iteration
from slidepipe.artifacts.lab_setup import LabSetup
from slidepipe.artifacts.overrides import apply_overrides
from slidepipe.artifacts.schema import UPCASTS, Artifact, Record, parse
from slidepipe.artifacts.strict_yaml import load
from slidepipe.artifacts.values import Friction, Interval, NotNegative, Pose, Positive, Slug
from slidepipe.errors import InputError
from slidepipe.tick import TICK_S

TICK_TOLERANCE = 1e-6
"""How far from a whole number of ticks a time may be, in ticks."""
SHARE_TOLERANCE = 1e-6
Length = Annotated[float, Field(gt=0.0, le=2.0)]
Duration = Annotated[float, Field(gt=0.0, le=60.0)]


class ObjectBlock(Record):
    """The block: its sides along the body's x and y, and its thickness along the plane's normal."""

    size_x_m: Length
    size_y_m: Length
    thickness_m: Length
    mass_kg: Annotated[float, Field(gt=0.0, le=50.0)]


class FingerPlace(Record):
    """One finger: where it touches in the hand's frame {f}, and its share of the whole normal force."""

    x_m: float
    y_m: float
    force_share: Annotated[float, Field(gt=0.0, le=1.0)]


class Grasp(Record):
    """The fingers that press on the block, taken together as one soft contact unless ``places`` sets them apart."""

    finger_count: Annotated[int, Field(ge=1, le=10)]
    normal_force_per_finger_n: Annotated[float, Field(gt=0.0, le=1000.0)]
    contact_radius_m: Annotated[float, Field(gt=0.0, le=0.5)]
    torsion_constant: Annotated[float, Field(gt=0.0, le=1.0)]
    places: tuple[FingerPlace, ...] | None = None

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
    tolerance: Tolerance
    hand_pose: Pose | None = None
    hand_region: "Workspace | None" = None


class FreeChoices(Record):
    """What the planner may choose beside the motion: the object's angle at the start, and the fingers' normal force."""

    object_angle: bool = False
    normal_force_per_finger_n: Interval | None = None


class MotionWeights(Record):
    """What counts how much: a second of time, 20 m/s^2 of hand acceleration, a friction error of one survived."""

    time: NotNegative = 0.0
    hand_acceleration: NotNegative = 0.0
    friction_error: NotNegative = 0.0


class MotionSetup(Record):
    """Either the durations of the three phases, the paper's T1, T23 and T4, or what the planner is to make best.

    ``friction_error`` is the share by which the friction may be wrong either way without harm, ``turn_rad`` how far the
    object may be turned before it slides.
    """

    stick_s: Duration | None = None
    slide_s: Duration | None = None
    settle_s: Duration | None = None
    objective: Literal["fast", "gentle", "robust"] | None = None
    weights: MotionWeights | None = None
    friction_error: Annotated[float, Field(ge=0.0, le=0.9)] = 0.1
    turn_rad: Annotated[float, Field(ge=0.0, le=3.2)] = 3.1
    free: FreeChoices = FreeChoices()

    @property
    def chosen_by_planner(self) -> bool:
        """Whether the planner finds the motion; else its times are given."""
        return self.objective is not None or self.weights is not None

    @property
    def times(self) -> "PhaseTimes":
        """The durations that are given."""
        if self.stick_s is None or self.slide_s is None or self.settle_s is None:
            raise InputError("motion: its times are not given")
        return PhaseTimes(self.stick_s, self.slide_s, self.settle_s)


@dataclass(frozen=True, slots=True)
class PhaseTimes:
    """Durations of the three phases: the paper's T1, T23 and T4."""

    stick_s: float
    slide_s: float
    settle_s: float


class Workspace(Record):
    """A disc of {w} for the hand."""

    centre_x_m: float
    centre_y_m: float
    radius_m: Annotated[float, Field(gt=0.0, le=10.0)]


def _wish_faults(motion: MotionSetup, given: list[str]) -> Iterator[Fault]:
    """What does not go together where the planner is to choose."""
    if motion.objective is not None and motion.weights is not None:
        yield Fault(("motion", "weights"), "must be left out where an objective is given, or the other way round")
    for name in given:
        yield Fault(("motion", name), "must be left out where the planner is to choose: objective or weights")
    if motion.weights is not None and not any(motion.weights.model_dump().values()):
        yield Fault(("motion", "weights"), "must have one above 0 of time, hand_acceleration and friction_error")
    force = motion.free.normal_force_per_finger_n
    if force is not None and not 0.0 < force[0] <= force[1]:
        path = ("motion", "free", "normal_force_per_finger_n")
        yield Fault(path, f"must be two positive forces, the lower first, got {list(force)!r}")


class Experiment(Artifact):
    """One experiment; ``friction`` is what the planner believes, ``lab.friction`` what the simulated world has."""

    SCHEMA: ClassVar[str] = "slidepipe.experiment"
    VERSION: ClassVar[int] = 2
    LATER: ClassVar[frozenset[str]] = frozenset({"estimation"})

    name: Slug
    object: ObjectBlock
    grasp: Grasp
    friction: Friction
    start: Start
    goal: Goal
    motion: MotionSetup
    workspace: Workspace
    arm: ArmSetup
    iteration: Iteration
    lab: LabSetup
    estimation: EstimationSetup = EstimationSetup()

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
        """Contact points beside the object, a goal that asks for nothing, and a motion that is not told."""
        for name in ("start", "goal"):
            pose = getattr(self, name).relative_pose
            yield from self._beside(name, "x_m", pose.x_m, "size_x_m")
            yield from self._beside(name, "y_m", pose.y_m, "size_y_m")
        if self.start.relative_pose == self.goal.relative_pose:
            yield Fault(("goal", "relative_pose"), "must differ from start.relative_pose: there is nothing to slide")

        yield from self._turn_faults()
        yield from self._motion_faults()
        yield from self._place_faults()
        yield from self._uneven_steps()

    def _turn_faults(self) -> Iterator[Fault]:
        """More than a turn: an angle in degrees."""
        for name in ("object_pose", "relative_pose"):
            angle = getattr(self.start, name).theta_rad
            if abs(angle) > 2 * pi:
                yield Fault(("start", name, "theta_rad"), f"must be within a turn, 6.28 rad, got {angle:g} rad")
        start, goal = self.start.relative_pose.theta_rad, self.goal.relative_pose.theta_rad
        if abs(goal - start) > 2 * pi:
            message = f"must be within a turn, 6.28 rad, of the start's {start:g} rad, got {goal:g} rad"
            yield Fault(("goal", "relative_pose", "theta_rad"), message)

    def _motion_faults(self) -> Iterator[Fault]:
        """Times off the beat, and a motion that is both given and wished for, or neither."""
        motion, names = self.motion, ("stick_s", "slide_s", "settle_s")
        given = [name for name in names if getattr(motion, name) is not None]
        if motion.chosen_by_planner:
            yield from _wish_faults(motion, given)
            return
        for name in names:
            if name not in given:
                hint = "required key is missing, unless an objective (fast, gentle, robust) or weights stand in motion"
                yield MissingKey(("motion", name), hint)
        if self.goal.hand_pose is None:
            hint = "required key is missing, since the times of the motion are given"
            yield MissingKey(("goal", "hand_pose"), hint)
        for name, ticks in zip(names, (1, 2, 1), strict=True):
            if name in given:
                yield from self._off_beat(name, ticks * TICK_S)

    def _place_faults(self) -> Iterator[Fault]:
        places = self.grasp.places
        if places is None:
            return
        if len(places) != self.grasp.finger_count:
            yield Fault(
                ("grasp", "places"),
                f"must have one entry for each of grasp.finger_count: {self.grasp.finger_count}, got {len(places)}",
            )
        total = sum(place.force_share for place in places)
        if abs(total - 1.0) > SHARE_TOLERANCE:
            yield Fault(("grasp", "places"), f"its force_share entries must add up to 1, got {total:g}")

    def _off_beat(self, name: str, beat_s: float) -> Iterator[Fault]:
        value = getattr(self.motion, name)
        if abs(value / beat_s - round(value / beat_s)) > TICK_TOLERANCE:
            yield Fault(("motion", name), f"must be a multiple of {beat_s:g} s of the control loop, got {value!r} s")

    def _uneven_steps(self) -> Iterator[Fault]:
        value = self.lab.contact.timestep_s
        if abs(TICK_S / value - round(TICK_S / value)) > TICK_TOLERANCE:
            yield Fault(
                ("lab", "contact", "timestep_s"), f"must divide the control loop's {TICK_S:g} s evenly, got {value!r} s"
            )

    def _beside(self, name: str, axis: str, value: float, side: str) -> Iterator[Fault]:
        half = getattr(self.object, side) / 2
        if abs(value) > half:
            yield Fault(
                (name, "relative_pose", axis),
                f"the {name} is outside the object, must be within {-half:g} and {half:g} m"
                f" (half of object.{side}), got {value!r} m",
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
