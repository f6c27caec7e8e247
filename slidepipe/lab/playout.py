"""Which command the arm's program follows in a tick: the last that came, or the one whose turn it is."""

from typing import Protocol

from slidepipe.lab.wam_codec import Order

DELAY_TICKS = 3
"""Numbered commands are followed so many ticks after they came: what is later than that counts as lost."""
STRANGE = 1000
"""A number so far from the one that is due begins a new stream."""
LATE_IN_A_ROW = 5
"""After so many late ones the stream itself is later than it was, and is followed later."""


class Playout(Protocol):
    """Takes commands as they come and gives one a tick."""

    def put(self, order: Order) -> None:
        """Take a command that has arrived."""

    def take(self) -> Order | None:
        """Give the command of the tick that begins; None where there is none."""


class LastWins:
    """For dialects without numbers: of a tick's datagrams, the last one."""

    def __init__(self) -> None:
        self._order: Order | None = None

    def put(self, order: Order) -> None:
        """Take a command that has arrived."""
        self._order = order

    def take(self) -> Order | None:
        """Give the last one since the tick before."""
        order, self._order = self._order, None
        return order


class InTurn:
    """For numbered commands: each a fixed time after its own tick, whatever the network and the host did to it.

    Duplicates and wrong order do no harm then, nor does lateness up to :data:`DELAY_TICKS`.
    """

    def __init__(self, delay_ticks: int = DELAY_TICKS) -> None:
        self._delay, self._late = delay_ticks, 0
        self._due: int | None = None
        self._waiting: dict[int, Order] = {}

    def put(self, order: Order) -> None:
        """Take a command that has arrived."""
        number = -1 if order.stamp is None else order.stamp.sequence
        due = self._due
        if due is None or abs(number - due) > STRANGE:
            due = self._begin(number)
        self._late = self._late + 1 if number < due else 0
        if self._late > LATE_IN_A_ROW:
            due = self._begin(number)
        if number >= due:
            self._waiting[number] = order

    def take(self) -> Order | None:
        """Give the command whose turn it is."""
        if self._due is None:
            return None
        order = self._waiting.pop(self._due, None)
        self._due += 1
        return order

    def _begin(self, number: int) -> int:
        self._due, self._late = number - self._delay, 0
        self._waiting.clear()
        return self._due
