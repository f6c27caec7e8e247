"""The watching side of the streamer: starts it, asks a person, looks after it, and turns Ctrl-C into a wish to stop."""

import os
from collections.abc import Callable
from dataclasses import dataclass
from multiprocessing import get_context
from multiprocessing.connection import Connection

from slidepipe.artifacts.recovery import await_written
from slidepipe.errors import LabError, RefusedError
from slidepipe.lab.desk import Progress, WatchDesk, shared_words
from slidepipe.stages.recording_process import FINISH_S
from slidepipe.stages.streamer import LOOK_S, Readiness, StreamJob, StreamOutcome, main

MARGIN_S = 30.0
"""How much longer than its course a streamer may take before it is given up."""


@dataclass(frozen=True, slots=True)
class Watch:
    """Who is asked before the arm moves, and told meanwhile.

    Attributes
    ----------
    confirm : Callable
        Whether the arm may move, given what was found.
    linked : Callable, optional
        Returns when a person has linked the arm; called where its program does not tell, and nothing moves until then.
    progress : Callable
        Told ten times a second.
    """

    confirm: Callable[[Readiness], bool]
    linked: Callable[[Readiness], None] | None
    progress: Callable[[Progress], None]


def stream(job: StreamJob, watch: Watch) -> StreamOutcome:
    """Stream in a process of its own, and watch it.

    Raises
    ------
    LabError
        The arm or the cameras do not answer, do not see what they should, or the streamer failed.
    RefusedError
        A person did not want the arm to move.
    """
    context = get_context("spawn")
    words, (ours, theirs) = shared_words(context), context.Pipe()
    process = context.Process(target=main, args=(job, words, theirs, os.getpid()), name="slidepipe-streamer")
    process.start()
    theirs.close()
    try:
        return _attend(ours, WatchDesk(words), watch)
    finally:
        WatchDesk(words).ask_to_stop()
        ours.close()
        process.join(job.lab.loop.stop_s + job.lab.loop.hold_s + MARGIN_S)
        if process.is_alive():
            process.kill()
            process.join()
        await_written(job.recording, FINISH_S)  # its recorder goes on for a moment where the streamer has died


def _attend(pipe: Connection, desk: WatchDesk, watch: Watch) -> StreamOutcome:
    found = _hear(pipe, MARGIN_S, lambda: None)
    if not isinstance(found, Readiness):
        raise LabError(f"streamer: unexpected word {found!r}")
    if not watch.confirm(found):
        raise RefusedError("execute: nobody wanted the arm to move, and it did not")
    pipe.send("go")
    patience_s = found.course_s + MARGIN_S
    try:
        if not found.tells_linked and watch.linked is not None:
            watch.linked(found)
        desk.let_go()
    except KeyboardInterrupt:
        desk.ask_to_stop()

    def look() -> None:
        progress = desk.look()
        if progress is not None:
            watch.progress(progress)

    outcome = _hear(pipe, patience_s + 60.0, look, desk.ask_to_stop)
    if not isinstance(outcome, StreamOutcome):
        raise LabError(f"streamer: unexpected word {outcome!r}")
    return outcome


def _hear(
    pipe: Connection, patience_s: float, look: Callable[[], None], interrupted: Callable[[], None] | None = None
) -> object:
    """Wait for the streamer's next word, looking after things meanwhile."""
    left = round(patience_s / LOOK_S)
    while left > 0:
        try:
            left -= 1
            if pipe.poll(LOOK_S):
                word = pipe.recv()
                if isinstance(word, BaseException):
                    raise word
                return word
            look()
        except EOFError:
            raise LabError("streamer: it has died") from None
        except KeyboardInterrupt:
            if interrupted is None:
                raise
            interrupted()
    raise LabError(f"streamer: not heard of for {patience_s:.0f} s")
