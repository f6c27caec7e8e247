"""What the streamer shows while it runs, and what it is asked to do: a few words of memory that two processes share."""

import os
from dataclasses import dataclass
from multiprocessing.context import SpawnContext
from typing import Any

import numpy as np

from slidepipe.lab.course import Phase
from slidepipe.lab.loop import Tick
from slidepipe.lab.safety import StopCause

PHASES = tuple(Phase)
_STOP, _GO, _PHASE, _TICKS, _DONE, _ERROR, _LATE, _FRAMES, _TIME = range(9)
_WORDS = 16


@dataclass(frozen=True, slots=True)
class Progress:
    """How far an execution is.

    Attributes
    ----------
    phase : Phase
    done : float
        Share of the course.
    tracking_error_rad : float
        Largest of a joint since the last look.
    late_s : float
        Largest lateness of a tick since the last look.
    ticks, frames : int
        So far.
    time_s : float
        Since the first tick.
    """

    phase: Phase
    done: float
    tracking_error_rad: float
    late_s: float
    ticks: int
    frames: int
    time_s: float


def shared_words(context: SpawnContext) -> Any:
    """Make the memory; it may be handed to a process that is started."""
    return context.RawArray("d", _WORDS)


class StreamDesk:
    """The streamer's side: implements the loop's ``Desk``. A parent that is gone counts as a wish to stop."""

    def __init__(self, words: Any, parent: int) -> None:
        self._words, self._parent = np.frombuffer(words), parent
        self._first_ns = 0

    @property
    def wish(self) -> StopCause | None:
        """Why the arm shall stop: somebody wants it, or nobody is there any more."""
        if self._words[_STOP]:
            return StopCause.OPERATOR
        return StopCause.ALONE if os.getppid() != self._parent else None

    @property
    def go(self) -> bool:
        """Whether the arm may leave the pose in which it was linked."""
        return bool(self._words[_GO])

    def show(self, tick: Tick) -> None:
        """Write a tick's figures down."""
        words, stamp_ns = self._words, tick.state.stamp_ns
        if not self._first_ns:
            self._first_ns = stamp_ns
        words[_PHASE] = PHASES.index(tick.phase)
        words[_DONE] = tick.done
        words[_ERROR] = max(words[_ERROR], np.abs(tick.commanded.position_rad - tick.state.position_rad).max())
        words[_LATE] = max(words[_LATE], 1e-9 * tick.late_ns)
        words[_FRAMES] = tick.frames
        words[_TIME] = 1e-9 * (stamp_ns - self._first_ns)
        words[_TICKS] += 1


class WatchDesk:
    """The other side: reads the figures, and says stop or go."""

    def __init__(self, words: Any) -> None:
        self._words = np.frombuffer(words)

    def ask_to_stop(self) -> None:
        """Have the arm stopped along its path."""
        self._words[_STOP] = 1.0

    def let_go(self) -> None:
        """Let the arm leave the pose in which it was linked."""
        self._words[_GO] = 1.0

    def look(self) -> Progress | None:
        """Read the figures; None before the first tick."""
        words = self._words
        if not words[_TICKS]:
            return None
        progress = Progress(
            phase=PHASES[int(words[_PHASE])],
            done=float(words[_DONE]),
            tracking_error_rad=float(words[_ERROR]),
            late_s=float(words[_LATE]),
            ticks=int(words[_TICKS]),
            frames=int(words[_FRAMES]),
            time_s=float(words[_TIME]),
        )
        words[_ERROR] = words[_LATE] = 0.0
        return progress
