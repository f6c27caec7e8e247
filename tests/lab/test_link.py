"""The link, the clock, the playout and the real-time measures by themselves."""

import socket
import time

import numpy as np
import pytest
from lab_setups import held_at

from slidepipe.errors import LabError
from slidepipe.lab.approach import MoveLimits, move
from slidepipe.lab.clock import SPIN_NS, TICK_NS, Beat, RealClock, VirtualClock
from slidepipe.lab.course import Course, Leg, Phase
from slidepipe.lab.link import LinkedArm
from slidepipe.lab.loop import refuse_jump
from slidepipe.lab.playout import DELAY_TICKS, InTurn
from slidepipe.lab.realtime import realtime
from slidepipe.lab.transport import Address, MemoryTransport, UdpTransport
from slidepipe.lab.wam_codec import CODECS, ArmReport, Order, Stamp

pytestmark = pytest.mark.realtime

LOOPBACK = "127.0.0.1"


def linked(dialect: str, *packets: bytes) -> tuple[LinkedArm, MemoryTransport, VirtualClock]:
    ours, clock = MemoryTransport(), VirtualClock()
    there = ours.other_end()
    for packet in packets:
        there.send(packet)
    return LinkedArm(ours, CODECS[dialect], clock, link_wait_s=0.1), there, clock


def test_connecting_sends_nothing_and_waits_no_longer_than_it_may() -> None:
    arm, there, clock = linked("positions")
    begun_ns = clock.now_ns()
    with pytest.raises(LabError, match=r"^arm: nothing heard of it for 0.5 s: is its program running"):
        arm.connect(0.5)
    assert 1e-9 * (clock.now_ns() - begun_ns) == pytest.approx(0.5, abs=0.005)
    assert there.receive() is None


@pytest.mark.parametrize(
    ("size", "words"),
    [
        (32, r"of 32 bytes, .* 56 \(7 joints\): an arm of 4 joints\?"),
        (112, r"of 112 bytes, .* they may be of the dialect 'velocities'$"),
    ],
)
def test_another_number_of_joints_is_refused(size: int, words: str) -> None:
    arm, _, _ = linked("positions", bytes(size))
    with pytest.raises(LabError, match=words):
        arm.connect(0.1)


def test_where_the_dialect_does_not_tell_the_arm_is_given_time_to_follow() -> None:
    codec = CODECS["positions"]
    arm, there, clock = linked("positions", codec.encode_report(ArmReport(np.zeros(7))))
    assert not arm.connect(0.1).link.linked
    assert not arm.exchange(held_at(np.zeros(7))).link.linked
    clock.wait_until(clock.now_ns() + 100_000_000)
    state = arm.exchange(held_at(np.zeros(7)))
    assert state.link.linked
    assert state.link.age_ns == 100_000_000
    assert there.receive() == bytes(56)


def test_speeds_are_measured_where_the_dialect_has_none() -> None:
    codec = CODECS["positions"]
    packets = [codec.encode_report(ArmReport(np.full(7, 0.002 * index))) for index in range(50)]
    arm, _, _ = linked("positions", *packets)
    np.testing.assert_allclose(arm.connect(0.1).velocity_rad_s, 1.0, atol=1e-5)


def test_states_out_of_order_are_left_and_gaps_counted() -> None:
    codec = CODECS["bridge"]
    packets = [
        codec.encode_report(ArmReport(np.full(7, 0.1 * number), stamp=Stamp(number % 2**32, 0)))
        for number in (2**32 - 1, 2**32, 2**32 + 3, 2**32 + 1)
    ]
    arm, _, _ = linked("bridge", *packets)
    state = arm.connect(0.1)
    assert state.position_rad[0] == pytest.approx(0.1 * (2**32 + 3))
    assert (arm.counts.received, arm.counts.disordered, arm.counts.lost) == (3, 1, 2)


def test_a_jump_is_refused() -> None:
    refuse_jump(np.zeros(7), np.full(7, 0.05), 0.05)
    with pytest.raises(LabError, match=r"^arm: joint 3 is at 0.000 rad and .* at 0.100: a jump of 0.100"):
        refuse_jump(np.zeros(7), np.array([0, 0, 0.1, 0, 0, 0.05, 0]), 0.05)
    with pytest.raises(LabError, match="a jump of nan"):
        refuse_jump(np.zeros(7), np.full(7, np.nan), 0.05)


def test_moves_are_smooth_and_within_their_limits() -> None:
    limits = MoveLimits(np.full(7, 0.5), np.full(7, 1.0), np.full(7, 5.0))
    leg = move(Phase.APPROACH, np.zeros(7), np.linspace(-1.0, 1.0, 7), limits)
    np.testing.assert_allclose(leg.position_rad[[0, -1]], [np.zeros(7), np.linspace(-1, 1, 7)], atol=1e-9)
    speed = np.diff(leg.position_rad, axis=0) / 0.002
    assert np.abs(speed).max() <= 0.5 + 1e-6
    assert np.abs(np.diff(speed, axis=0)).max() / 0.002 <= 1.0 + 1e-6
    assert np.abs(np.diff(speed, n=2, axis=0)).max() / 0.002**2 <= 5.0 + 1e-3


def test_between_ticks_a_course_is_the_cubic_through_them() -> None:
    time_s = 0.002 * np.arange(5)[:, None]
    cubic, slope = 3.0 * time_s**3 - time_s + 1.0, 9.0 * time_s**2 - 1.0
    course = Course.of([Leg(Phase.MOTION, cubic, slope, np.ones_like(cubic))])
    at = course.at(2.3, 0.5)
    instant = 0.002 * 2.3
    assert at.position_rad[0] == pytest.approx(3.0 * instant**3 - instant + 1.0, abs=1e-14)
    assert at.velocity_rad_s[0] == pytest.approx(0.5 * (9.0 * instant**2 - 1.0), abs=1e-11)
    assert at.feedforward_n_m[0] == pytest.approx(0.25)
    np.testing.assert_allclose(course.at(4.0, 1.0).position_rad, cubic[-1])


def test_numbered_commands_have_their_turn_whatever_the_network_does() -> None:
    playout, taken = InTurn(), []
    arrivals = {0: [0], 1: [], 2: [2, 1], 3: [3, 3], 4: [], 5: [5], 6: [4, 6], 7: [7], 8: [8], 9: [9]}
    for numbers in arrivals.values():
        for number in numbers:
            playout.put(Order(held_at(np.zeros(7)), Stamp(number, 0)))
        order = playout.take()
        taken.append(None if order is None or order.stamp is None else order.stamp.sequence)
    assert taken == [None] * DELAY_TICKS + [0, 1, 2, 3, 4, 5, 6]


class Late(VirtualClock):
    """Wakes up late, as told."""

    def __init__(self, *late_ns: int) -> None:
        super().__init__()
        self.late = list(late_ns)

    def wait_until(self, deadline_ns: int) -> None:
        super().wait_until(deadline_ns)
        self.time_ns += self.late.pop(0)


def test_the_beat_stays_on_the_clock_and_leaves_out_what_has_passed() -> None:
    beat = Beat(Late(0, 100, 3 * TICK_NS + 5, 0, 7), 1.0)
    assert [beat.wait() for _ in range(5)] == [1, 1, 4, 1, 1]
    np.testing.assert_array_equal(beat.lateness_ns, [0, 100, 3 * TICK_NS + 5, 0, 7])
    assert beat.tick == 7


def test_the_real_clock_never_wakes_up_early() -> None:
    clock = RealClock(SPIN_NS)
    assert abs(clock.now_ns() - time.time_ns()) < 1_000_000_000
    for wait_ns in (-1_000_000, 0, 1_000_000, 3_000_000):
        deadline_ns = clock.now_ns() + wait_ns
        clock.wait_until(deadline_ns)
        assert clock.now_ns() >= deadline_ns


def test_what_is_not_permitted_is_said_and_everything_is_given_back(monkeypatch: pytest.MonkeyPatch) -> None:
    import gc  # noqa: PLC0415
    import os  # noqa: PLC0415

    def refuse(*_: object) -> None:
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr(os, "sched_setscheduler", refuse)
    with realtime() as refused:
        assert not gc.isenabled()
        assert any(line.startswith("no real-time scheduling: Operation not permitted") for line in refused)
    assert gc.isenabled()


def test_a_udp_link_takes_datagrams_of_its_peer_alone() -> None:
    with (
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as peer,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger,
    ):
        peer.bind((LOOPBACK, 0))
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            probe.bind((LOOPBACK, 0))
            port = probe.getsockname()[1]
        link = UdpTransport(Address(LOOPBACK, port), Address(LOOPBACK, peer.getsockname()[1]))
        stranger.sendto(b"stranger", (LOOPBACK, port))
        peer.sendto(b"peer", (LOOPBACK, port))
        deadline = time.monotonic() + 5.0
        while (got := link.receive()) is None and time.monotonic() < deadline:
            time.sleep(0.001)
        assert got == b"peer"
        assert link.receive() is None
        with pytest.raises(LabError, match=rf"^arm: cannot talk from 127.0.0.1:{port} to .*: Address already in use"):
            UdpTransport(Address(LOOPBACK, port), Address(LOOPBACK, 1))
        link.close()
