"""What a laboratory is to the loop: an arm, cameras, and something that records."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from slidepipe.series import FloatArray, StreamStatistics


@dataclass(frozen=True, slots=True)
class JointCommand:
    """Wanted joint angles and speeds, (7,) in rad and rad/s, and the torque beyond gravity for the coming tick, N m."""

    position_rad: FloatArray
    velocity_rad_s: FloatArray
    feedforward_n_m: FloatArray

    def held(self) -> "JointCommand":
        """Stay there."""
        return JointCommand(self.position_rad, np.zeros_like(self.velocity_rad_s), np.zeros_like(self.feedforward_n_m))


@dataclass(frozen=True, slots=True)
class Link:
    """How the arm is heard: age of what it said last, ns, and whether it follows our commands."""

    age_ns: int = 0
    linked: bool = True
    fault: bool = False
    """Whether the arm's own checks have stopped it."""


SOUND = Link()
"""Of an arm that answers at once."""


@dataclass(frozen=True, slots=True)
class JointState:
    """Measured joint angles and speeds and applied torques, (7,), at ``stamp_ns`` on the host's clock."""

    stamp_ns: int
    position_rad: FloatArray
    velocity_rad_s: FloatArray
    effort_n_m: FloatArray
    link: Link = SOUND


@dataclass(frozen=True, slots=True)
class BodyPose:
    """Pose of a tracked body in the base frame: (3,) m and (4,) unit quaternion xyzw."""

    position_m: FloatArray
    quaternion_xyzw: FloatArray


@dataclass(frozen=True, slots=True)
class MocapFrame:
    """One camera frame; a body that was not tracked is None."""

    frame: int
    ticks: int
    received_ns: int
    hand: BodyPose | None
    object: BodyPose | None


@dataclass(frozen=True, slots=True)
class ClockExchange:
    """One echo of the cameras: sent and received on the host's clock, answered at ``ticks`` on theirs."""

    sent_ns: int
    ticks: int
    received_ns: int


class Arm(Protocol):
    """An arm that takes one command a tick."""

    def exchange(self, command: JointCommand) -> JointState:
        """Send a command for the tick that begins now, and return what was last measured."""


class MotionCapture(Protocol):
    """Cameras that watch the hand and the object."""

    @property
    def ticks_per_s(self) -> float:
        """Rate of the cameras' own clock."""

    def take(self) -> list[MocapFrame]:
        """Frames that have arrived since the last call, oldest first."""

    def echo(self) -> ClockExchange | None:
        """Ask the cameras for their clock; return an exchange that was completed and not told yet, if there is one.

        It returns at once: over a network, the answer is told by a later call.
        """


class Recorder(Protocol):
    """Where the loop puts what happens."""

    def joints(self, command: JointCommand, state: JointState) -> None:
        """Record one tick of the arm."""

    def frame(self, frame: MocapFrame) -> None:
        """Record one camera frame."""

    def clock(self, exchange: ClockExchange) -> None:
        """Record one echo."""

    def event(self, stamp_ns: int, text: str) -> None:
        """Record that something happened."""

    def tick(self, stamp_ns: int, late_ns: int) -> None:
        """Record that a tick was due at ``stamp_ns``, and how late it began."""

    def statistics(self, statistics: StreamStatistics) -> None:
        """Record the statistics so far."""
