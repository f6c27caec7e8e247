"""Every fault at three strengths through loop, link, guard and emulator: the run lands, or stops for the right reason.

In virtual time, so that nothing depends on the machine; :mod:`test_loopback` does some of it over sockets.
"""

from dataclasses import replace

import numpy as np
import pytest
from emulated import LIMITS, SETTINGS, Emulated, gentle, run_emulated

from slidepipe.lab.arm_program import ArmMode
from slidepipe.lab.course import Phase
from slidepipe.lab.faults import Fault, FaultKind
from slidepipe.lab.loop import MOTION_ENDS, MOTION_STARTS, STOPPED, Tick
from slidepipe.lab.safety import StopCause
from slidepipe.planning.planner import Plan, Setup

APART_M = 0.002
SLIDES_S = 0.75
"""About the time, after linking, at which the block begins to slide."""
LANDS = None
LOST = {StopCause.LINK, StopCause.TRACKING, StopCause.OBJECT}
"""An arm that goes limp during the motion may be noticed by any of these first."""

CASES = [
    (FaultKind.LOSS, 0.02, 0.0, LANDS),
    (FaultKind.LOSS, 0.3, 0.0, LANDS),
    (FaultKind.LOSS, 0.95, 0.3, {StopCause.LINK}),
    (FaultKind.DUPLICATION, 0.05, 0.0, LANDS),
    (FaultKind.DUPLICATION, 0.5, 0.0, LANDS),
    (FaultKind.DUPLICATION, 1.0, 0.0, LANDS),
    (FaultKind.REORDERING, 0.02, 0.0, LANDS),
    (FaultKind.REORDERING, 0.2, 0.0, LANDS),
    (FaultKind.REORDERING, 0.6, 0.0, LANDS),
    (FaultKind.JITTER, 0.0003, 0.0, LANDS),
    (FaultKind.JITTER, 0.001, 0.0, LANDS),
    (FaultKind.JITTER, 0.05, 0.3, {StopCause.LINK}),
    (FaultKind.OCCLUSION, 0.05, 0.0, LANDS),
    (FaultKind.OCCLUSION, 0.5, 0.0, LANDS),
    (FaultKind.OCCLUSION, 1.0, 0.3, {StopCause.OBJECT}),
    (FaultKind.BLINDNESS, 0.05, 0.0, LANDS),
    (FaultKind.BLINDNESS, 0.5, 0.0, LANDS),
    (FaultKind.BLINDNESS, 1.0, 0.3, {StopCause.MOCAP}),
    (FaultKind.SWAP, 0.05, 0.0, LANDS),
    (FaultKind.SWAP, 0.3, 0.0, {StopCause.SWAP, LANDS}),
    (FaultKind.SWAP, 1.0, 0.3, {StopCause.SWAP}),
    (FaultKind.DRIFT, 50.0, 0.0, LANDS),
    (FaultKind.DRIFT, 1000.0, 0.0, LANDS),
    (FaultKind.DRIFT, 10000.0, 0.0, LANDS),
    (FaultKind.FREEZE, 0.02, 0.3, LANDS),
    (FaultKind.FREEZE, 0.08, 0.3, LANDS),
    (FaultKind.FREEZE, 1.0, 0.3, {StopCause.MOCAP}),
    (FaultKind.STALL, 0.004, 0.3, LANDS),
    (FaultKind.STALL, 0.1, SLIDES_S, {StopCause.TRACKING, StopCause.OBJECT}),
    (FaultKind.STALL, 1.0, SLIDES_S, {StopCause.TRACKING, StopCause.OBJECT}),
    (FaultKind.UNLINK, 0.006, 0.3, LANDS),
    (FaultKind.UNLINK, 0.05, 0.3, {StopCause.LINK}),
    (FaultKind.UNLINK, 5.0, SLIDES_S, {StopCause.LINK}),
]


@pytest.fixture(scope="module")
def sound(short_plan: Plan, short_setup: Setup) -> Emulated:
    """Nothing goes wrong."""
    return run_emulated(short_plan, short_setup)


def test_every_kind_is_tried_at_three_strengths() -> None:
    tried = {kind: sum(case[0] is kind for case in CASES) for kind in FaultKind}
    assert set(tried.values()) == {3}


@pytest.mark.parametrize(
    ("fault", "causes"),
    [(Fault(kind, strength, start_s), causes) for kind, strength, start_s, causes in CASES],
    ids=[f"{kind.value}-{strength:g}" for kind, strength, _, _ in CASES],
)
def test_it_lands_or_stops_for_the_right_reason(
    short_plan: Plan, short_setup: Setup, sound: Emulated, *, fault: Fault, causes: set[StopCause | None] | None
) -> None:
    done = run_emulated(short_plan, short_setup, faults=(fault,))
    said = [text for _, text in done.notes.events]
    longest_s = 2e-3 * len(done.course) + SETTINGS.link_timeout_s + SETTINGS.stop_s + SETTINGS.hold_s
    assert done.virtual_s <= longest_s + 0.1, "nothing takes longer than it may"
    if causes is LANDS or (done.execution.stop is None and LANDS in causes):
        assert done.execution.stop is None, str(done.execution.stop)
        assert said == [MOTION_STARTS, MOTION_ENDS]
        assert np.hypot(*(done.after - sound.after)[:2]) < APART_M
        return
    assert done.execution.stop is not None
    assert done.execution.stop.cause in causes, str(done.execution.stop)
    assert said[-1] == f"{STOPPED}{done.execution.stop}"


def test_nothing_wrong_lands_where_virtual_time_without_a_wire_does(
    sound: Emulated, short_plan: Plan, short_landing: np.ndarray
) -> None:
    assert sound.execution.stop is None
    np.testing.assert_allclose(sound.before, short_plan.course.r_start, atol=1e-4)
    assert np.hypot(*(sound.after - short_landing)[:2]) < APART_M
    assert sound.arm.counts.lost == sound.arm.counts.disordered == 0
    assert sound.execution.longest_gap_s == pytest.approx(0.002, abs=1e-9)
    assert sound.notes.late_ns == [0] * len(sound.notes.states)


@pytest.mark.parametrize("dialect", ["positions", "velocities"])
def test_the_plain_dialects_follow_what_their_clip_permits(short_plan: Plan, short_setup: Setup, dialect: str) -> None:
    done = run_emulated(short_plan, short_setup, dialect=dialect, motion=gentle(short_plan))
    assert done.execution.stop is None
    assert np.abs(done.execution.joint_error_rad).max() < 0.03
    np.testing.assert_allclose(done.after[:2], done.before[:2], atol=3e-3)


def test_a_motion_beyond_the_clip_is_stopped_where_nobody_checked_it_before(
    short_plan: Plan, short_setup: Setup
) -> None:
    done = run_emulated(short_plan, short_setup, dialect="positions")
    assert done.execution.stop is not None
    assert done.execution.stop.cause in {StopCause.TRACKING, StopCause.OBJECT}


class Impatient:
    """Asks for a stop when the motion has gone on for some ticks."""

    go = True

    def __init__(self, moving_ticks: int) -> None:
        self._left = moving_ticks
        self.ticks = 0

    @property
    def wish(self) -> StopCause | None:
        return StopCause.OPERATOR if self._left <= 0 else None

    def show(self, tick: Tick) -> None:
        self.ticks += self._left > 0
        self._left -= tick.phase is Phase.MOTION


def test_a_stop_slows_down_along_the_path_and_holds(short_plan: Plan, short_setup: Setup) -> None:
    """It ends on the way that it was on, without a jump in place or in speed."""
    desk = Impatient(300)
    done = run_emulated(short_plan, short_setup, motion=gentle(short_plan), desk=desk)
    assert done.execution.stop is not None
    assert done.execution.stop.cause is StopCause.OPERATOR
    assert done.phase_of_stop() is Phase.MOTION
    sent = np.array([command.position_rad for command in done.notes.commands])
    speed = np.diff(sent, axis=0) / 0.002
    stopping = slice(desk.ticks, desk.ticks + 150)
    assert np.abs(np.diff(speed, axis=0)).max() < 0.04, "no jump in speed, rad/s a tick"
    np.testing.assert_array_equal(sent[-1], sent[-90])
    nearest = [np.abs(done.course.position_rad - place).max(axis=1).min() for place in sent[stopping]]
    assert max(nearest) < 1.5e-3, "on the path, between its samples"
    assert done.mode is ArmMode.LINKED
    assert done.notes.events[-1][1].startswith("stopped: Ctrl-C")


def test_an_arm_beyond_its_limits_is_stopped(short_plan: Plan, short_setup: Setup) -> None:
    upper = np.array(LIMITS.upper_rad)
    upper[1] = short_plan.joints.position_rad[0, 1] + 0.005
    done = run_emulated(short_plan, short_setup, limits=replace(LIMITS, upper_rad=upper))
    assert done.execution.stop is not None
    assert done.execution.stop.cause is StopCause.JOINT_LIMIT
    assert done.execution.stop.text.startswith("joint 2 is at ")


def test_an_arm_that_went_limp_follows_nobody_until_a_person_links_it_again(
    short_plan: Plan, short_setup: Setup
) -> None:
    done = run_emulated(short_plan, short_setup, faults=(Fault(FaultKind.UNLINK, 0.05, 0.3),))
    assert (done.mode, done.program.links, done.program.lost_links) == (ArmMode.LIMP, 1, 1)
