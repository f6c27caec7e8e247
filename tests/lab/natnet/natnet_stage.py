"""A server that plays in a thread of its own, for tests over loopback."""

import socket
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from slidepipe.lab.natnet import messages as m
from slidepipe.lab.natnet.models import ModelDef, RigidBodyModel
from slidepipe.lab.natnet.server import NatNetServer, ServerSettings
from slidepipe.lab.natnet.settings import NatNetSettings, TrackedBody, Transport
from slidepipe.lab.natnet.version import NEWEST, NatNetVersion

LOOPBACK = "127.0.0.1"
CLOCK_HZ = 10_000_000
PATIENCE_S = 20.0
HAND, BLOCK = 3, 7
MODELS = ModelDef((RigidBodyModel("hand", HAND), RigidBodyModel("block", BLOCK)))


def ticks() -> int:
    return time.monotonic_ns() * CLOCK_HZ // 10**9


def free_port() -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind((LOOPBACK, 0))
        return int(probe.getsockname()[1])


def until(done: Callable[[], object]) -> None:
    """Wait for something that must happen sooner or later."""
    deadline = time.monotonic() + PATIENCE_S
    while not done():
        assert time.monotonic() < deadline, "it never happened"
        time.sleep(0.001)


class Stage:
    """Answers in a thread until the test is over; frames are published by the test, or all the time."""

    def __init__(self, server: NatNetServer) -> None:
        self.server, self.frame = server, 0
        self._lock, self._over = threading.Lock(), threading.Event()
        self._thread = threading.Thread(target=self._play, daemon=True)
        self._thread.start()

    def publish(self, *bodies: m.RigidBody, number: int | None = None, **fields: float) -> m.Frame:
        with self._lock:
            self.frame = self.frame + 1 if number is None else number
            fields.setdefault("exposure_ticks", ticks())
            frame = m.Frame(self.frame, bodies=bodies, **fields)
            self.server.publish(frame)
            return frame

    def again(self, frame: m.Frame) -> None:
        with self._lock:
            self.server.publish(frame)

    def set_models(self, models: ModelDef) -> None:
        with self._lock:
            self.server.set_models(models)

    def stop(self) -> None:
        self._over.set()
        self._thread.join()

    def _play(self) -> None:
        while not self._over.wait(0.001):
            with self._lock:
                self.server.poll(ticks())


@contextmanager
def playing(
    transport: Transport = Transport.UNICAST, version: NatNetVersion = NEWEST, models: ModelDef = MODELS, port: int = 0
) -> Iterator[Stage]:
    settings = ServerSettings(LOOPBACK, CLOCK_HZ, transport, version, command_port=port, data_port=free_port())
    with NatNetServer(settings, models) as server:
        stage = Stage(server)
        try:
            yield stage
        finally:
            stage.stop()


def towards(stage: Stage, hand: str | int = "hand", thing: str | int = "block", **others: object) -> NatNetSettings:
    """Settings of a client for this server."""
    settings = stage.server.settings
    chosen = {"timeout_s": PATIENCE_S, "transport": settings.transport} | others
    return NatNetSettings(
        LOOPBACK,
        LOOPBACK,
        TrackedBody(hand),
        TrackedBody(thing),
        command_port=stage.server.address.port,
        data_port=settings.data_port,
        **chosen,
    )
