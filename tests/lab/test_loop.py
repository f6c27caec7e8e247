"""The control loop on an arm and cameras that only pretend."""

from dataclasses import dataclass, field

import numpy as np
import pytest
from lab_setups import Notes

from slidepipe.lab.course import rest_move_rest
from slidepipe.lab.loop import MOTION_ENDS, MOTION_STARTS, Execution, execute
from slidepipe.lab.protocols import Arm, ClockExchange, JointCommand, JointState, MocapFrame, MotionCapture, Recorder
from slidepipe.series import JointSeries

REST = 250
"""Ticks of rest on either side: half a second."""
COUNT = 37


@dataclass
class PretendArm:
    """Is always where it was told to be a tick ago, one hundredth of a radian off."""

    tick: int = 0
    received: list[JointCommand] = field(default_factory=list)

    def exchange(self, command: JointCommand) -> JointState:
        self.received.append(command)
        told = self.received[-2] if self.tick else command
        state = JointState(5_000 + 2_000_000 * self.tick, told.position_rad - 0.01, np.full(7, self.tick), np.zeros(7))
        self.tick += 1
        return state


@dataclass
class PretendCameras:
    """Two frames in every third tick."""

    taken: int = 0
    echoes: int = 0
    ticks_per_s: float = 1e7

    def take(self) -> list[MocapFrame]:
        self.taken += 1
        return [MocapFrame(2 * self.taken + i, 0, 0, None, None) for i in range(2)] if self.taken % 3 == 0 else []

    def echo(self) -> ClockExchange:
        self.echoes += 1
        return ClockExchange(self.echoes, self.echoes, self.echoes)


@dataclass(frozen=True)
class Run:
    reference: JointSeries
    arm: PretendArm
    cameras: PretendCameras
    notes: Notes
    execution: Execution


@pytest.fixture(scope="module")
def run() -> Run:
    random = np.random.default_rng(0)
    position, velocity, effort = random.normal(size=(3, COUNT, 7))
    reference = JointSeries(np.arange(COUNT) * 2_000_000, position, velocity, effort)
    arm, cameras, notes = PretendArm(), PretendCameras(), Notes()
    roles: tuple[Arm, MotionCapture, Recorder] = (arm, cameras, notes)
    return Run(reference, arm, cameras, notes, execute(rest_move_rest(reference), *roles))


def test_the_arm_rests_half_a_second_before_and_after(run: Run) -> None:
    assert len(run.arm.received) == REST + COUNT + REST
    for commands, at in ((run.arm.received[:REST], 0), (run.arm.received[-REST:], -1)):
        for command in commands:
            np.testing.assert_array_equal(command.position_rad, run.reference.position_rad[at])
            np.testing.assert_array_equal(command.velocity_rad_s, 0.0)
            np.testing.assert_array_equal(command.feedforward_n_m, 0.0)


def test_every_sample_is_sent_once_and_in_order(run: Run) -> None:
    sent = run.arm.received[REST:-REST]
    np.testing.assert_array_equal([command.position_rad for command in sent], run.reference.position_rad)
    np.testing.assert_array_equal([command.velocity_rad_s for command in sent], run.reference.velocity_rad_s)
    np.testing.assert_array_equal([command.feedforward_n_m for command in sent], run.reference.effort_n_m)


def test_the_motion_is_marked_where_its_first_and_last_sample_go_out(run: Run) -> None:
    start_ns, stop_ns = 5_000 + 2_000_000 * REST, 5_000 + 2_000_000 * (REST + COUNT - 1)
    assert run.notes.events == [(start_ns, MOTION_STARTS), (stop_ns, MOTION_ENDS)]
    assert (run.execution.start_ns, run.execution.stop_ns) == (start_ns, stop_ns)


def test_the_joint_error_is_that_of_the_motion_alone(run: Run) -> None:
    position = run.reference.position_rad
    before = np.vstack([position[:1], position[:-1]])
    np.testing.assert_allclose(run.execution.joint_error_rad, position - before + 0.01, atol=1e-15)


def test_the_clock_is_asked_every_tenth_of_a_second_beginning_with_the_first_tick(run: Run) -> None:
    ticks_before = [run.notes.order[:index].count("j") for index, what in enumerate(run.notes.order) if what == "c"]
    assert ticks_before == list(range(0, 2 * REST + COUNT, 50))


def test_everything_is_recorded(run: Run) -> None:
    assert run.notes.order.count("j") == 2 * REST + COUNT
    assert all(a is b for a, b in zip(run.notes.commands, run.arm.received, strict=True))
    assert [state.velocity_rad_s[0] for state in run.notes.states] == list(range(2 * REST + COUNT))
    assert len(run.notes.frames) == 2 * (run.cameras.taken // 3)
    assert [f.frame for f in run.notes.frames[:4]] == [6, 7, 12, 13]
    assert len(run.notes.echoes) == run.cameras.echoes
