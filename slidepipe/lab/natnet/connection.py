"""A client's end of the wire: its sockets, and the version that is spoken over them."""

import select
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from slidepipe.errors import LabError, PacketError
from slidepipe.lab.host_clock import TellsTime
from slidepipe.lab.natnet.codec import Message, decode, encode
from slidepipe.lab.natnet.datagrams import Address, DatagramSocket
from slidepipe.lab.natnet.settings import NatNetSettings, Transport
from slidepipe.lab.natnet.version import NEWEST

ASK_AGAIN_S = 0.25
MOST_AT_ONCE = 16
"""Datagrams taken from a socket in one call: a flood must not hold up the loop, which takes one or two in a tick."""


@dataclass(frozen=True, slots=True)
class Received:
    """A message, and when it arrived on the host's clock."""

    message: Message
    stamp_ns: int


class Connection:
    """Sockets towards one server, none of which ever blocks.

    Parameters
    ----------
    settings : NatNetSettings
    clock : TellsTime

    Raises
    ------
    LabError
        The address is not this machine's, or the port is taken.
    """

    def __init__(self, settings: NatNetSettings, clock: TellsTime) -> None:
        self.server = Address(settings.server, settings.command_port)
        self.name = f"cameras at {self.server}"
        self.version = NEWEST
        self.malformed = self.foreign = 0
        self._timeout_s = settings.timeout_s
        self._sockets = [DatagramSocket(Address(settings.interface, 0), clock)]
        try:
            self._sockets.append(_data_socket(settings, clock))
        except LabError:
            self.close()
            raise

    def send(self, message: Message) -> None:
        """Send a message to the server; one that cannot leave just now is lost, as any datagram may be."""
        self._sockets[0].send(encode(message, self.version), self.server)

    def receive(self) -> Iterator[Received]:
        """Read what has arrived from the server; the rest is counted."""
        for one in self._sockets:
            for _ in range(MOST_AT_ONCE):
                datagram = one.receive()
                if datagram is None:
                    break
                if datagram.sender.host != self.server.host:
                    self.foreign += 1
                    continue
                try:
                    yield Received(decode(datagram.data, self.version), datagram.received_ns)
                except PacketError:
                    self.malformed += 1

    def ask_until(self, done: Callable[[], bool], question: Message, complaint: str) -> None:
        """Ask again and again until it is done.

        Raises
        ------
        LabError
            The time is up.
        """
        deadline = time.monotonic() + self._timeout_s
        asked = -ASK_AGAIN_S
        while not done():
            now = time.monotonic()
            if now > deadline:
                raise LabError(f"{self.name}: {complaint} within {self._timeout_s:g} s")
            if now - asked >= ASK_AGAIN_S:
                self.send(question)
                asked = now
            select.select(self._sockets, [], [], 0.02)

    def close(self) -> None:
        """Close the sockets."""
        for one in self._sockets:
            one.close()
        self._sockets = []


def _data_socket(settings: NatNetSettings, clock: TellsTime) -> DatagramSocket:
    """Where frames arrive: servers differ in whether unicast ones come here or to the port that asked."""
    if settings.transport is Transport.MULTICAST:
        return DatagramSocket.of_group(Address(settings.group, settings.data_port), settings.interface, clock)
    return DatagramSocket(Address(settings.interface, settings.data_port), clock, shared=True)
