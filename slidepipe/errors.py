"""Every error that slidepipe raises on purpose.

::

    SlidepipeError
    ├── InputError          a file or a value that was given is wrong            exit code 3
    ├── NotFoundError       no such run, reference or file                       exit code 4
    ├── StoreError          the run store is damaged or cannot be written        exit code 5
    │   └── NewerSchemaError    written by a newer slidepipe
    ├── BusyError           another process holds what is needed                 exit code 6
    ├── LabError            the arm, the gripper or the cameras failed           exit code 7
    │   └── PacketError         bytes from the wire that are no packet
    └── RefusedError        it was computed and the answer is no                 exit code 1
        ├── InfeasibleError     no motion within the limits: names them
        └── EstimationError     the recording does not tell what was asked

A message is one line: what, where (``file.yaml:14:9: object.mass_kg: ...``), what was got, what is allowed.
"""

import errno

UNWRITABLE = frozenset({errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EROFS, errno.EACCES, errno.EPERM, errno.EIO})
"""What a file system says that does not take what is written: foreseen, wherever it is said."""


class SlidepipeError(Exception):
    """Base of every error that slidepipe raises on purpose."""


class InputError(SlidepipeError):
    """A file or a value that was given is wrong; ``lines`` holds one message for each fault."""

    def __init__(self, *lines: str) -> None:
        super().__init__("\n".join(lines))
        self.lines = lines


class NotFoundError(SlidepipeError):
    """No such run, reference or file."""


class StoreError(SlidepipeError):
    """The run store is damaged, or cannot be read or written."""


class NewerSchemaError(StoreError):
    """The artifact was written by a newer slidepipe."""


class BusyError(SlidepipeError):
    """Another process holds what is needed."""


class LabError(SlidepipeError):
    """The arm, the gripper or the cameras failed."""


class PacketError(LabError):
    """Bytes that came over the wire are not the packet that they should be."""


class RefusedError(SlidepipeError):
    """It was computed and the answer is no; ``lines`` holds one reason each."""

    def __init__(self, *lines: str) -> None:
        super().__init__("\n".join(lines))
        self.lines = lines


class InfeasibleError(RefusedError):
    """No motion within the limits; each line names a limit, its value, its bound and the time."""


class EstimationError(RefusedError):
    """The recording does not tell what was asked."""
