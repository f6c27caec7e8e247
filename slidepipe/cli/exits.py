"""What the exit codes mean, and which error ends with which."""

from enum import IntEnum

from slidepipe.errors import (
    BusyError,
    InputError,
    LabError,
    NotFoundError,
    RefusedError,
    SlidepipeError,
    StoreError,
)


class ExitCode(IntEnum):
    """How a command ended."""

    OK = 0
    NO = 1
    """It ran, and the answer is no: refused, lost, or not converged."""
    USAGE = 2
    INPUT = 3
    NOT_FOUND = 4
    STORE = 5
    BUSY = 6
    LAB = 7
    INTERRUPTED = 130
    BROKEN_PIPE = 141


OF_ERROR: tuple[tuple[type[SlidepipeError], ExitCode], ...] = (
    (InputError, ExitCode.INPUT),
    (NotFoundError, ExitCode.NOT_FOUND),
    (StoreError, ExitCode.STORE),
    (BusyError, ExitCode.BUSY),
    (LabError, ExitCode.LAB),
    (RefusedError, ExitCode.NO),
)
"""Every branch of the tree of errors."""

MEANINGS = {
    ExitCode.OK: "done",
    ExitCode.NO: "it ran, and the answer is no",
    ExitCode.USAGE: "wrong usage",
    ExitCode.INPUT: "a file or a value that was given is wrong",
    ExitCode.NOT_FOUND: "no such run or file",
    ExitCode.STORE: "the run store is damaged, not writable, or of a newer slidepipe",
    ExitCode.BUSY: "another process holds what is needed",
    ExitCode.LAB: "the arm, the gripper or the cameras failed",
    ExitCode.INTERRUPTED: "Ctrl-C",
}
"""What help says of each code, where a command has nothing better to say."""


def exit_code(error: SlidepipeError) -> ExitCode:
    """Code that a command ends with after this error.

    Examples
    --------
    >>> from slidepipe.errors import NewerSchemaError
    >>> exit_code(NewerSchemaError("a.yaml:1:1: schema: slidepipe.plan/9 was written by a newer slidepipe"))
    <ExitCode.STORE: 5>
    """
    return next((code for kind, code in OF_ERROR if isinstance(error, kind)), ExitCode.NO)
