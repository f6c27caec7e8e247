"""The laboratory in another process: the simulated world behind the arm's wire and the cameras' stream."""

from collections import deque
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from slidepipe.lab.arm_program import ArmProgram
from slidepipe.lab.faults import STRETCH, Channel, FaultClock, FaultKind
from slidepipe.lab.protocols import ClockExchange, JointCommand, JointState, MocapFrame
from slidepipe.lab.simulated import SimulatedLab


class Outlet(Protocol):
    """Where the emulated cameras send what they saw."""

    def poll(self, world_ns: int) -> None:
        """Answer what was asked, given the world's time."""

    def publish(self, frame: MocapFrame) -> None:
        """Send a frame."""


class Emulator:
    """Steps the world, a tick at a time, and plays the arm's program and the cameras.

    Parameters
    ----------
    lab : SimulatedLab
    program : ArmProgram
    outlet : Outlet
    faults : FaultClock
    random : numpy.random.Generator
    """

    def __init__(
        self,
        lab: SimulatedLab,
        program: ArmProgram,
        outlet: Outlet,
        *,
        faults: FaultClock,
        random: np.random.Generator,
    ) -> None:
        self._lab, self.program, self._outlet = lab, program, outlet
        self._faults, self._random = faults, random
        self._frames: Channel[MocapFrame] = Channel(faults, random)
        self._stalled: JointCommand | None = None
        self._last_frame: MocapFrame | None = None
        self._swapped_left = 0
        self.ticks = 0

    def tick(self, now_ns: int, *, behind: int = 0) -> JointState:
        """Let one tick of the world pass; ``now_ns`` is the time on the emulator's own clock.

        ``behind`` is how many more ticks have to follow at once, where the machine did not keep time.
        """
        command = self._stall(self.program.command(now_ns, behind=behind), now_ns)
        state = self._lab.exchange(command)
        self.program.report(state, now_ns)
        for frame in self._lab.take():
            self._frames.put(self._spoil(frame, now_ns), now_ns)
        for frame in self._frames.take(now_ns):
            self._outlet.publish(frame)
        self.ticks += 1
        return state

    def _stall(self, command: JointCommand, now_ns: int) -> JointCommand:
        if not self._faults.strength(FaultKind.STALL, now_ns):
            self._stalled = None
            return command
        self._stalled = self._stalled or command.held()
        return self._stalled

    def _spoil(self, frame: MocapFrame, now_ns: int) -> MocapFrame:
        """Do to a frame what is asked for."""
        strength = self._faults.strength
        if strength(FaultKind.FREEZE, now_ns) and self._last_frame is not None:
            return self._last_frame
        hand, thing = frame.hand, frame.object
        if self._random.random() < strength(FaultKind.BLINDNESS, now_ns):
            hand = thing = None
        if self._random.random() < strength(FaultKind.OCCLUSION, now_ns):
            thing = None
        if self._is_swapped(strength(FaultKind.SWAP, now_ns)):
            hand, thing = thing, hand
        self._last_frame = MocapFrame(frame.frame, frame.ticks, frame.received_ns, hand, thing)
        return self._last_frame

    def _is_swapped(self, share: float) -> bool:
        if self._swapped_left == 0 and self._random.random() < share / STRETCH / max(1.0 - share, 1e-9):
            self._swapped_left = STRETCH
        swapped = self._swapped_left > 0 and share > 0.0
        self._swapped_left -= swapped
        return swapped


@dataclass(slots=True)
class MemoryCameras:
    """Cameras inside one process: an outlet for the emulator, and ``MotionCapture`` for the loop."""

    lab: SimulatedLab
    _frames: deque[MocapFrame] = field(default_factory=deque)

    @property
    def ticks_per_s(self) -> float:
        """Rate of the cameras' clock."""
        return self.lab.ticks_per_s

    def poll(self, world_ns: int) -> None:
        """Nothing to answer."""

    def publish(self, frame: MocapFrame) -> None:
        """Keep a frame for the loop."""
        self._frames.append(frame)

    def take(self) -> list[MocapFrame]:
        """Frames that have arrived since the last call."""
        frames = list(self._frames)
        self._frames.clear()
        return frames

    def echo(self) -> ClockExchange:
        """Ask the cameras for their clock."""
        return self.lab.echo()
