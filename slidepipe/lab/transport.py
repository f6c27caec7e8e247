"""Ways for datagrams: a UDP socket, or a queue in memory."""

import socket
from collections import deque
from dataclasses import dataclass, field
from typing import Protocol

from slidepipe.errors import LabError

LARGEST = 65_535
RECEIVE_BYTES = 1 << 20
"""Asked for as the kernel's buffer, so that a process that is late loses nothing."""


class Transport(Protocol):
    """One end of a link that carries datagrams, loses some, and never waits."""

    def send(self, packet: bytes) -> None:
        """Send one datagram."""

    def receive(self) -> bytes | None:
        """Take the oldest datagram that has arrived; None where there is none."""

    def close(self) -> None:
        """Let go of it."""


@dataclass(frozen=True, slots=True)
class Address:
    """An IPv4 address and a UDP port."""

    host: str
    port: int

    def __str__(self) -> str:
        """As a person writes it."""
        return f"{self.host}:{self.port}"


class UdpTransport:
    """A UDP socket bound to one interface and port, for one peer; what others send does not come through.

    Parameters
    ----------
    local, remote : Address
        The arm's program sends to one port and takes datagrams from one port only: both are fixed.

    Raises
    ------
    LabError
        The interface or port cannot be had.
    """

    def __init__(self, local: Address, remote: Address) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, RECEIVE_BYTES)
        try:
            self._socket.bind((local.host, local.port))
            self._socket.connect((remote.host, remote.port))
        except OSError as error:
            self._socket.close()
            raise LabError(f"arm: cannot talk from {local} to {remote}: {error.strerror or error}") from None
        self._socket.settimeout(0.0)

    def send(self, packet: bytes) -> None:
        """Send one datagram; one that the network does not take now is lost, as it may be on any way."""
        try:
            self._socket.send(packet)
        except (BlockingIOError, ConnectionRefusedError):
            return
        except OSError as error:
            raise LabError(f"arm: the network failed: {error.strerror or error}") from None

    def receive(self) -> bytes | None:
        """Take the oldest datagram that has arrived."""
        try:
            return self._socket.recv(LARGEST)
        except (BlockingIOError, ConnectionRefusedError):
            return None
        except OSError as error:
            raise LabError(f"arm: the network failed: {error.strerror or error}") from None

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()


@dataclass(frozen=True, slots=True)
class MemoryTransport:
    """One end of a link inside one process."""

    inbox: deque[bytes] = field(default_factory=deque)
    outbox: deque[bytes] = field(default_factory=deque)

    def send(self, packet: bytes) -> None:
        """Put a datagram where the other end finds it."""
        self.outbox.append(packet)

    def receive(self) -> bytes | None:
        """Take the oldest datagram."""
        return self.inbox.popleft() if self.inbox else None

    def close(self) -> None:
        """Nothing to do."""

    def other_end(self) -> "MemoryTransport":
        """Return the end that hears what this one says."""
        return MemoryTransport(self.outbox, self.inbox)
