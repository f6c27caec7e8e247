"""A laboratory behind a wire, in one process and virtual time; loop, link, guard and emulator are as they are."""

from dataclasses import dataclass

import numpy as np
from lab_setups import CAMERAS, Notes, reference, world

from slidepipe.arm import wam
from slidepipe.lab.approach import MoveLimits, Pauses, there_and_back
from slidepipe.lab.arm_program import ArmMode, ArmProgram
from slidepipe.lab.clock import TICK_NS, Beat, VirtualClock
from slidepipe.lab.course import Course, Phase
from slidepipe.lab.emulator import Emulator, MemoryCameras
from slidepipe.lab.faults import Fault, FaultClock
from slidepipe.lab.link import LinkedArm
from slidepipe.lab.loop import Desk, Execution, Lab, LoopSettings, Nobody, run
from slidepipe.lab.safety import Guard, SafetyLimits
from slidepipe.lab.simulated import SimulatedLab, Tracker
from slidepipe.lab.transport import MemoryTransport
from slidepipe.lab.wam_codec import CODECS
from slidepipe.lab.world import ContactSettings
from slidepipe.planning.planner import Plan, Setup
from slidepipe.series import FloatArray, JointSeries
from slidepipe.tick import TICK_S

PHASE_NS = 700_000
"""The arm's program ticks so long after the loop."""
TIMEOUT_S = 10.0
COARSE = ContactSettings(timestep_s=1e-4, solref_s=4e-4, impratio=1000.0)
LIMITS = SafetyLimits(
    tracking_error_rad=np.full(7, 0.1),
    lower_rad=np.array([link.range_rad[0] for link in wam.LINKS]),
    upper_rad=np.array([link.range_rad[1] for link in wam.LINKS]),
    link_timeout_s=0.02,
    mocap_timeout_s=0.1,
    object_timeout_s=0.15,
    object_reach_m=0.059,
)
MOVES = MoveLimits(np.full(7, 1.0), np.full(7, 3.0), np.full(7, 60.0))
PAUSES = Pauses(rest_s=0.2, hold_s=0.1)
SETTINGS = LoopSettings(link_timeout_s=2.0, jump_rad=0.05, stop_s=0.3, hold_s=0.2)


@dataclass(frozen=True)
class Emulated:
    """What became of an execution: where the finger was before and after it, and how the arm stood in the end."""

    execution: Execution
    course: Course
    notes: Notes
    before: FloatArray
    after: FloatArray
    mode: ArmMode
    arm: LinkedArm
    program: ArmProgram
    virtual_s: float

    def phase_of_stop(self) -> Phase:
        """Where on the course the stop began."""
        stop = self.execution.stop
        assert stop is not None
        index = [state.stamp_ns for state in self.notes.states].index(stop.stamp_ns)
        sent = self.notes.commands[index]
        return self.course.phases[next(i for i, one in enumerate(self.course.commands) if one is sent)]


@dataclass
class Bench:
    """The pieces, put together but not run yet."""

    clock: VirtualClock
    lab: SimulatedLab
    arm: LinkedArm
    program: ArmProgram
    cameras: MemoryCameras
    beat: Beat
    notes: Notes


def home_of(motion: JointSeries, turn_rad: float = 0.05) -> FloatArray:
    """The start pose turned about the upright axis: the block hangs in the grip as it will at the start."""
    return motion.position_rad[0] - np.array([turn_rad, 0, 0, 0, 0, 0, 0])


def bench(plan: Plan, setup: Setup, *, dialect: str = "bridge", faults: tuple[Fault, ...] = (), seed: int = 5) -> Bench:
    """Put a laboratory together."""
    home = home_of(reference(plan))
    random = np.random.default_rng(seed)
    fault_clock = FaultClock(faults)
    lab = SimulatedLab(
        world(setup, prescribed=False, contact=COARSE),
        Tracker.FEEDFORWARD,
        CAMERAS,
        home,
        plan.course.r_start,
        random=np.random.default_rng(1),
    )
    clock, ours = VirtualClock(), MemoryTransport()
    program = ArmProgram(ours.other_end(), CODECS[dialect], home, faults=fault_clock, random=random)
    cameras = MemoryCameras(lab)
    emulator = Emulator(lab, program, cameras, faults=fault_clock, random=random)
    clock.every(TICK_NS, PHASE_NS, emulator.tick)
    beat = Beat(clock, 20.0)
    arm = LinkedArm(ours, CODECS[dialect], clock, link_wait_s=0.5, beat=beat)
    return Bench(clock, lab, arm, program, cameras, beat, Notes())


def run_emulated(  # a test says what is special about it
    plan: Plan,
    setup: Setup,
    *,
    dialect: str = "bridge",
    faults: tuple[Fault, ...] = (),
    motion: JointSeries | None = None,
    desk: Desk | None = None,
    limits: SafetyLimits = LIMITS,
) -> Emulated:
    """Execute a plan, or another motion, on an emulated laboratory."""
    parts = bench(plan, setup, dialect=dialect, faults=faults)
    wanted = reference(plan) if motion is None else motion
    measured = parts.arm.connect(1.0)
    course = there_and_back(measured.position_rad, wanted, home_of(wanted), limits=MOVES, pauses=PAUSES)
    parts.arm.prepare(course.commands)
    before, begun_ns = parts.lab.relative_pose(), parts.clock.now_ns()
    there = Lab(parts.arm, parts.cameras, parts.notes, parts.beat, Guard(limits), desk or Nobody(), SETTINGS)
    execution = run(course, there)
    lasted_s = 1e-9 * (parts.clock.now_ns() - begun_ns)
    after = parts.lab.relative_pose()
    return Emulated(
        execution, course, parts.notes, before, after, parts.program.mode, parts.arm, parts.program, lasted_s
    )


def gentle(plan: Plan, slow: float = 4.0) -> JointSeries:
    """The way of a plan, so slow that nothing slides and the vendor's clip suffices."""
    way = reference(plan)
    ticks = np.arange(round(slow * (len(way.position_rad) - 1)) + 1)
    place = ticks / slow
    smooth = 0.5 * (1.0 - np.cos(np.pi * place / place[-1])) * place[-1]
    columns = [np.interp(smooth, np.arange(len(way.position_rad)), column) for column in way.position_rad.T]
    position = np.column_stack(columns)
    return JointSeries(
        (ticks * TICK_NS).astype(np.int64),
        position,
        np.gradient(position, TICK_S, axis=0),
        np.zeros_like(position),
    )
