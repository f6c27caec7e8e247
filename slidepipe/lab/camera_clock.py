"""The cameras' clock on the host's while a trial runs: a first guess, which the estimate improves on afterwards."""

from collections import deque

from slidepipe.lab.protocols import ClockExchange

WINDOW = 30
"""Exchanges among which the shortest round trip is believed: three seconds of them, in which clocks hardly drift."""


class CameraClock:
    """Maps camera ticks to the host's clock by the exchange with the shortest round trip of the latest ones.

    Parameters
    ----------
    ticks_per_s : float
        Rate of the cameras' clock.
    """

    def __init__(self, ticks_per_s: float) -> None:
        self._ticks_per_s = ticks_per_s
        self._exchanges: deque[ClockExchange] = deque(maxlen=WINDOW)
        self._best: ClockExchange | None = None

    def take(self, exchange: ClockExchange) -> None:
        """Learn from an exchange."""
        self._exchanges.append(exchange)
        self._best = min(self._exchanges, key=_trip_ns)

    @property
    def round_trip_ns(self) -> int | None:
        """Shortest round trip; None before the first exchange."""
        return None if self._best is None else _trip_ns(self._best)

    def host_ns(self, ticks: int) -> int | None:
        """Time on the host's clock at which the cameras' showed ``ticks``; None before the first exchange.

        Examples
        --------
        >>> clock = CameraClock(1e6)
        >>> clock.take(ClockExchange(sent_ns=1_000_000, ticks=500, received_ns=1_200_000))
        >>> clock.host_ns(600)
        1200000
        """
        if self._best is None:
            return None
        middle_ns = (self._best.sent_ns + self._best.received_ns) // 2
        return max(0, middle_ns + round(1e9 * (ticks - self._best.ticks) / self._ticks_per_s))


def _trip_ns(exchange: ClockExchange) -> int:
    return exchange.received_ns - exchange.sent_ns
