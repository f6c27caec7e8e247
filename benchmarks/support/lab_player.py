"""An arm and cameras that answer and compute next to nothing: what the stream is measured against."""

import os
import select
from contextlib import closing
from typing import Any

import numpy as np

from slidepipe.arm import wam
from slidepipe.lab.clock import TICK_NS, RealClock
from slidepipe.lab.natnet import messages as m
from slidepipe.lab.natnet.models import ModelDef, RigidBodyModel
from slidepipe.lab.natnet.server import NatNetServer, ServerSettings
from slidepipe.lab.natnet.settings import NatNetSettings
from slidepipe.lab.transport import Address, UdpTransport
from slidepipe.lab.wam_codec import CODECS, ArmReport, Stamp

CLOCK_HZ = 10_000_000
FRAME_NS = 1_000_000_000 / 360.0
BODIES = (("hand", 1, 0.0), ("object", 2, 0.02))


def play(ours: Address, theirs: Address, cameras: NatNetSettings, home: np.ndarray, control: Any) -> None:
    """Send a state every 2 ms and a frame 360 times a second, and answer the cameras' client, until it is over."""
    over, ready, core = control
    os.sched_setaffinity(0, {core})
    served = ServerSettings(cameras.server, CLOCK_HZ, command_port=cameras.command_port, data_port=cameras.data_port)
    models = ModelDef(tuple(RigidBodyModel(name, number) for name, number, _ in BODIES))
    with closing(UdpTransport(ours, theirs)) as wire, NatNetServer(served, models) as server:
        ready.set()
        _play(wire, server, home, over)


def _play(wire: UdpTransport, server: NatNetServer, home: np.ndarray, over: Any) -> None:
    clock, codec = RealClock(), CODECS["bridge"]
    start_ns, tick, frame = clock.now_ns(), 0, 0
    still = np.zeros(wam.JOINT_COUNT)
    while not over.is_set():
        tick += 1
        due_ns = start_ns + tick * TICK_NS
        while select.select([server], [], [], max(0.0, 1e-9 * (due_ns - clock.now_ns())))[0]:
            server.poll(_ticks(clock))
        while wire.receive() is not None:
            pass
        wire.send(codec.encode_report(ArmReport(home, still, still, linked=True, stamp=Stamp(tick, due_ns), answers=0)))
        while start_ns + frame * FRAME_NS <= clock.now_ns():
            frame += 1
            server.publish(_frame(frame, _ticks(clock)))


def _ticks(clock: RealClock) -> int:
    return clock.now_ns() * CLOCK_HZ // 10**9 % 2**60


def _frame(number: int, ticks: int) -> m.Frame:
    bodies = tuple(m.RigidBody(body, (x, 0.3, 0.2), (0.0, 0.0, 0.0, 1.0)) for _, body, x in BODIES)
    return m.Frame(number, bodies=bodies, exposure_ticks=ticks, received_ticks=ticks, sent_ticks=ticks)
