"""The host's clock: monotonic, and set to the wall once."""

import time

LONGEST_AGE_NS = 1_000_000_000
"""What arrived longer ago than this cannot be: the wall clock was set meanwhile."""


class HostClock:
    """Nanoseconds since 1970 that never go back, whatever happens to the wall clock after the start."""

    def __init__(self) -> None:
        self._since_ns = time.time_ns() - time.monotonic_ns()

    def now_ns(self) -> int:
        """Time now."""
        return time.monotonic_ns() + self._since_ns

    def at_wall_ns(self, wall_ns: int) -> int:
        """Time at which the wall clock showed ``wall_ns``, a moment ago: the kernel stamps datagrams by it."""
        age_ns = time.time_ns() - wall_ns
        return self.now_ns() - (age_ns if 0 <= age_ns < LONGEST_AGE_NS else 0)
