"""The program on the arm's control PC: when it follows, when it lets go, and that it never links again by itself."""

import numpy as np
import pytest

from slidepipe.lab.arm_program import LINK_TICKS, MISSED_TICKS, NEAR_RAD, ArmMode, ArmProgram
from slidepipe.lab.clock import TICK_NS
from slidepipe.lab.faults import FaultClock
from slidepipe.lab.protocols import JointCommand, JointState
from slidepipe.lab.transport import MemoryTransport
from slidepipe.lab.wam_codec import CODECS, Stamp

HOME = np.linspace(-0.3, 0.3, 7)


class Stage:
    """A program, its clock, and an arm that is where it is put."""

    def __init__(self, dialect: str) -> None:
        self.codec, self.ours = CODECS[dialect], MemoryTransport()
        self.program = ArmProgram(
            self.ours.other_end(), self.codec, HOME, faults=FaultClock(), random=np.random.default_rng(0)
        )
        self.now_ns = self.number = 0
        self.measured = HOME.copy()

    def tick(self, wanted: np.ndarray | None = HOME, *, extra: bytes | None = None) -> JointCommand:
        """Let a tick pass, with a command or without."""
        if wanted is not None:
            body = self.codec.body(JointCommand(wanted, np.full(7, 0.5), np.full(7, 2.0)))
            self.ours.send(self.codec.seal(body, Stamp(self.number, self.now_ns)))
        if extra is not None:
            self.ours.send(extra)
        self.number += 1
        self.now_ns += TICK_NS
        command = self.program.command(self.now_ns)
        self.program.report(JointState(self.now_ns, self.measured, np.full(7, 0.1), np.zeros(7)), self.now_ns)
        return command

    def link(self) -> None:
        for _ in range(LINK_TICKS + 5):
            self.tick()
        assert self.program.mode is ArmMode.LINKED


@pytest.fixture(params=sorted(CODECS))
def stage(request: pytest.FixtureRequest) -> Stage:
    return Stage(request.param)


def test_it_holds_and_tells_its_state_every_tick_before_anybody_speaks(stage: Stage) -> None:
    for _ in range(20):
        np.testing.assert_array_equal(stage.tick(None).position_rad, HOME)
    told = [stage.codec.decode_report(stage.ours.receive() or b"") for _ in range(20)]
    assert all(report is not None and report.linked in (None, False) for report in told)
    assert stage.ours.receive() is None


def test_it_links_near_its_pose_alone(stage: Stage) -> None:
    for _ in range(3 * LINK_TICKS):
        stage.tick(HOME + np.array([0, 0, 1.01 * NEAR_RAD, 0, 0, 0, 0]))
    assert stage.program.mode is ArmMode.HOLDING
    stage.link()
    assert stage.program.links == 1


def test_ten_missed_ticks_and_it_is_limp_and_stays_so_whatever_comes(stage: Stage) -> None:
    stage.link()
    for _ in range(MISSED_TICKS - 1):
        stage.tick(None)
    assert stage.program.mode is ArmMode.LINKED
    stage.tick()
    for _ in range(MISSED_TICKS):
        stage.tick(None)
    assert stage.program.mode is ArmMode.LIMP
    stage.measured = HOME + 0.03
    stage.tick(None)
    limp = stage.tick(None)
    np.testing.assert_array_equal(limp.position_rad, stage.measured)
    np.testing.assert_array_equal(limp.velocity_rad_s, 0.1)
    np.testing.assert_array_equal(limp.feedforward_n_m, 0.0)
    stage.measured = HOME.copy()
    for _ in range(5 * LINK_TICKS):
        stage.tick()
    assert (stage.program.mode, stage.program.lost_links) == (ArmMode.LIMP, 1)


def test_a_person_links_a_stream_that_begins_after_a_second_of_silence(stage: Stage) -> None:
    stage.link()
    for _ in range(MISSED_TICKS + 520):
        stage.tick(None)
    stage.link()
    assert (stage.program.links, stage.program.lost_links) == (2, 1)


def test_the_vendors_control_differentiates_what_has_no_speeds() -> None:
    stage = Stage("positions")
    stage.link()
    moved = stage.tick(HOME + 0.001)
    np.testing.assert_allclose(moved.velocity_rad_s, 0.5, rtol=1e-9)
    np.testing.assert_array_equal(moved.feedforward_n_m, 0.0)
    np.testing.assert_array_equal(stage.tick(None).velocity_rad_s, 0.0)


def test_of_a_ticks_datagrams_the_last_wins_and_others_are_ignored() -> None:
    stage = Stage("positions")
    stage.link()
    later = stage.codec.body(JointCommand(HOME + 0.002, np.zeros(7), np.zeros(7)))
    np.testing.assert_array_equal(stage.tick(HOME + 0.001, extra=later).position_rad, HOME + 0.002)
    np.testing.assert_array_equal(stage.tick(HOME + 0.003, extra=b"short").position_rad, HOME + 0.003)


def test_the_bridge_goes_on_over_a_tick_that_is_missing() -> None:
    stage = Stage("bridge")
    stage.link()
    for _ in range(4):
        stage.tick(None)
    np.testing.assert_allclose(stage.tick(None).position_rad, HOME + 2 * 0.002 * 0.5)
    np.testing.assert_array_equal(stage.tick(None).feedforward_n_m, 2.0)
