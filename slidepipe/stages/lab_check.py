"""Check a lab: what its arm and its cameras say, without a word to the arm."""

from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from slidepipe.artifacts.lab import LabDocument, find_lab, load_lab
from slidepipe.artifacts.lab_names import EXPERIMENTS
from slidepipe.errors import LabError
from slidepipe.lab.clock import TICK_NS, RealClock
from slidepipe.lab.link import LinkedArm
from slidepipe.lab.natnet.client import NatNetClient
from slidepipe.lab.natnet.messages import ServerInfo
from slidepipe.lab.protocols import MocapFrame
from slidepipe.lab.transport import UdpTransport
from slidepipe.lab.wam_codec import CODECS
from slidepipe.stages.labs import address, camera_settings

LISTEN_S = 2.0
"""How long both streams are listened to."""


@dataclass(frozen=True, slots=True)
class Fact:
    """One thing that was found: about the arm or the cameras, and whether it is as it should be."""

    about: str
    name: str
    value: str
    sound: bool = True


@dataclass(frozen=True, slots=True)
class LabCheck:
    """What was found in a lab."""

    lab: LabDocument
    facts: tuple[Fact, ...]

    @property
    def sound(self) -> bool:
        """Whether everything is as it should be."""
        return all(fact.sound for fact in self.facts)


def run(name: str, listen_s: float = LISTEN_S) -> LabCheck:
    """Listen to a lab's arm and cameras; nothing is sent to the arm, and nothing moves.

    Raises
    ------
    NotFoundError
        There is no such lab file.
    InputError
        It is wrong.
    """
    lab = load_lab(find_lab(name, EXPERIMENTS))
    with ThreadPoolExecutor(len(LOOKS)) as both:
        found = both.map(lambda about, look: _facts(about, look, lab, listen_s), LOOKS.keys(), LOOKS.values())
        return LabCheck(lab, tuple(fact for facts in found for fact in facts))


Look = Callable[[LabDocument, float], list[tuple[str, str, bool]]]


def _facts(about: str, look: Look, lab: LabDocument, listen_s: float) -> list[Fact]:
    try:
        return [Fact(about, *row) for row in look(lab, listen_s)]
    except LabError as error:
        return [Fact(about, "error", str(error), sound=False)]


def _arm(lab: LabDocument, listen_s: float) -> list[tuple[str, str, bool]]:
    clock, codec = RealClock(), CODECS[lab.arm.dialect]
    with closing(UdpTransport(address(lab.arm.local), address(lab.arm.remote))) as transport:
        arm = LinkedArm(transport, codec, clock)
        first = arm.connect(lab.timeouts.connect_s)
        arm.listen_anew()
        end_ns = clock.now_ns() + round(1e9 * listen_s)
        oldest_ns = 0
        while clock.now_ns() < end_ns:
            clock.wait_until(clock.now_ns() + TICK_NS)
            oldest_ns = max(oldest_ns, arm.listen().link.age_ns)
        last = arm.listen()
    home = np.abs(last.position_rad - np.array(lab.arm.home_pose_rad)).max()
    rate_hz = arm.counts.received / listen_s
    drift = np.abs(last.position_rad - first.position_rad).max()
    linked = "follows commands" if last.link.linked else "does not follow commands yet"
    return [
        ("dialect", f"{codec.name}, {codec.size} bytes a state", True),
        (
            "states",
            f"{rate_hz:.0f} a second, {arm.counts.lost} lost, longest silence {1e-6 * oldest_ns:.1f} ms",
            rate_hz > 450,
        ),
        ("joints", "[" + ", ".join(f"{angle:.3f}" for angle in last.position_rad) + "] rad", True),
        ("from home", f"{home:.3f} rad at most", True),
        ("at rest", f"moved {1e3 * drift:.2f} mrad meanwhile", bool(drift < 0.01)),
        ("link", linked if codec.tells_linked else "this dialect does not tell", not last.link.fault),
    ]


def _cameras(lab: LabDocument, listen_s: float) -> list[tuple[str, str, bool]]:
    clock = RealClock()
    with NatNetClient(camera_settings(lab), clock) as client:
        client.take()
        end_ns, frames = clock.now_ns() + round(1e9 * listen_s), []
        while clock.now_ns() < end_ns:
            clock.wait_until(clock.now_ns() + 5 * TICK_NS)
            client.echo()
            frames += client.take()
        info, counts, version = client.info, client.counts, client.version
        latencies = _latencies_s(client, frames)
        round_trip_ns = client.camera_clock.round_trip_ns
        offset_s = _offset_s(client, clock)
    rate_hz = len(frames) / listen_s
    server_version = ".".join(str(part) for part in info.application_version)
    return [
        ("server", f"{info.name} {server_version}, NatNet {version}", True),
        ("clock", f"{_rate(info)} ticks/s, offset {offset_s}, round trip {_ms(round_trip_ns)}", True),
        (
            "frames",
            f"{rate_hz:.0f} a second, {counts.frames.missing} missing",
            abs(rate_hz / lab.cameras.rate_hz - 1) < 0.1,
        ),
        ("latency", latencies, True),
        _tracking("hand", sum(frame.hand is None for frame in frames), len(frames)),
        _tracking("object", sum(frame.object is None for frame in frames), len(frames)),
        ("apart", _apart(frames), True),
    ]


def _rate(info: ServerInfo) -> str:
    return "-" if info.stream is None else f"{info.stream.clock_hz:,}"


def _offset_s(client: NatNetClient, clock: RealClock) -> str:
    """How far the host's clock is ahead of the cameras'."""
    at_zero_ns = client.camera_clock.host_ns(0)
    if at_zero_ns is None:
        return "-"
    ahead_s = 1e-9 * at_zero_ns
    return f"{ahead_s:.4f} s (it is {1e-9 * clock.now_ns() - ahead_s:.1f} s old)"


def _latencies_s(client: NatNetClient, frames: list[MocapFrame]) -> str:
    host = [client.camera_clock.host_ns(frame.ticks) for frame in frames]
    late = [1e-6 * (frame.received_ns - at) for frame, at in zip(frames, host, strict=True) if at is not None]
    if not late:
        return "-"
    return f"{np.median(late):.2f} ms median, {np.percentile(late, 99):.2f} ms in 99 %"


def _tracking(body: str, missing: int, frames: int) -> tuple[str, str, bool]:
    share = 1.0 - missing / frames if frames else 0.0
    return body, f"tracked in {100 * share:.1f} % of the frames", share > 0.5


def _apart(frames: list[MocapFrame]) -> str:
    apart = [
        float(np.linalg.norm(frame.hand.position_m - frame.object.position_m))
        for frame in frames
        if frame.hand is not None and frame.object is not None
    ]
    return f"{1e3 * np.median(apart):.1f} mm between hand and object" if apart else "-"


def _ms(value_ns: int | None) -> str:
    return "-" if value_ns is None else f"{1e-6 * value_ns:.2f} ms"


LOOKS: Mapping[str, Look] = MappingProxyType({"arm": _arm, "cameras": _cameras})
