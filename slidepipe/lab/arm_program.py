"""The program on the arm's control PC as the emulator plays it: takes commands, follows, and goes limp."""

from enum import Enum

import numpy as np

from slidepipe.arm import wam
from slidepipe.lab.faults import Channel, FaultClock
from slidepipe.lab.playout import InTurn, LastWins, Playout
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
        self._answers: int | None = None
        self._playout: Playout = InTurn() if codec.carries_torque else LastWins()
        self.mode = ArmMode.HOLDING
        self.links = self.lost_links = 0

    def command(self, now_ns: int, *, behind: int = 0) -> JointCommand:
        """Find what the arm is to do in the tick that begins.

        A program that is ``behind`` by some ticks, for its machine was, takes one datagram for each of those.
        """
        heard = self._receive(now_ns, 1 if behind else MOST_AT_ONCE)
        self._missed = 0 if heard else self._missed + 1
        if self.mode is ArmMode.LINKED and self._missed >= MISSED_TICKS:
            self.mode, self._lost_ns = ArmMode.LIMP, self._heard_ns
            self.lost_links += 1
        order = self._playout.take()
        if order is not None:
            self._consider_linking(order, now_ns)
        if self.mode is ArmMode.LINKED:
            self._reference = self._go_on() if order is None else self._followed(order)
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
            answers=self._answers,
        )
        self._sent += 1
        self._out.put(self._codec.encode_report(report), now_ns)
        for packet in self._out.take(now_ns):
            self._transport.send(packet)

    def _receive(self, now_ns: int, most: int) -> bool:
        """Take datagrams; tells whether there was a command among them."""
        heard = False
        for _ in range(most):
            packet = self._transport.receive()
            if packet is None:
                break
            self._in.put(packet, now_ns)
        for packet in self._in.take(now_ns):
            order = self._codec.decode_command(packet)
            if order is None:
                continue
            if now_ns - self._heard_ns > PERSON_NS:
                self._silent_since_ns = self._heard_ns
            self._heard_ns = now_ns
            self._playout.put(order)
            self._answers = None if order.stamp is None else order.stamp.sequence
            heard = True
        return heard

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

    def _followed(self, order: Order) -> JointCommand:
        """Make an order the reference; the vendor's control differentiates angles where it gets no speeds."""
        command = order.command
        if np.isnan(command.velocity_rad_s).any():
            speed = (command.position_rad - self._reference.position_rad) / TICK_S
            command = JointCommand(command.position_rad, speed, command.feedforward_n_m)
        return command

    def _go_on(self) -> JointCommand:
        """Do without a command: the bridge goes on as before, the others stay where they were told to be last."""
        last = self._reference
        if not self._codec.carries_torque:
            return last.held()
        return JointCommand(last.position_rad + TICK_S * last.velocity_rad_s, last.velocity_rad_s, last.feedforward_n_m)
