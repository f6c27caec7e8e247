"""Versions of the NatNet bitstream: what a packet holds depends on it."""

from typing import NamedTuple

from slidepipe.errors import PacketError


class NatNetVersion(NamedTuple):
    """Major and minor number of a bitstream; a tuple, as it is compared with in every field that is read.

    Examples
    --------
    >>> NatNetVersion.parse("2.11") > NatNetVersion(2, 9)
    True
    >>> str(NatNetVersion(4, 1))
    '4.1'
    """

    major: int
    minor: int

    @classmethod
    def parse(cls, text: str) -> "NatNetVersion":
        """Read ``major.minor``; what follows a further dot is ignored.

        Raises
        ------
        PacketError
            The text is no version.
        """
        numbers = text.split(".")
        if len(numbers) < 2 or not all(
            number.isdecimal() and number.isascii() and len(number) < 4 for number in numbers
        ):
            raise PacketError(f"NatNet version: must be major.minor, got {text[:40]!r}")
        return cls(int(numbers[0]), int(numbers[1]))

    def __str__(self) -> str:
        return f"{self.major}.{self.minor}"


OLDEST, NEWEST = NatNetVersion(2, 5), NatNetVersion(4, 1)
"""The versions that the codec speaks."""
