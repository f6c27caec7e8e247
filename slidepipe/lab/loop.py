"""The control loop: link, follow the course, slow down along it where something is wrong; the same for every arm."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from slidepipe.errors import LabError
from slidepipe.lab.clock import Pacer, Unpaced
from slidepipe.lab.course import Course, Phase, stopping_rates
from slidepipe.lab.protocols import Arm, JointCommand, JointState, MotionCapture, Recorder
from slidepipe.lab.safety import Guard, Stop, StopCause
from slidepipe.series import FloatArray
from slidepipe.tick import TICK_S

ECHO_PERIOD_S = 0.1
MOTION_STARTS = "motion starts"
MOTION_ENDS = "motion ends"
STOPPED = "stopped: "
"""How the event begins that tells of a stop."""
INVALID = "invalid: "
"""How the event begins that tells why a trial is not to be estimated."""

WISHES = {StopCause.OPERATOR: "a person asked for it", StopCause.ALONE: "the process that watched is gone"}
"""Why a desk may want the arm to stop, in words."""


@dataclass(frozen=True, slots=True)
class LoopSettings:
    """How the loop links and stops: see the lab file.

    Attributes
    ----------
    link_timeout_s : float
        How long to wait for the arm to follow.
    jump_rad : float
        How far a joint may be from the first command when the arm is let go.
    stop_s, hold_s : float
        How long a stop takes, and how long the arm is held after it.
    """

    link_timeout_s: float = 10.0
    jump_rad: float = 0.05
    stop_s: float = 0.3
    hold_s: float = 0.5


@dataclass(frozen=True, slots=True)
class Tick:
    """A tick as a desk sees it: what was commanded a tick ago, what is measured now, and the frames so far."""

    phase: Phase
    done: float
    commanded: JointCommand
    state: JointState
    late_ns: int
    frames: int


class Desk(Protocol):
    """Who watches: a person before a terminal, or nobody."""

    @property
    def wish(self) -> StopCause | None:
        """Why the arm shall stop, of :data:`WISHES`; None while it shall go on."""

    @property
    def go(self) -> bool:
        """Whether the arm may leave the pose in which it was linked."""

    def show(self, tick: "Tick") -> None:
        """Take note of a tick."""


class Nobody:
    """Watches nothing and lets everything go on."""

    wish = None
    go = True

    def show(self, tick: "Tick") -> None:
        """Nothing to do."""


@dataclass(frozen=True, slots=True)
class Execution:
    """One execution.

    Attributes
    ----------
    start_ns, stop_ns : int
        When the motion began and ended on the host's clock; that of the stop where it did not end.
    joint_error_rad : (T, 7)
        How the joints followed during the motion.
    longest_gap_s : float
        Longest time between two commands.
    stop : Stop, optional
        Why the arm was stopped, if it was.
    """

    start_ns: int
    stop_ns: int
    joint_error_rad: FloatArray
    longest_gap_s: float = 0.0
    stop: Stop | None = None


@dataclass(frozen=True, slots=True)
class Lab:
    """What the loop works with."""

    arm: Arm
    cameras: MotionCapture
    recorder: Recorder
    pacer: Pacer
    guard: Guard | None = None
    desk: Desk = Nobody()  # noqa: RUF009  # it has no state
    settings: LoopSettings = LoopSettings()


def execute(course: Course, arm: Arm, cameras: MotionCapture, recorder: Recorder) -> Execution:
    """Run a course in a lab that waits for the loop, unguarded, and record everything."""
    return run(course, Lab(arm, cameras, recorder, Unpaced()))


def run(course: Course, lab: Lab) -> Execution:
    """Run a course at one command a tick, and record everything.

    A tick of the phase ``LINK`` lasts until the arm follows and the desk lets it go. Where the machine was late, the
    ticks that have passed are left out: the course stays on the clock. Where the guard or the desk wants it, the arm
    slows down along the course and is held, and the rest is not done.

    Raises
    ------
    LabError
        The arm does not link in time.
    """
    return _Loop(course, lab).run()


class _Loop:
    """One tick after another, with an echo of the cameras every so often."""

    def __init__(self, course: Course, lab: Lab) -> None:
        self._course, self._lab = course, lab
        motion = [index for index, phase in enumerate(course.phases) if phase is Phase.MOTION]
        self._last_motion = motion[-1] if motion else len(course)
        self._errors = np.zeros((len(motion), len(course.commands[0].position_rad)))
        self._rates = stopping_rates(lab.settings.stop_s)
        self._echo_every = round(ECHO_PERIOD_S / TICK_S)
        self._unlinked_left = round(lab.settings.link_timeout_s / TICK_S)
        self._ticks = self._frames = self._moved = 0
        self._start_ns = self._ended_ns = self._last_ns = self._gap_ns = 0
        self._sent = course.commands[0]
        self._released = False

    def run(self) -> Execution:
        """Follow the course to its end, or to where it is stopped."""
        index, stop = -1, None
        while stop is None and index < len(self._course) - 1:
            index = self._next(index, self._lab.pacer.wait())
            stop = self._step(index)
        if stop is not None:
            self._lab.recorder.event(stop.stamp_ns, f"{STOPPED}{stop}")
            self._slow_down(index)
        ended_ns = self._ended_ns or self._last_ns
        return Execution(self._start_ns, ended_ns, self._errors[: self._moved], 1e-9 * self._gap_ns, stop)

    def _next(self, index: int, ticks: int) -> int:
        """Where on the course the arm shall be after so many ticks."""
        if index < 0 or self._course.phases[index] is Phase.LINK:
            return index + 1 if index < 0 or self._released else index
        return min(index + ticks, len(self._course) - 1)

    def _step(self, index: int) -> Stop | None:
        phase, before = self._course.phases[index], self._sent
        state = self._tick(self._course.commands[index], phase, index / len(self._course))
        wish = self._lab.desk.wish
        if wish is not None:
            return Stop(wish, WISHES[wish], state.stamp_ns)
        if phase is Phase.LINK:
            self._await_link(state)
            return None
        self._mark(index, state)
        return None if self._lab.guard is None else self._lab.guard.check(before, state)

    def _await_link(self, state: JointState) -> None:
        self._released = state.link.linked and self._lab.desk.go
        if self._released:
            refuse_jump(state.position_rad, self._course.position_rad[0], self._lab.settings.jump_rad)
            if self._lab.guard is not None:
                self._lab.guard.begin(state.stamp_ns)
        self._unlinked_left -= not state.link.linked
        if self._unlinked_left < 0:
            raise LabError(f"arm: it did not follow within {self._lab.settings.link_timeout_s:g} s: is it linked?")

    def _mark(self, index: int, state: JointState) -> None:
        """Tell when the motion begins and ends, and keep how the joints follow meanwhile."""
        if self._course.phases[index] is Phase.MOTION:
            if not self._start_ns:
                self._start_ns = state.stamp_ns
                self._lab.recorder.event(state.stamp_ns, MOTION_STARTS)
            self._errors[self._moved] = self._course.position_rad[index] - state.position_rad
            self._moved += 1
        if index >= self._last_motion and not self._ended_ns:
            self._ended_ns = state.stamp_ns
            self._lab.recorder.event(state.stamp_ns, MOTION_ENDS)

    def _slow_down(self, index: int) -> None:
        """Go on along the course, ever slower, and hold where that ends; an arm that is not linked yet just holds."""
        rates = self._rates if self._course.phases[index] is not Phase.LINK else np.zeros(1)
        done, place, end = 0, float(index), len(rates) + round(self._lab.settings.hold_s / TICK_S)
        while done < end:
            ticks = self._lab.pacer.wait()
            place = min(place + float(rates[done : done + ticks].sum()), len(self._course) - 1.0)
            done += ticks
            rate = float(rates[done - 1]) if done <= len(rates) else 0.0
            self._tick(self._course.at(place, rate), Phase.STOP, place / len(self._course))

    def _ask_clock(self) -> None:
        exchange = self._lab.cameras.echo()
        if exchange is not None:
            self._lab.recorder.clock(exchange)

    def _tick(self, command: JointCommand, phase: Phase, done: float) -> JointState:
        lab = self._lab
        if self._ticks % self._echo_every == 0:
            self._ask_clock()
        self._ticks += 1
        state = lab.arm.exchange(command)
        lab.recorder.joints(command, state)
        if lab.pacer.late_ns is not None:
            lab.recorder.tick(state.stamp_ns, lab.pacer.late_ns)
        for frame in lab.cameras.take():
            self._frames += 1
            lab.recorder.frame(frame)
            if lab.guard is not None:
                lab.guard.frame(frame, state.stamp_ns)
        if self._released:
            self._gap_ns = max(self._gap_ns, state.stamp_ns - self._last_ns)
        self._last_ns = state.stamp_ns
        lab.desk.show(Tick(phase, done, self._sent, state, lab.pacer.late_ns or 0, self._frames))
        self._sent = command
        return state


def refuse_jump(now_rad: FloatArray, wanted_rad: FloatArray, allowed_rad: float) -> None:
    """Refuse to jump from where the arm is to where a command would have it.

    Raises
    ------
    LabError
        A joint is farther than allowed.
    """
    apart = np.abs(now_rad - wanted_rad)
    joint = int(np.argmax(apart))
    if not apart[joint] <= allowed_rad:
        raise LabError(
            f"arm: joint {joint + 1} is at {now_rad[joint]:.3f} rad and the first command at {wanted_rad[joint]:.3f}: "
            f"a jump of {apart[joint]:.3f} rad is refused, {allowed_rad:g} is allowed"
        )
