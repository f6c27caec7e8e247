"""The server on its own, asked by hand."""

import socket
from collections.abc import Iterator

import pytest
from natnet_stage import CLOCK_HZ, LOOPBACK, MODELS, until

from slidepipe.errors import LabError
from slidepipe.lab.natnet import messages as m
from slidepipe.lab.natnet.codec import Message, decode, encode
from slidepipe.lab.natnet.server import SILENT_S, NatNetServer, ServerSettings
from slidepipe.lab.natnet.version import NEWEST, NatNetVersion


@pytest.fixture
def server() -> Iterator[NatNetServer]:
    with NatNetServer(ServerSettings(LOOPBACK, CLOCK_HZ, command_port=0, data_port=1511), MODELS) as one:
        yield one


class Asker:
    def __init__(self, server: NatNetServer) -> None:
        self.server, self.version = server, NEWEST
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind((LOOPBACK, 0))
        self.socket.settimeout(5.0)

    def say(self, message: Message | bytes, now_ticks: int = 0) -> None:
        data = message if isinstance(message, bytes) else encode(message, self.version)
        self.socket.sendto(data, (LOOPBACK, self.server.address.port))
        self.server.poll(now_ticks)

    def ask(self, message: Message | bytes, now_ticks: int = 0) -> Message:
        self.say(message, now_ticks)
        return self.hear()

    def hear(self) -> Message:
        return decode(self.socket.recv(65536), self.version)

    def hears_nothing(self) -> bool:
        self.socket.setblocking(False)
        try:
            return not self.socket.recv(65536)
        except BlockingIOError:
            return True
        finally:
            self.socket.settimeout(5.0)


@pytest.fixture
def asker(server: NatNetServer) -> Iterator[Asker]:
    one = Asker(server)
    with one.socket:
        yield one


def test_every_question_has_its_answer(asker: Asker) -> None:
    info = m.ServerInfo("slidepipe", (1, 0, 0, 0), (4, 1, 0, 0), m.Stream(CLOCK_HZ, 1511, 0, (239, 255, 42, 99)))
    assert asker.ask(m.Discovery()) == info
    assert asker.server.clients == (), "who only looks gets no frames"
    assert asker.ask(m.Connect()) == info
    assert len(asker.server.clients) == 1
    assert asker.ask(m.ModelDefRequest()) == MODELS
    echoed = asker.ask(m.EchoRequest(77), now_ticks=10**12)
    assert echoed.client_stamp == 77
    assert 10**12 <= echoed.server_ticks < 10**12 + CLOCK_HZ
    assert asker.ask(m.Request("Bitstream")) == m.Response("Bitstream,4.1")
    assert asker.ask(m.Request("SubscribeToData,RigidBody,all")) == m.Unrecognized()
    assert asker.ask(m.FrameRequest()) == m.Unrecognized()
    assert asker.ask(b"\x39\0\0\0") == m.Unrecognized()
    assert asker.ask(b"\1") == m.Unrecognized()
    asker.say(m.KeepAlive())
    assert asker.hears_nothing()


def test_a_client_that_is_silent_is_forgotten(asker: Asker) -> None:
    asker.ask(m.Connect(), now_ticks=0)
    almost = round((SILENT_S - 1.0) * CLOCK_HZ)
    asker.say(m.KeepAlive(), now_ticks=almost)
    asker.server.poll(2 * almost)
    assert len(asker.server.clients) == 1
    asker.server.poll(almost + round((SILENT_S + 1.0) * CLOCK_HZ))
    assert asker.server.clients == ()


def test_a_unicast_client_chooses_its_version(asker: Asker) -> None:
    asker.ask(m.Connect())
    assert asker.ask(m.Request("Bitstream,9.9")) == m.Response(1)
    assert asker.ask(m.Request("Bitstream,no")) == m.Response(1)
    assert asker.ask(m.Request("Bitstream,3.0")) == m.Response(0)
    asker.version = NatNetVersion(3, 0)
    frame = m.Frame(5, bodies=(m.RigidBody(3, (1.0, 2.0, 3.0), (0.0, 0.0, 0.0, 1.0)),))
    asker.server.publish(frame)
    assert asker.hear() == frame


def test_a_changed_list_of_models_is_announced_once(asker: Asker) -> None:
    asker.ask(m.Connect())
    asker.server.set_models(MODELS)
    for expected in (m.FrameFlags.MODELS_CHANGED, 0):
        asker.server.publish(m.Frame(1))
        assert asker.hear().params == expected


def test_a_client_that_is_gone_does_no_harm(server: NatNetServer) -> None:
    asker = Asker(server)
    asker.ask(m.Connect())
    asker.socket.close()
    for number in range(5):
        server.publish(m.Frame(number))
        server.poll(0)
    until(lambda: True)
    assert len(server.clients) == 1


def test_clients_beyond_the_limit_are_answered_and_get_no_frames(server: NatNetServer) -> None:
    askers = [Asker(server) for _ in range(17)]
    for one in askers:
        assert isinstance(one.ask(m.Connect()), m.ServerInfo)
    assert len(server.clients) == 16
    server.publish(m.Frame(1))
    assert askers[0].hear() == m.Frame(1, ptp=m.Ptp(0, 0))
    assert askers[16].hears_nothing()
    for one in askers:
        one.socket.close()


def test_a_port_that_is_taken(server: NatNetServer) -> None:
    port = server.address.port
    with pytest.raises(LabError, match=rf"^127\.0\.0\.1:{port}: cannot listen there: Address already in use$"):
        NatNetServer(ServerSettings(LOOPBACK, command_port=port), MODELS)
