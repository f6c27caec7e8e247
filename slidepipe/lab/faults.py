"""What can go wrong in a laboratory, on request: the emulator does it at a time and strength that are asked for."""

import heapq
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Generic, TypeVar

import numpy as np

from slidepipe.errors import InputError
from slidepipe.lab.clock import TICK_NS

Thing = TypeVar("Thing")
FOREVER_S = 1e9


class FaultKind(Enum):
    """Faults, and what their strength means; the time counts from when the arm was linked last."""

    LOSS = "loss"
    """Share of datagrams that get lost, of the arm's link both ways and of the cameras' frames."""
    DUPLICATION = "duplication"
    """Share of datagrams that arrive twice."""
    REORDERING = "reordering"
    """Share of datagrams that arrive after two that were sent later."""
    JITTER = "jitter"
    """Mean of an exponential delay of every datagram, s; they stay in order."""
    OCCLUSION = "occlusion"
    """Share of frames in which the object is not seen."""
    BLINDNESS = "blindness"
    """Share of frames in which neither body is seen."""
    SWAP = "swap"
    """Share of frames in which hand and object are taken for each other; they come in stretches of 20."""
    DRIFT = "drift"
    """Parts per million by which the cameras' clock is fast."""
    FREEZE = "freeze"
    """For how long the cameras send the same frame again and again, s."""
    STALL = "stall"
    """For how long the arm stays where it is, s."""
    UNLINK = "unlink"
    """For how long no datagram gets through at all, s."""


SHARES = frozenset(
    {
        FaultKind.LOSS,
        FaultKind.DUPLICATION,
        FaultKind.REORDERING,
        FaultKind.OCCLUSION,
        FaultKind.BLINDNESS,
        FaultKind.SWAP,
    }
)
SPELLS = frozenset({FaultKind.FREEZE, FaultKind.STALL, FaultKind.UNLINK})
"""Faults whose strength is how long they last."""
STRETCH = 20
"""Frames in which the bodies stay swapped."""
LATE_NS = round(2.5 * TICK_NS)


@dataclass(frozen=True, slots=True)
class Fault:
    """One fault: how strong, from when, in s after the arm was linked."""

    kind: FaultKind
    strength: float
    start_s: float = 0.0

    def __post_init__(self) -> None:
        top = 1.0 if self.kind in SHARES else FOREVER_S
        if not 0.0 <= self.strength <= top:
            raise InputError(f"fault {self.kind.value}: its strength must be from 0 to {top:g}, got {self.strength!r}")
        if not self.start_s >= 0.0:
            raise InputError(f"fault {self.kind.value}: it must begin at 0 s or later, got {self.start_s!r}")

    @classmethod
    def parse(cls, text: str) -> "Fault":
        """Read ``KIND=STRENGTH`` or ``KIND=STRENGTH@START``.

        Examples
        --------
        >>> Fault.parse("loss=0.1@2")
        Fault(kind=<FaultKind.LOSS: 'loss'>, strength=0.1, start_s=2.0)
        """
        name, _, rest = text.partition("=")
        strength, _, start = rest.partition("@")
        kinds = {kind.value: kind for kind in FaultKind}
        try:
            return cls(kinds[name.strip()], float(strength), float(start or 0.0))
        except (KeyError, ValueError):
            raise InputError(
                f"fault {text!r}: must read KIND=STRENGTH or KIND=STRENGTH@START_S, KIND one of {', '.join(kinds)}"
            ) from None


class FaultClock:
    """Which faults are there at a time; before the arm is linked there are none, but for a clock that drifts."""

    def __init__(self, faults: Sequence[Fault] = ()) -> None:
        self._faults, self._since_ns = tuple(faults), -1

    def begin(self, now_ns: int) -> None:
        """Count from now on."""
        self._since_ns = now_ns

    def strength(self, kind: FaultKind, now_ns: int) -> float:
        """How strong a fault is now; 0 where it is not there."""
        if self._since_ns < 0:
            return 0.0
        time_s, strongest = 1e-9 * (now_ns - self._since_ns), 0.0
        for fault in self._faults:
            lasts_s = fault.strength if kind in SPELLS else FOREVER_S
            if fault.kind is kind and fault.start_s <= time_s < fault.start_s + lasts_s:
                strongest = max(strongest, fault.strength)
        return strongest

    @property
    def drift_ppm(self) -> float:
        """By how much the cameras' clock is fast, always."""
        return sum(fault.strength for fault in self._faults if fault.kind is FaultKind.DRIFT)


class Channel(Generic[Thing]):
    """A way on which datagrams get lost, doubled, late, or out of order."""

    def __init__(self, faults: FaultClock, random: np.random.Generator) -> None:
        self._faults, self._random = faults, random
        self._waiting: list[tuple[int, int, Thing]] = []
        self._count = self._last_ns = 0

    def put(self, thing: Thing, now_ns: int) -> None:
        """Send a thing."""
        if self._happens(FaultKind.LOSS, now_ns) or self._faults.strength(FaultKind.UNLINK, now_ns):
            return
        jitter_s = self._faults.strength(FaultKind.JITTER, now_ns)
        due_ns = now_ns + round(1e9 * self._random.exponential(jitter_s)) if jitter_s else now_ns
        due_ns = self._last_ns = max(due_ns, self._last_ns)
        if self._happens(FaultKind.REORDERING, now_ns):
            due_ns += LATE_NS
        for _ in range(2 if self._happens(FaultKind.DUPLICATION, now_ns) else 1):
            self._count += 1
            heapq.heappush(self._waiting, (due_ns, self._count, thing))

    def take(self, now_ns: int) -> list[Thing]:
        """Things that have arrived by now."""
        arrived = []
        while self._waiting and self._waiting[0][0] <= now_ns:
            arrived.append(heapq.heappop(self._waiting)[2])
        return arrived

    def _happens(self, kind: FaultKind, now_ns: int) -> bool:
        share = self._faults.strength(kind, now_ns)
        return share > 0.0 and self._random.random() < share
