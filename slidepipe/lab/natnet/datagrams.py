"""UDP sockets that never block, bound to one interface, whose datagrams the kernel stamps."""

import errno
import socket
import struct
import time
from dataclasses import dataclass

from slidepipe.errors import LabError
from slidepipe.lab.host_clock import TellsTime

RECEIVE_BYTES = 1 << 20
"""Asked for as the kernel's buffer, so that a loop that is late loses nothing."""
_LARGEST = 65_536
_LONGEST_AGE_NS = 1_000_000_000
_SO_TIMESTAMPNS = 35
_IP_MULTICAST_ALL = 49
"""Linux's numbers; Python does not name them."""
_TIMESPEC = struct.Struct("@ll")
_TRANSIENT = {errno.ECONNREFUSED, errno.ENETUNREACH, errno.EHOSTUNREACH, errno.ENOBUFS, errno.EAGAIN}
"""Answers to an earlier datagram that found nobody, or no room just now: as good as lost."""


@dataclass(frozen=True, slots=True)
class Address:
    """An IPv4 address and a port."""

    host: str
    port: int

    def __str__(self) -> str:
        return f"{self.host}:{self.port}"


@dataclass(frozen=True, slots=True)
class Datagram:
    """Bytes, who sent them, and when the kernel received them, on the host's clock."""

    data: bytes
    sender: Address
    received_ns: int


class DatagramSocket:
    """A UDP socket on one interface; reading and writing return at once.

    Parameters
    ----------
    address : Address
        Interface and port, 0 for any port.
    clock : TellsTime
    shared : bool
        Whether others may listen on the same port.

    Raises
    ------
    LabError
        The address is not this machine's, or the port is taken.
    """

    def __init__(self, address: Address, clock: TellsTime, *, shared: bool = False) -> None:
        self._clock, self._buffer = clock, bytearray(_LARGEST)
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._socket.settimeout(0.0)
            self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, RECEIVE_BYTES)
            self._socket.setsockopt(socket.SOL_SOCKET, _SO_TIMESTAMPNS, 1)
            if shared:
                self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            self._socket.bind((address.host, address.port))
        except OSError as error:
            self._socket.close()
            raise LabError(f"{address}: cannot listen there: {error.strerror or error}") from None

    @classmethod
    def of_group(cls, group: Address, interface: str, clock: TellsTime) -> "DatagramSocket":
        """Listen to a multicast group on one interface; what comes for other groups does not arrive."""
        one = cls(group, clock, shared=True)
        try:
            one._socket.setsockopt(socket.IPPROTO_IP, _IP_MULTICAST_ALL, 0)
            membership = socket.inet_aton(group.host) + socket.inet_aton(interface)
            one._socket.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, membership)
        except OSError as error:
            one.close()
            raise LabError(f"{group}: cannot join on {interface}: {error.strerror or error}") from None
        return one

    def send_multicast_from(self, interface: str) -> None:
        """Let multicast leave by this interface, and reach listeners on this machine too."""
        self._socket.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton(interface))
        self._socket.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_LOOP, 1)
        self._socket.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 1)

    @property
    def address(self) -> Address:
        """Where it listens."""
        return Address(*self._socket.getsockname())

    def fileno(self) -> int:
        """For select."""
        return self._socket.fileno()

    def send(self, data: bytes, to: Address) -> bool:
        """Send a datagram; False where it could not leave just now.

        Raises
        ------
        LabError
            It can never leave: the address or the size is wrong.
        """
        try:
            self._socket.sendto(data, (to.host, to.port))
        except OSError as error:
            if error.errno in _TRANSIENT:
                return False
            raise LabError(f"{to}: cannot be sent to: {error.strerror or error}") from None
        return True

    def receive(self) -> Datagram | None:
        """Return the next datagram; None where none is there."""
        while True:
            try:
                size, ancillary, _, sender = self._socket.recvmsg_into([self._buffer], 64)
            except BlockingIOError:
                return None
            except OSError as error:
                if error.errno in _TRANSIENT:
                    continue
                raise LabError(f"{self.address}: cannot be read: {error.strerror or error}") from None
            return Datagram(bytes(self._buffer[:size]), Address(*sender), self._stamp_ns(ancillary))

    def close(self) -> None:
        """Stop listening."""
        self._socket.close()

    def _stamp_ns(self, ancillary: list[tuple[int, int, bytes]]) -> int:
        for level, kind, data in ancillary:
            if level == socket.SOL_SOCKET and kind == _SO_TIMESTAMPNS and len(data) == _TIMESPEC.size:
                seconds, nanoseconds = _TIMESPEC.unpack(data)
                age_ns = time.time_ns() - (10**9 * seconds + nanoseconds)
                # The kernel stamps by the wall clock, which may have been set meanwhile.
                return self._clock.now_ns() - (age_ns if 0 <= age_ns < _LONGEST_AGE_NS else 0)
        return self._clock.now_ns()
