"""The program on the arm's control PC as the emulator plays it: takes commands, follows, and goes limp."""

from enum import Enum

import numpy as np

from slidepipe.arm import wam
from slidepipe.lab.clock import TICK_NS
from slidepipe.lab.faults import Channel, FaultClock
from slidepipe.lab.protocols import JointCommand, JointState
from slidepipe.lab.transport import Transport
from slidepipe.lab.wam_codec import ArmReport, Order, Stamp, WamCodec
from slidepipe.series import FloatArray
from slidepipe.tick import TICK_S

MISSED_TICKS = 10
"""So many ticks without a datagram, and the vendor's program unlinks."""
NEAR_RAD = 0.1
"""The emulated person links only where the stream is so near to the arm's pose, in every joint,"""
LINK_TICKS = 100
"""for so many ticks,"""
PERSON_NS = 1_000_000_000
"""and an arm that has lost its link only after a silence of a second: the program itself never links again."""
STRAY = 2**31
MOST_AT_ONCE = 64


class ArmMode(Enum):
    """What the arm is doing."""

    HOLDING = "holding"
    LINKED = "linked"
    LIMP = "limp"
    """Its reference follows the measured pose: gravity compensation alone."""


class ArmProgram:
    """The vendor's example program, or our bridge, at the arm's end of the wire.

    Parameters
    ----------
    transport : Transport
    codec : WamCodec
    home_rad : (7,)
        Where it holds the arm until somebody links it.
    faults : FaultClock
    random : numpy.random.Generator
    """

    def __init__(
        self,
        transport: Transport,
        codec: WamCodec,
        home_rad: FloatArray,
        *,
        faults: FaultClock,
        random: np.random.Generator,
    ) -> None:
        self._transport, self._codec, self._faults = transport, codec, faults
        self._in: Channel[bytes] = Channel(faults, random)
        self._out: Channel[bytes] = Channel(faults, random)
        still = np.zeros(wam.JOINT_COUNT)
        self._reference = JointCommand(np.array(home_rad, dtype=float), still, still)
        self._measured = JointState(0, self._reference.position_rad, still, still)
        self._silent_since_ns = self._heard_ns = -PERSON_NS
        self._missed = self._near = self._sent = self._lost_ns = 0
        self._last_sequence: int | None = None
        self.mode = ArmMode.HOLDING
        self.links = self.lost_links = 0

    def command(self, now_ns: int, *, behind: int = 0) -> JointCommand:
        """Find what the arm is to do in the tick that begins.

        A program that is ``behind`` by some ticks, for its machine was, takes one datagram for each of those.
        """
        order = self._latest(now_ns, 1 if behind else MOST_AT_ONCE)
        if order is not None:
            self._missed = 0
            self._consider_linking(order, now_ns)
            if self.mode is ArmMode.LINKED:
                self._take(order)
        else:
            self._miss()
        if self.mode is ArmMode.LIMP:
            still = np.zeros(wam.JOINT_COUNT)
            self._reference = JointCommand(self._measured.position_rad, self._measured.velocity_rad_s, still)
        return self._reference

    def report(self, state: JointState, now_ns: int) -> None:
        """Tell what was measured, linked or not, as the vendor's program does every tick."""
        self._measured = state
        report = ArmReport(
            state.position_rad,
            state.velocity_rad_s,
            state.effort_n_m,
            linked=self.mode is ArmMode.LINKED,
            stamp=Stamp(self._sent % 2**32, state.stamp_ns),
            answers=self._last_sequence,
        )
        self._sent += 1
        self._out.put(self._codec.encode_report(report), now_ns)
        for packet in self._out.take(now_ns):
            self._transport.send(packet)

    def _latest(self, now_ns: int, most: int) -> Order | None:
        """Take the last datagram of this tick; where they are numbered, none that is older than the last one."""
        for _ in range(most):
            packet = self._transport.receive()
            if packet is None:
                break
            self._in.put(packet, now_ns)
        latest = None
        for packet in self._in.take(now_ns):
            order = self._codec.decode_command(packet)
            if order is None or self._is_old(order):
                continue
            latest = order
            if order.stamp is not None:
                self._last_sequence = order.stamp.sequence
        if latest is not None:
            if now_ns - self._heard_ns > PERSON_NS:
                self._silent_since_ns = self._heard_ns
            self._heard_ns = now_ns
        return latest

    def _is_old(self, order: Order) -> bool:
        if order.stamp is None or self._last_sequence is None or order.stamp.sequence == 0:
            return False
        return (order.stamp.sequence - self._last_sequence) % 2**32 >= STRAY

    def _consider_linking(self, order: Order, now_ns: int) -> None:
        if self.mode is ArmMode.LINKED or (self.mode is ArmMode.LIMP and not self._stream_is_new):
            return
        apart = np.abs(order.command.position_rad - self._measured.position_rad)
        self._near = self._near + 1 if (apart < NEAR_RAD).all() else 0
        if self._near >= LINK_TICKS:
            self.mode, self._near = ArmMode.LINKED, 0
            self.links += 1
            self._faults.begin(now_ns)
            self._reference = order.command

    @property
    def _stream_is_new(self) -> bool:
        """Whether a silence lay between losing the link and what comes now."""
        return self._silent_since_ns >= self._lost_ns

    def _take(self, order: Order) -> None:
        """Make an order the reference; the vendor's control differentiates angles where it gets no speeds."""
        command = order.command
        if np.isnan(command.velocity_rad_s).any():
            speed = (command.position_rad - self._reference.position_rad) / TICK_S
            command = JointCommand(command.position_rad, speed, command.feedforward_n_m)
        self._reference = command

    def _miss(self) -> None:
        """Hold the last reference; after ten ticks without one, let go."""
        self._missed += 1
        if self.mode is not ArmMode.LINKED:
            return
        if self._missed >= MISSED_TICKS:
            self.mode = ArmMode.LIMP
            self.lost_links += 1
            self._lost_ns = self._heard_ns + self._missed * TICK_NS
        elif not self._codec.carries_torque:
            self._reference = self._reference.held()
