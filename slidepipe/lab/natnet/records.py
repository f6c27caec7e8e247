"""Records of pieces: the fields of a message, with the versions that have them."""

import struct
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from slidepipe.lab.natnet.version import OLDEST, NatNetVersion
from slidepipe.lab.natnet.wire import COUNT, Flat, Number, Piece, Reader


@dataclass(frozen=True, slots=True)
class Field:
    """A named piece of a record, from a version on, until before another; elsewhere it has its default."""

    name: str
    piece: Piece
    since: NatNetVersion = OLDEST
    before: NatNetVersion | None = None
    default: Any = None

    def there(self, version: NatNetVersion) -> bool:
        """Whether this version has it."""
        return version >= self.since and (self.before is None or version < self.before)


class Record(Piece):
    """Fields one after the other, as an object of a class that has them in this order.

    Parameters
    ----------
    kind : type
        What it is read as.
    fields : Field
    """

    __slots__ = ("_flats", "_leasts", "fields", "kind")

    def __init__(self, kind: type[Any], *fields: Field) -> None:
        self.kind, self.fields = kind, fields
        self._flats: dict[NatNetVersion, Flat | None] = {}
        self._leasts: dict[NatNetVersion, int] = {}

    def flat(self, version: NatNetVersion) -> Flat | None:
        """One structure, where all its fields are of fixed size."""
        if version not in self._flats:
            self._flats[version] = self._flatten(version)
        return self._flats[version]

    def least(self, version: NatNetVersion) -> int:
        """Sum over its fields."""
        if version not in self._leasts:
            there = (field.piece for field in self.fields if field.there(version))
            self._leasts[version] = sum(piece.least(version) for piece in there)
        return self._leasts[version]

    def read(self, reader: Reader) -> Any:
        """Read the fields that the version has."""
        flat = self.flat(reader.version)
        if flat is not None:
            return flat.make(reader.unpack(flat.form))
        version = reader.version
        return self.kind(
            *[field.piece.read(reader) if field.there(version) else field.default for field in self.fields]
        )

    def write(self, out: bytearray, value: Any, version: NatNetVersion) -> None:
        """Append the fields that the version has."""
        for field in self.fields:
            if field.there(version):
                field.piece.write(out, getattr(value, field.name), version)

    def _flatten(self, version: NatNetVersion) -> Flat | None:
        """Join the fields' structures; what is missing in this version is taken from a tail of defaults."""
        numbers = [field.piece for field in self.fields if field.there(version)]
        codes = [f"{piece.count or ''}{piece.code}" for piece in numbers if isinstance(piece, Number)]
        if len(codes) < len(numbers):
            return None
        cuts: list[int | slice] = []
        defaults: list[Any] = []
        at, total = 0, sum(piece.count or 1 for piece in numbers if isinstance(piece, Number))
        for field in self.fields:
            if field.there(version) and isinstance(field.piece, Number):
                count = field.piece.count
                cuts.append(slice(at, at + count) if count else at)
                at += count or 1
            else:
                cuts.append(total + len(defaults))
                defaults.append(field.default)
        return Flat(struct.Struct("<" + "".join(codes)), _maker(self.kind, tuple(cuts), tuple(defaults)))


def _maker(
    kind: type[Any], cuts: tuple[int | slice, ...], defaults: tuple[Any, ...]
) -> Callable[[tuple[Any, ...]], Any]:
    def make(numbers: tuple[Any, ...]) -> Any:
        values = numbers + defaults
        return kind(*[values[cut] for cut in cuts])

    return make


class Columns(Record):
    """A count, then each field of that many records, one field after the other."""

    __slots__ = ()

    def flat(self, version: NatNetVersion) -> None:  # its size varies
        """None: its size varies."""

    def least(self, version: NatNetVersion) -> int:  # noqa: ARG002  # the count alone
        """Read the count."""
        return 4

    def read(self, reader: Reader) -> tuple[Any, ...]:
        """Read the records."""
        version = reader.version
        count = reader.count(super().least(version))
        columns = [
            field.piece.read_many(reader, count) if field.there(version) else (field.default,) * count
            for field in self.fields
        ]
        return tuple(self.kind(*values) for values in zip(*columns, strict=True))

    def write(self, out: bytearray, value: tuple[Any, ...], version: NatNetVersion) -> None:
        """Append the records."""
        out += COUNT.pack(len(value))
        for field in self.fields:
            if field.there(version):
                for one in value:
                    field.piece.write(out, getattr(one, field.name), version)
