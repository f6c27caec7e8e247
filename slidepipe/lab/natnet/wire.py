"""Pieces of which packets are made: each knows how it is read from bytes and written to them.

One description serves both ways and all versions. No count is believed that could not fit into what remains of the
packet, so that nothing bigger than a small multiple of the packet is ever allocated.
"""

import struct
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from operator import itemgetter
from typing import Any

from slidepipe.errors import PacketError
from slidepipe.lab.natnet.version import NEWEST, OLDEST, NatNetVersion

SIZED_SINCE = NatNetVersion(4, 1)
"""From this version on, lists and descriptions state their length in bytes."""
COUNT = struct.Struct("<i")
"""How many things follow."""


class Reader:
    """Bytes, and how far they are read."""

    __slots__ = ("data", "offset", "version")

    def __init__(self, data: bytes, version: NatNetVersion) -> None:
        self.data, self.offset, self.version = data, 0, version

    @property
    def remaining(self) -> int:
        """Bytes that are not read yet."""
        return len(self.data) - self.offset

    def take(self, count: int) -> bytes:
        """Read that many bytes."""
        if not 0 <= count <= self.remaining:
            raise PacketError(f"byte {self.offset}: {count} more bytes are needed, {self.remaining} are there")
        self.offset += count
        return self.data[self.offset - count : self.offset]

    def unpack(self, form: struct.Struct) -> tuple[Any, ...]:
        """Read a structure."""
        return form.unpack(self.take(form.size))

    def count(self, least: int) -> int:
        """Read how many things follow of at least so many bytes each; no more than can be there."""
        at = self.offset
        (count,) = self.unpack(COUNT)
        if not 0 <= count * least <= self.remaining:
            raise PacketError(f"byte {at}: {count} items of {least} bytes or more cannot be in {self.remaining} bytes")
        return int(count)


@dataclass(frozen=True, slots=True)
class Flat:
    """Something of fixed size: its structure, and what its numbers become."""

    form: struct.Struct
    make: Callable[[tuple[Any, ...]], Any]


class Piece(ABC):
    """One piece of a packet."""

    __slots__ = ()

    def flat(self, version: NatNetVersion) -> Flat | None:  # noqa: ARG002  # for those of fixed size
        """How it is read in one go; None where its size varies."""
        return None

    @abstractmethod
    def least(self, version: NatNetVersion) -> int:
        """Fewest bytes that it takes."""

    @abstractmethod
    def read(self, reader: Reader) -> Any:
        """Read one."""

    @abstractmethod
    def write(self, out: bytearray, value: Any, version: NatNetVersion) -> None:
        """Append one."""

    def read_many(self, reader: Reader, count: int) -> tuple[Any, ...]:
        """Read that many, one after the other."""
        flat = self.flat(reader.version)
        if flat is None:
            return tuple(self.read(reader) for _ in range(count))
        return tuple(map(flat.make, flat.form.iter_unpack(reader.take(count * flat.form.size))))


@dataclass(frozen=True, slots=True)
class Number(Piece):
    """A number, or with a count a tuple of numbers; ``code`` as struct knows it."""

    code: str
    count: int = 0

    def flat(self, version: NatNetVersion) -> Flat:  # noqa: ARG002  # the same in every version
        """One structure."""
        return _number(self.code, self.count)

    def least(self, version: NatNetVersion) -> int:
        """Its size."""
        return self.flat(version).form.size

    def read(self, reader: Reader) -> Any:
        """Read a number or a tuple."""
        flat = self.flat(reader.version)
        return flat.make(reader.unpack(flat.form))

    def write(self, out: bytearray, value: Any, version: NatNetVersion) -> None:
        """Append it; a number that does not fit is an error."""
        values = value if self.count else (value,)
        try:
            out += self.flat(version).form.pack(*values)
        except (struct.error, OverflowError) as error:
            raise PacketError(f"{value!r} cannot be sent as <{self.count or ''}{self.code}: {error}") from None


@cache
def _number(code: str, count: int) -> Flat:
    form = struct.Struct(f"<{count or ''}{code}")
    return Flat(form, tuple if count else itemgetter(0))


class Text(Piece):
    """Words that a zero byte ends."""

    __slots__ = ()

    def least(self, version: NatNetVersion) -> int:  # noqa: ARG002  # the same in every version
        """Read the zero byte at least."""
        return 1

    def read(self, reader: Reader) -> str:
        """Read up to the zero byte."""
        end = reader.data.find(b"\0", reader.offset)
        if end < 0:
            raise PacketError(f"byte {reader.offset}: a text begins here that nothing ends")
        text = reader.take(end - reader.offset)
        reader.offset += 1
        return text.decode("utf-8", "replace")

    def write(self, out: bytearray, value: str, version: NatNetVersion) -> None:  # noqa: ARG002  # as above
        """Append the words and a zero byte."""
        data = value.encode()
        if 0 in data:
            raise PacketError(f"{value!r} cannot be sent: it holds a zero byte")
        out += data + b"\0"


@dataclass(frozen=True, slots=True)
class Name(Piece):
    """Words in a field of fixed size; what follows their zero byte is garbage."""

    size: int

    def least(self, version: NatNetVersion) -> int:  # noqa: ARG002  # the same in every version
        """Its size."""
        return self.size

    def read(self, reader: Reader) -> str:
        """Read the field, keep the words."""
        return reader.take(self.size).partition(b"\0")[0].decode("utf-8", "replace")

    def write(self, out: bytearray, value: str, version: NatNetVersion) -> None:  # noqa: ARG002  # as above
        """Append the words, filled up with zeros."""
        data = value.encode()
        if len(data) >= self.size or 0 in data:
            raise PacketError(
                f"{value[:40]!r} cannot be sent: it must be shorter than {self.size} bytes, without zeros"
            )
        out += data.ljust(self.size, b"\0")


@dataclass(frozen=True, slots=True)
class Many(Piece):
    """A count and that many pieces; ``sized`` lists state their bytes as well in the versions that do."""

    item: Piece
    sized: bool = False

    def least(self, version: NatNetVersion) -> int:
        """Read the count, and the size where there is one."""
        return 8 if self._states_size(version) else 4

    def read(self, reader: Reader) -> tuple[Any, ...]:
        """Read the count and the pieces.

        The stated size is not held against the pieces, only against the packet: the end of the packet tells more.
        """
        count = reader.count(self.item.least(reader.version))
        if self._states_size(reader.version):
            reader.count(1)
        return self.item.read_many(reader, count) if count else ()

    def write(self, out: bytearray, value: tuple[Any, ...], version: NatNetVersion) -> None:
        """Append the count, the size and the pieces."""
        items = bytearray()
        for one in value:
            self.item.write(items, one, version)
        out += COUNT.pack(len(value))
        if self._states_size(version):
            out += COUNT.pack(len(items))
        out += items

    def _states_size(self, version: NatNetVersion) -> bool:
        return self.sized and version >= SIZED_SINCE


def check_version(version: NatNetVersion) -> None:
    """Refuse a version that is not spoken."""
    if not OLDEST <= version <= NEWEST:
        raise PacketError(f"NatNet {version}: is not spoken, from {OLDEST} to {NEWEST} is")
