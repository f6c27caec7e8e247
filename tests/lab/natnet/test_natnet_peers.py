"""Clients that others wrote receive the server's frames with the right poses."""

import importlib.util
import json
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

import natnet_peers
import pytest
from natnet_stage import BLOCK, HAND, LOOPBACK, Stage, playing

from slidepipe.lab.natnet import messages as m
from slidepipe.lab.natnet.settings import GROUP, Transport
from slidepipe.lab.natnet.version import NatNetVersion

FRAMES = 5
POSES = {HAND: (0.5, -0.25, 1.5, 0.0, 0.6, 0.0, 0.8), BLOCK: (0.125, 2.0, -3.0, 0.5, -0.5, 0.5, 0.5)}
CASES = [
    ("natnet", Transport.UNICAST, "4.1"),
    ("natnet", Transport.UNICAST, "3.0"),
    ("natnet", Transport.MULTICAST, "4.0"),
    ("natnetsdk", Transport.UNICAST, "4.1"),
    ("natnetsdk", Transport.UNICAST, "3.0"),
    ("natnetsdk", Transport.UNICAST, "2.9"),
    ("motioncapture", Transport.MULTICAST, "3.0"),
    ("motioncapture", Transport.MULTICAST, "4.1"),
]


def missing(name: str) -> bool:
    spec = importlib.util.find_spec(name)
    return spec is None or spec.origin is None  # a directory of this name, such as ours, is no package


@contextmanager
def joined_on_loopback() -> Iterator[None]:
    """One client joins by the default interface; the kernel hands it loopback's frames once anybody joined there."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        membership = socket.inet_aton(GROUP) + socket.inet_aton(LOOPBACK)
        one.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, membership)
        yield


def always_publishing(stage: Stage, over: threading.Event) -> None:
    bodies = [m.RigidBody(number, pose[:3], pose[3:], mean_error_m=1e-4) for number, pose in POSES.items()]
    while not over.wait(0.01):
        labelled = (m.LabelledMarker(HAND << 16 | 1, (0.5, 0.5, 0.5), 0.01, 2, 0.0),)
        stage.publish(*bodies, labelled_markers=labelled, timestamp_s=time.monotonic())


@pytest.mark.parametrize(
    ("name", "transport", "version"),
    [
        pytest.param(
            *case, marks=pytest.mark.skipif(missing(case[0]), reason=f"{case[0]} is not installed: make check-peers")
        )
        for case in CASES
    ],
)
def test_a_client_of_others_receives_the_poses(name: str, transport: Transport, version: str) -> None:
    over = threading.Event()
    with joined_on_loopback(), playing(transport, NatNetVersion.parse(version)) as stage:
        publisher = threading.Thread(target=always_publishing, args=(stage, over))
        publisher.start()
        ports = (stage.server.address.port, stage.server.settings.data_port)
        command = [sys.executable, natnet_peers.__file__, name, transport.value, *map(str, ports), str(FRAMES)]
        patience_s = 3 * natnet_peers.PATIENCE_S
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=patience_s, check=False)  # noqa: S603
        finally:
            over.set()
            publisher.join()
    assert done.returncode == 0, done.stderr[-2000:]
    frames = json.loads(done.stdout.splitlines()[-1])
    assert len(frames) == FRAMES, done.stderr[-2000:]
    names = {"hand": HAND, "block": BLOCK}
    for frame in frames:
        told = {names.get(key) or int(key): pose for key, pose in frame.items()}
        assert told == {number: pytest.approx(pose, abs=1e-6) for number, pose in POSES.items()}
