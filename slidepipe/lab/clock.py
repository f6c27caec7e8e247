"""Time as the lab's processes see it: real, or virtual and as fast as the machine computes."""

import ctypes
import errno
import os
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from slidepipe.errors import LabError
from slidepipe.lab.host_clock import HostClock
from slidepipe.series import IntArray
from slidepipe.tick import TICK_S

TICK_NS = round(1e9 * TICK_S)
SPIN_NS = 150_000
"""The loop spins so long before each tick: 7 % of its core."""
_NS_PER_S = 1_000_000_000
_MONOTONIC, _ABSOLUTE = 1, 1
"""CLOCK_MONOTONIC and TIMER_ABSTIME of Linux."""


class Clock(Protocol):
    """What time it is, and waiting for a later one."""

    def now_ns(self) -> int:
        """Nanoseconds on the host's clock."""

    def wait_until(self, deadline_ns: int) -> None:
        """Return when the deadline has come, at once if it has passed."""


class _TimeSpec(ctypes.Structure):
    _fields_ = (("seconds", ctypes.c_long), ("nanoseconds", ctypes.c_long))


class RealClock(HostClock):
    """The host's clock, with waiting for an absolute deadline, so that lateness never adds up.

    Parameters
    ----------
    spin_ns : int
        How long before the deadline to stop sleeping and look at the clock instead: it takes that much of a core, and
        hides the kernel's own lateness of some 50 us.
    """

    def __init__(self, spin_ns: int = 0) -> None:
        super().__init__()
        self._spin_ns = spin_ns
        self._deadline = _TimeSpec()
        self._reference = ctypes.byref(self._deadline)
        self._sleep = ctypes.CDLL(None, use_errno=True).clock_nanosleep

    def wait_until(self, deadline_ns: int) -> None:
        """Sleep in the kernel until shortly before an absolute time, and spin for the rest."""
        monotonic_ns = deadline_ns - self._since_ns
        wake_ns = max(0, monotonic_ns - self._spin_ns)
        self._deadline.seconds, self._deadline.nanoseconds = divmod(wake_ns, _NS_PER_S)
        while (code := self._sleep(_MONOTONIC, _ABSOLUTE, self._reference, None)) == errno.EINTR:
            pass
        if code:
            raise LabError(f"clock: clock_nanosleep failed: {os.strerror(code)}")
        while time.monotonic_ns() < monotonic_ns:
            pass


@dataclass(slots=True)
class VirtualClock:
    """A clock that stands still until somebody waits; what else happens meanwhile runs at its own times.

    Attributes
    ----------
    time_ns : int
    """

    time_ns: int = _NS_PER_S
    _next: list[tuple[int, int, Callable[[int], None]]] = field(default_factory=list)

    def now_ns(self) -> int:
        """Time now."""
        return self.time_ns

    def every(self, period_ns: int, phase_ns: int, work: Callable[[int], None]) -> None:
        """Have ``work`` called with the time, every so often from ``phase_ns`` after now on."""
        self._next.append((self.time_ns + phase_ns, period_ns, work))

    def wait_until(self, deadline_ns: int) -> None:
        """Let everything happen that is due by then."""
        while self._next:
            index = min(range(len(self._next)), key=lambda one: self._next[one][0])
            due_ns, period_ns, work = self._next[index]
            if due_ns > deadline_ns:
                break
            self.time_ns = max(self.time_ns, due_ns)
            self._next[index] = (due_ns + period_ns, period_ns, work)
            work(due_ns)
        self.time_ns = max(self.time_ns, deadline_ns)


class Pacer(Protocol):
    """What the loop waits for; ``late_ns`` is by how much the tick that was last waited for began late."""

    late_ns: int | None

    def wait(self) -> int:
        """Return when the next tick is due, and how many ticks have come due: 1, more where the machine was late."""


class Unpaced:
    """The pace of a lab that moves on only when it is told to."""

    late_ns: int | None = None

    def wait(self) -> int:
        """Go on at once."""
        return 1


class Beat:
    """Absolute deadlines, one every tick, from the first call on; how late each was met is kept.

    Parameters
    ----------
    clock : Clock
    longest_s : float
        Room that is made beforehand for the lateness of so many ticks; that of later ones is not kept.

    Attributes
    ----------
    tick : int
        Number of the tick that was waited for last, from 0; those that were left out count.
    late_ns : int
        By how much it began late.
    """

    def __init__(self, clock: Clock, longest_s: float) -> None:
        self._clock = clock
        self._due_ns = -1
        self.late_ns: int | None = None
        self.tick = -1
        self._lateness_ns = np.zeros(round(longest_s / TICK_S) + 1, dtype=np.int64)
        self._count = 0

    def wait(self) -> int:
        """Wait for the next deadline; where more have passed entirely meanwhile, those are left out."""
        if self._due_ns < 0:
            self._due_ns = self._clock.now_ns()
        self._clock.wait_until(self._due_ns)
        late_ns = self._clock.now_ns() - self._due_ns
        missed = late_ns // TICK_NS
        if self._count < len(self._lateness_ns):
            self._lateness_ns[self._count] = late_ns
        self.late_ns = late_ns
        self._count += 1
        self._due_ns += (1 + missed) * TICK_NS
        self.tick += 1 + missed
        return 1 + missed

    @property
    def lateness_ns(self) -> IntArray:
        """Lateness of every tick so far, ns."""
        return self._lateness_ns[: min(self._count, len(self._lateness_ns))]
