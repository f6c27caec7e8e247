"""The host's clock: monotonic, and set to the wall once."""

import time
from typing import Protocol


class TellsTime(Protocol):
    """Any clock of the host."""

    def now_ns(self) -> int:
        """Nanoseconds since 1970 that never go back."""


class HostClock:
    """The host's clock, which goes on evenly whatever happens to the wall clock after the start."""

    def __init__(self) -> None:
        self._since_ns = time.time_ns() - time.monotonic_ns()

    def now_ns(self) -> int:
        """Time now."""
        return time.monotonic_ns() + self._since_ns
