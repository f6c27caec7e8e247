"""The simulated lab in plain values, and fakes that stand in for an arm, cameras and a recorder."""

from dataclasses import dataclass, field

import numpy as np

from slidepipe.lab.cameras import CameraSettings
from slidepipe.lab.course import rest_move_rest
from slidepipe.lab.loop import Execution, execute
from slidepipe.lab.protocols import ClockExchange, JointCommand, JointState, MocapFrame
from slidepipe.lab.simulated import SimulatedLab, Tracker, Truth
from slidepipe.lab.world import ContactSettings, WorldSettings
from slidepipe.planning.planner import Plan, Setup
from slidepipe.series import JointSeries, StreamStatistics

CONTACT = ContactSettings(timestep_s=5e-5, solref_s=2e-4, impratio=1000.0)
CAMERAS = CameraSettings(
    rate_hz=360.0,
    position_noise_m=0.0003,
    angle_noise_rad=0.003,
    dropout_share=0.02,
    clock_offset_s=12.3,
    clock_drift_ppm=20.0,
    latency_s=0.006,
    latency_jitter_s=0.0004,
)


def world(
    setup: Setup, *, prescribed: bool, friction: float | None = None, contact: ContactSettings = CONTACT
) -> WorldSettings:
    """The world that a plan believes in, but for an arm that is 5 % heavier and rubs 20 % more."""
    finger = setup.finger
    return WorldSettings(
        block_size_m=np.array([setup.block.length, setup.block.width, 0.01]),
        block_mass_kg=setup.block.m,
        friction=friction or finger.mu,
        normal_force_per_finger_n=finger.f_N / 2,
        rho_m=finger.a * finger.c,
        tool=setup.tool,
        plane=setup.plane,
        prescribed=prescribed,
        mass_error=0.05,
        joint_friction_scale=1.2,
        contact=contact,
    )


def reference(plan: Plan) -> JointSeries:
    """What the loop is given of a plan."""
    return JointSeries(
        stamp_ns=np.arange(len(plan.joints.time_s)) * 2_000_000,
        position_rad=plan.joints.position_rad,
        velocity_rad_s=plan.joints.velocity_rad_s,
        effort_n_m=plan.load.feedforward_n_m,
    )


@dataclass
class Notes:
    """A recorder that remembers everything; ``order`` has one letter for each call."""

    commands: list[JointCommand] = field(default_factory=list)
    states: list[JointState] = field(default_factory=list)
    frames: list[MocapFrame] = field(default_factory=list)
    echoes: list[ClockExchange] = field(default_factory=list)
    events: list[tuple[int, str]] = field(default_factory=list)
    late_ns: list[int] = field(default_factory=list)
    totals: list[StreamStatistics] = field(default_factory=list)
    order: str = ""

    def joints(self, command: JointCommand, state: JointState) -> None:
        self.commands.append(command)
        self.states.append(state)
        self.order += "j"

    def frame(self, frame: MocapFrame) -> None:
        self.frames.append(frame)
        self.order += "f"

    def clock(self, exchange: ClockExchange) -> None:
        self.echoes.append(exchange)
        self.order += "c"

    def event(self, stamp_ns: int, text: str) -> None:
        self.events.append((stamp_ns, text))
        self.order += "e"

    def tick(self, stamp_ns: int, late_ns: int) -> None:  # noqa: ARG002  # the protocol's
        self.late_ns.append(late_ns)

    def statistics(self, statistics: StreamStatistics) -> None:
        self.totals.append(statistics)


@dataclass(frozen=True)
class Trial:
    """A simulated execution of a plan."""

    truth: Truth
    notes: Notes
    execution: Execution
    reference: JointSeries


def run_trial(plan: Plan, setup: Setup, tracker: Tracker, *, seed: int = 1, friction: float | None = None) -> Trial:
    """Execute a plan in the simulated lab."""
    asked = reference(plan)
    lab = SimulatedLab(
        world(setup, prescribed=tracker is Tracker.PERFECT, friction=friction),
        tracker,
        CAMERAS,
        asked.position_rad[0],
        plan.course.r_start,
        random=np.random.default_rng(seed),
    )
    notes = Notes()
    execution = execute(rest_move_rest(asked), lab, lab, notes)
    return Trial(lab.truth(), notes, execution, asked)


def resting_lab(
    setup: Setup, joints_rad: np.ndarray, r_f_b: np.ndarray, tracker: Tracker, cameras: CameraSettings = CAMERAS
) -> SimulatedLab:
    """A lab whose arm rests at a posture."""
    return SimulatedLab(
        world(setup, prescribed=tracker is Tracker.PERFECT),
        tracker,
        cameras,
        joints_rad,
        r_f_b,
        random=np.random.default_rng(3),
    )


def held_at(joints_rad: np.ndarray) -> JointCommand:
    """Stay there."""
    return JointCommand(joints_rad, np.zeros(7), np.zeros(7))
