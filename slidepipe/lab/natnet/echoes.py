"""Echoes on their way: which were asked, which were answered, which were lost."""

from collections import deque

from slidepipe.lab.camera_clock import CameraClock
from slidepipe.lab.natnet.messages import EchoResponse
from slidepipe.lab.protocols import ClockExchange

PATIENCE_NS = 1_000_000_000
"""An echo that is not answered after this long is lost."""


class Echoes:
    """Matches answers to questions.

    Parameters
    ----------
    ticks_per_s : float
        Rate of the server's clock.
    """

    def __init__(self, ticks_per_s: float = 1.0) -> None:
        self.clock = CameraClock(ticks_per_s)
        self.lost = 0
        self._asked: deque[int] = deque()
        self._done: deque[ClockExchange] = deque()

    def sent(self, stamp_ns: int) -> None:
        """Note that an echo was sent with this stamp."""
        self._asked.append(stamp_ns)
        while stamp_ns - self._asked[0] > PATIENCE_NS:
            self._asked.popleft()
            self.lost += 1

    def answered(self, response: EchoResponse, received_ns: int) -> None:
        """Note an answer; one to no question, or a second one, is ignored."""
        if response.client_stamp not in self._asked:
            return
        self._asked.remove(response.client_stamp)
        if received_ns >= response.client_stamp:
            exchange = ClockExchange(response.client_stamp, response.server_ticks, received_ns)
            self.clock.take(exchange)
            self._done.append(exchange)

    def next(self) -> ClockExchange | None:
        """Return the oldest exchange that was not told yet."""
        return self._done.popleft() if self._done else None
