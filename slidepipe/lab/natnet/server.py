"""Plays Motive: answers what clients ask and sends them frames. Its owner drives it and brings the clock."""

from dataclasses import dataclass, replace
from types import TracebackType

from slidepipe.errors import PacketError
from slidepipe.lab.host_clock import HostClock
from slidepipe.lab.natnet import messages as m
from slidepipe.lab.natnet.codec import Message, decode, encode
from slidepipe.lab.natnet.datagrams import Address, Datagram, DatagramSocket
from slidepipe.lab.natnet.models import ModelDef
from slidepipe.lab.natnet.settings import COMMAND_PORT, DATA_PORT, GROUP, Transport
from slidepipe.lab.natnet.version import NEWEST, OLDEST, NatNetVersion

SILENT_S = 10.0
"""A client that says nothing for so long gets no more frames."""
MOST_CLIENTS = 16
MOST_AT_ONCE = 64
BITSTREAM = "Bitstream"
FREE_VERSION_SINCE = NatNetVersion(4, 0)
"""From this version on, a unicast client chooses its own."""


@dataclass(frozen=True, slots=True)
class ServerSettings:
    """Where the server listens, and what it says of itself.

    Attributes
    ----------
    interface : str
        IPv4 address, to which alone the sockets are bound.
    clock_hz : int
        Ticks of its clock in a second.
    transport : Transport
    version : NatNetVersion
    """

    interface: str
    clock_hz: int = 10_000_000
    transport: Transport = Transport.UNICAST
    version: NatNetVersion = NEWEST
    command_port: int = COMMAND_PORT
    data_port: int = DATA_PORT
    group: str = GROUP
    name: str = "slidepipe"


@dataclass(slots=True)
class _Client:
    heard_ticks: int
    version: NatNetVersion


class NatNetServer:
    """A NatNet server on one interface, to be used in a ``with`` statement.

    Parameters
    ----------
    settings : ServerSettings
    models : ModelDef
        What it tracks.

    Attributes
    ----------
    settings : ServerSettings

    Raises
    ------
    LabError
        The address is not this machine's, or the port is taken.
    """

    def __init__(self, settings: ServerSettings, models: ModelDef) -> None:
        self.settings, self._models, self._changed = settings, models, False
        self._clients: dict[Address, _Client] = {}
        self._clock = HostClock()
        self._socket = DatagramSocket(Address(settings.interface, settings.command_port), self._clock)
        if settings.transport is Transport.MULTICAST:
            self._socket.send_multicast_from(settings.interface)

    def __enter__(self) -> "NatNetServer":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @property
    def address(self) -> Address:
        """Where it listens."""
        return self._socket.address

    @property
    def clients(self) -> tuple[Address, ...]:
        """Unicast clients that get frames."""
        return tuple(self._clients)

    def fileno(self) -> int:
        """For select: readable where :meth:`poll` has something to do."""
        return self._socket.fileno()

    def set_models(self, models: ModelDef) -> None:
        """Track other models from now on; the next frame says that the list has changed."""
        self._models, self._changed = models, True

    def poll(self, now_ticks: int) -> None:
        """Answer everything that was asked; ``now_ticks`` is its clock now. Returns at once."""
        called_ns = self._clock.now_ns()
        for _ in range(MOST_AT_ONCE):
            datagram = self._socket.receive()
            if datagram is None:
                break
            # A question that came after the call must not be answered with a time before it.
            since_ns = self._clock.now_ns() - called_ns
            self._answer(datagram, now_ticks + since_ns * self.settings.clock_hz // 10**9)
        longest = SILENT_S * self.settings.clock_hz
        self._clients = {
            address: client for address, client in self._clients.items() if now_ticks - client.heard_ticks < longest
        }

    def publish(self, frame: m.Frame) -> None:
        """Send a frame to every client, or to the multicast group.

        Raises
        ------
        PacketError
            The frame does not fit a datagram.
        """
        if self._changed:
            frame = replace(frame, params=frame.params | m.FrameFlags.MODELS_CHANGED)
            self._changed = False
        if self.settings.transport is Transport.MULTICAST:
            group = Address(self.settings.group, self.settings.data_port)
            self._socket.send(encode(frame, self.settings.version), group)
            return
        packets = {version: encode(frame, version) for version in {one.version for one in self._clients.values()}}
        for address, client in self._clients.items():
            self._socket.send(packets[client.version], address)

    def close(self) -> None:
        """Stop listening."""
        self._socket.close()

    def _answer(self, datagram: Datagram, now_ticks: int) -> None:
        sender = datagram.sender
        try:
            message = decode(datagram.data, self.settings.version)
        except PacketError:
            self._socket.send(encode(m.Unrecognized(), self.settings.version), sender)
            return
        client = self._clients.get(sender)
        if client is not None:
            client.heard_ticks = now_ticks
        elif isinstance(message, m.Connect) and self.settings.transport is Transport.UNICAST:
            self._welcome(sender, now_ticks)
        if isinstance(message, m.Disconnect):
            self._clients.pop(sender, None)
            return
        answer = self._reply(message, sender, now_ticks)
        if answer is not None:
            version = self._clients[sender].version if sender in self._clients else self.settings.version
            self._socket.send(encode(answer, version), sender)

    def _welcome(self, sender: Address, now_ticks: int) -> None:
        if len(self._clients) < MOST_CLIENTS:
            self._clients[sender] = _Client(now_ticks, self.settings.version)

    def _reply(self, message: Message, sender: Address, now_ticks: int) -> Message | None:
        match message:
            case m.Connect() | m.Discovery():
                return self._info()
            case m.ModelDefRequest():
                return self._models
            case m.EchoRequest():
                return m.EchoResponse(message.client_stamp, now_ticks)
            case m.Request():
                return self._obey(message.text, sender)
            case m.KeepAlive():
                return None
        return m.Unrecognized()

    def _info(self) -> m.ServerInfo:
        settings = self.settings
        version = (settings.version.major, settings.version.minor, 0, 0)
        a, b, c, d = (int(part) for part in settings.group.split("."))
        multicast = int(settings.transport is Transport.MULTICAST)
        stream = m.Stream(settings.clock_hz, settings.data_port, multicast, (a, b, c, d))
        told = stream if settings.version >= NatNetVersion(3, 0) else None
        return m.ServerInfo(settings.name, (1, 0, 0, 0), version, told)

    def _obey(self, text: str, sender: Address) -> Message:
        """Tell or change the version of a client's stream; there is no other command."""
        command, _, wanted = text.partition(",")
        client = self._clients.get(sender)
        if command != BITSTREAM:
            return m.Unrecognized()
        if not wanted:
            return m.Response(f"{BITSTREAM},{client.version if client else self.settings.version}")
        try:
            version = NatNetVersion.parse(wanted)
        except PacketError:
            return m.Response(1)
        if client is None or self.settings.version < FREE_VERSION_SINCE or not OLDEST <= version <= NEWEST:
            return m.Response(1)
        client.version = version
        return m.Response(0)
