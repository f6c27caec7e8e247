"""The arm at the other end of a wire: implements ``Arm`` over any transport, dialect and clock."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from slidepipe.arm import wam
from slidepipe.errors import LabError
from slidepipe.lab.clock import TICK_NS, Beat, Clock
from slidepipe.lab.protocols import JointCommand, JointState, Link
from slidepipe.lab.transport import Transport
from slidepipe.lab.wam_codec import CODECS, ArmReport, Stamp, WamCodec
from slidepipe.tick import TICK_S

SEQUENCES = 2**32


@dataclass(slots=True)
class LinkCounts:
    """What went over the wire: ``foreign`` are datagrams that were no states, ``lost`` numbers that never came."""

    sent: int = 0
    received: int = 0
    foreign: int = 0
    disordered: int = 0
    lost: int = 0


class LinkedArm:
    """Sends a command a tick and keeps the latest state that came back.

    Parameters
    ----------
    transport : Transport
    codec : WamCodec
    clock : Clock
    link_wait_s : float
        Where the dialect does not tell whether the arm follows: how long after the first command it is taken to.
    gripper_n : float
        Force for the gripper, where the dialect has a word for it.
    beat : Beat, optional
        Whose ticks number the commands, so that the arm's program can follow each in its turn.
    """

    def __init__(
        self,
        transport: Transport,
        codec: WamCodec,
        clock: Clock,
        *,
        link_wait_s: float = 0.0,
        gripper_n: float = 0.0,
        beat: Beat | None = None,
    ) -> None:
        self._transport, self._codec, self._clock, self._beat = transport, codec, clock, beat
        self._link_wait_ns, self._gripper_n = round(1e9 * link_wait_s), gripper_n
        self._bodies: dict[int, bytes] = {}
        self._report: ArmReport | None = None
        self._last_sequence: int | None = None
        self._report_ns, self._first_ns, self._strange = 0, -1, 0
        self._speed = np.zeros(wam.JOINT_COUNT)
        self.counts = LinkCounts()

    def connect(self, timeout_s: float) -> JointState:
        """Wait for the arm's first state; nothing is sent.

        Raises
        ------
        LabError
            Nothing came, or only what is no state of seven joints in this dialect.
        """
        deadline_ns = self._clock.now_ns() + round(1e9 * timeout_s)
        while self._clock.now_ns() <= deadline_ns:
            self._drain()
            if self._report is not None:
                return self._state()
            self._clock.wait_until(self._clock.now_ns() + TICK_NS)
        raise LabError(self._silence(timeout_s))

    def listen(self) -> JointState:
        """Take what has arrived and return the latest; nothing is sent."""
        self._drain()
        return self._state()

    def listen_anew(self) -> None:
        """Take what has arrived, and count from now on: what came before nobody was there to take."""
        self._drain()
        self.counts, self._last_sequence = LinkCounts(), None

    def prepare(self, commands: Iterable[JointCommand]) -> None:
        """Encode commands before they are needed; they must live as long as the arm does."""
        self._bodies = {id(command): self._codec.body(command) for command in commands}

    def exchange(self, command: JointCommand) -> JointState:
        """Send a command, and return what came last; its age tells how long ago."""
        now_ns = self._clock.now_ns()
        if self._first_ns < 0:
            self._first_ns = now_ns
        body = self._bodies.get(id(command)) or self._codec.body(command)
        number = self.counts.sent if self._beat is None else self._beat.tick
        self._transport.send(self._codec.seal(body, Stamp(number % SEQUENCES, now_ns, self._gripper_n)))
        self.counts.sent += 1
        self._drain()
        if self._report is None:
            raise LabError("arm: it was never heard of: connect first")
        return self._state()

    def _drain(self) -> None:
        while (packet := self._transport.receive()) is not None:
            report = self._codec.decode_report(packet)
            if report is None:
                self.counts.foreign += 1
                self._strange = len(packet)
            elif self._in_order(report):
                self.counts.received += 1
                self._measure_speed(report)
                self._report, self._report_ns = report, self._clock.now_ns()

    def _in_order(self, report: ArmReport) -> bool:
        if report.stamp is None:
            return True
        last, self._last_sequence = self._last_sequence, report.stamp.sequence
        ahead = 1 if last is None else (report.stamp.sequence - last) % SEQUENCES
        if not 0 < ahead < SEQUENCES // 2:
            self._last_sequence = last
            self.counts.disordered += 1
            return False
        self.counts.lost += ahead - 1
        return True

    def _measure_speed(self, report: ArmReport) -> None:
        """Differentiate and low-pass the angles of a dialect without speeds, as the vendor's loop does."""
        if report.velocity_rad_s is not None:
            self._speed = report.velocity_rad_s
        elif self._report is not None:
            raw = (report.position_rad - self._report.position_rad) / TICK_S
            blend = 1.0 - np.exp(-wam.VELOCITY_FILTER_RAD_S * TICK_S)
            self._speed = self._speed + blend * (raw - self._speed)

    def _state(self) -> JointState:
        report, now_ns = self._report, self._clock.now_ns()
        if report is None:
            raise LabError("arm: it was never heard of: connect first")
        waited = self._first_ns >= 0 and now_ns - self._first_ns >= self._link_wait_ns
        linked = waited if report.linked is None else report.linked
        effort = np.zeros(wam.JOINT_COUNT) if report.effort_n_m is None else report.effort_n_m
        age_ns = now_ns - self._report_ns
        return JointState(now_ns, report.position_rad, self._speed, effort, Link(age_ns, linked, report.fault))

    def _silence(self, timeout_s: float) -> str:
        if not self._strange:
            return f"arm: nothing heard of it for {timeout_s:g} s: is its program running, and sending to this host?"
        return (
            f"arm: it sends datagrams of {self._strange} bytes, the dialect {self._codec.name!r} has {self._codec.size}"
            f" ({wam.JOINT_COUNT} joints){_meaning_of(self._strange)}"
        )


def _meaning_of(size: int) -> str:
    """What datagrams of this size may be."""
    for codec in CODECS.values():
        if codec.size == size:
            return f": they may be of the dialect {codec.name!r}"
    return f": an arm of {size // 8} joints?" if size % 8 == 0 and size // 8 < wam.JOINT_COUNT else ""
