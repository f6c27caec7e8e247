"""Serve: play the laboratory in real time, for another process to work with."""

import select
from collections.abc import Callable
from contextlib import ExitStack, closing
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from slidepipe.artifacts.experiment import load_experiment
from slidepipe.artifacts.lab import find_lab, load_lab
from slidepipe.errors import InputError
from slidepipe.lab.arm_program import ArmProgram
from slidepipe.lab.clock import TICK_NS, Beat, RealClock
from slidepipe.lab.emulator import Emulator
from slidepipe.lab.faults import Fault, FaultClock
from slidepipe.lab.motive import MotiveOutlet
from slidepipe.lab.realtime import PRIORITY, realtime
from slidepipe.lab.simulated import HOST_START_NS, SimulatedLab, Tracker
from slidepipe.lab.transport import UdpTransport
from slidepipe.lab.wam_codec import CODECS
from slidepipe.stages.labs import address, camera_settings
from slidepipe.stages.translate import cameras, tracker, vector, world
from slidepipe.tick import TICK_S

LATE_S = 0.005
"""A tick that begins later than this is told of: the world was not in real time."""
HISTORY = 1000
LONGEST_S = 24 * 3600.0
SPARE_NS = 300_000
"""How long before a tick the cameras' socket is looked at for the last time."""


@dataclass(frozen=True, slots=True)
class ServeRequest:
    """Which experiment's world to play, behind which lab's addresses; ``stop`` tells when it is enough."""

    experiment: Path
    lab: str
    stop: Callable[[], bool]
    ready: Callable[[str], None]
    overrides: tuple[str, ...] = ()
    faults: tuple[Fault, ...] = ()
    duration_s: float | None = None


@dataclass(frozen=True, slots=True)
class ServeResult:
    """What became of it.

    Attributes
    ----------
    ticks : int
    late_ticks : int
        Ticks that began more than 5 ms late.
    late_p99_s, late_max_s : float
    links, lost_links : int
        How often the arm was linked, and how often it went limp.
    relative_pose : tuple of three floats
        Where the finger is on the block in the end: m, m, rad.
    refused : tuple of str
        What the machine did not permit the emulator to keep time with.
    """

    ticks: int
    late_ticks: int
    late_p99_s: float
    late_max_s: float
    links: int
    lost_links: int
    relative_pose: tuple[float, float, float]
    refused: tuple[str, ...]


def run(request: ServeRequest) -> ServeResult:
    """Play the laboratory until it is enough.

    Raises
    ------
    InputError
        The experiment or the lab file is wrong.
    LabError
        A port is taken, or an address is not this machine's.
    """
    for override in request.overrides:
        if not override.startswith("lab."):
            raise InputError(
                f"--set {override}: only keys of lab can be set (lab.key=value): the rest the plan decides"
            )
    experiment = load_experiment(request.experiment, request.overrides)
    lab = load_lab(find_lab(request.lab, request.experiment.parent))
    random = np.random.default_rng([experiment.lab.seed, 2])
    faults = FaultClock(request.faults)
    home = np.array(lab.arm.home_pose_rad)
    seen = cameras(experiment)
    played = SimulatedLab(
        world(experiment),
        Tracker.PERFECT if tracker(experiment) is Tracker.PERFECT else Tracker.FEEDFORWARD,
        replace(seen, rate_hz=lab.cameras.rate_hz, clock_drift_ppm=seen.clock_drift_ppm + faults.drift_ppm),
        home,
        vector(experiment.start.relative_pose),
        random=np.random.default_rng([experiment.lab.seed, 1]),
        history=HISTORY,
    )
    with ExitStack() as open_things:
        wire = open_things.enter_context(closing(UdpTransport(address(lab.arm.remote), address(lab.arm.local))))
        outlet = open_things.enter_context(MotiveOutlet(camera_settings(lab), played))
        program = ArmProgram(wire, CODECS[lab.arm.dialect], home, faults=faults, random=random)
        emulator = Emulator(played, program, outlet, faults=faults, random=random)
        request.ready(f"lab {lab.name}: arm at {address(lab.arm.remote)}, cameras at {lab.cameras.server}")
        beat, refused = _play(request, emulator, outlet)
    return _result(beat, played, program, refused)


def _play(request: ServeRequest, emulator: Emulator, outlet: MotiveOutlet) -> tuple[Beat, tuple[str, ...]]:
    clock = RealClock()
    beat = Beat(clock, request.duration_s or LONGEST_S)
    most = round((request.duration_s or LONGEST_S) / TICK_S)
    with realtime(PRIORITY - 10) as refused:
        start_ns = clock.now_ns()
        while emulator.ticks < most and not request.stop():
            due = beat.wait()
            for behind in reversed(range(due)):
                emulator.tick(start_ns + emulator.ticks * TICK_NS, behind=behind)
            until_ns = start_ns + emulator.ticks * TICK_NS - SPARE_NS
            _answer(outlet, clock, start_ns=start_ns, until_ns=until_ns)
    return beat, refused


def _answer(outlet: MotiveOutlet, clock: RealClock, *, start_ns: int, until_ns: int) -> None:
    """Answer what the cameras are asked until the next tick is near."""
    while True:
        now_ns = clock.now_ns()
        ready, _, _ = select.select([outlet], [], [], max(0.0, 1e-9 * (until_ns - now_ns)))
        if not ready:
            return
        outlet.poll(HOST_START_NS + clock.now_ns() - start_ns)


def _result(beat: Beat, played: SimulatedLab, program: ArmProgram, refused: tuple[str, ...]) -> ServeResult:
    late_s = 1e-9 * beat.lateness_ns if len(beat.lateness_ns) else np.zeros(1)
    x, y, theta = (float(value) for value in played.relative_pose())
    return ServeResult(
        ticks=len(beat.lateness_ns),
        late_ticks=int(np.sum(late_s > LATE_S)),
        late_p99_s=float(np.percentile(late_s, 99)),
        late_max_s=float(np.max(late_s)),
        links=program.links,
        lost_links=program.lost_links,
        relative_pose=(x, y, theta),
        refused=refused,
    )
