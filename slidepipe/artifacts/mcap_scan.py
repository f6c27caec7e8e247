"""Reads an MCAP file record by record, as far as it is sound, and says where and how it is not."""

import io
import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field

import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Chunk, DataEnd, Footer, Metadata, Schema

MAGIC = b"\x89MCAP0\r\n"

MAX_CHUNK_BYTES = 64 * 2**20
"""Largest chunk that is unpacked; ours have 64 KiB."""

_HEAD = struct.Struct("<BQ")
_MESSAGE = struct.Struct("<HIQQ")
_DAMAGE = (McapError, zstandard.ZstdError, struct.error, ValueError, OverflowError)


@dataclass(slots=True)
class Topic:
    """Messages of one topic in the order of the file; ``definition`` is its schema as the file holds it."""

    schema: str
    definition: bytes = b""
    log_ns: list[int] = field(default_factory=list)
    publish_ns: list[int] = field(default_factory=list)
    sequence: list[int] = field(default_factory=list)
    payload: list[bytes] = field(default_factory=list)


@dataclass(slots=True)
class Scan:
    """What is in a file.

    Attributes
    ----------
    metadata, attachments : dict
        By name.
    topics : dict
        Topics that were announced, with or without messages.
    messages : int
        Messages that can be read.
    fault : str or None
        First damage: the byte, and what is wrong there.
    """

    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    attachments: dict[str, bytes] = field(default_factory=dict)
    topics: dict[str, Topic] = field(default_factory=dict)
    messages: int = 0
    fault: str | None = None

    def blame(self, offset: int, what: str) -> None:
        """Note damage, the first one only."""
        self.fault = self.fault or f"byte {offset}: {what}"


def scan(data: bytes) -> Scan:
    """Read the bytes of an MCAP file that begins with :data:`MAGIC`; what is damaged is passed over and noted."""
    found, tables = Scan(), _Tables()
    data_end = None
    for offset, opcode, body in _records(data, found):
        try:
            if opcode == Opcode.METADATA:
                metadata = Metadata.read(_stream(body))
                found.metadata[metadata.name] = metadata.metadata
            elif opcode == Opcode.ATTACHMENT:
                attachment = Attachment.read(_stream(body))
                found.attachments[attachment.name] = attachment.data
            elif opcode == Opcode.CHUNK:
                tables.take_all(_unpacked(body))
            elif opcode == Opcode.DATA_END:
                data_end = offset
                _check(DataEnd.read(_stream(body)).data_section_crc, data[:offset])
            elif opcode == Opcode.FOOTER:
                _check_footer(Footer.read(_stream(body)), data, offset, data_end)
            else:
                tables.take(opcode, body)
        except _DAMAGE as error:
            found.blame(offset, f"damaged {_name(opcode)}, {error or 'it cannot be read'}")
    tables.sort_into(found)
    return found


@dataclass(slots=True)
class _Tables:
    """Schemas, channels and messages as they come; they may come in any order."""

    schemas: dict[int, Schema] = field(default_factory=dict)
    channels: dict[int, Channel] = field(default_factory=dict)
    columns: dict[int, Topic] = field(default_factory=dict)

    def take(self, opcode: int, body: bytes) -> None:
        if opcode == Opcode.MESSAGE:
            self._message(body, 0, len(body))
        elif opcode == Opcode.SCHEMA:
            schema = Schema.read(_stream(body))
            self.schemas[schema.id] = schema
        elif opcode == Opcode.CHANNEL:
            channel = Channel.read(_stream(body))
            self.channels.setdefault(channel.id, channel)

    def take_all(self, chunk: bytes) -> None:
        """Take the records of an unpacked chunk; of messages, which are many, only the head is looked at."""
        offset, end = 0, len(chunk)
        while offset < end:
            opcode, length = _HEAD.unpack_from(chunk, offset)
            start, offset = offset + _HEAD.size, offset + _HEAD.size + length
            if offset > end:
                raise ValueError("a record runs past its end")
            if opcode == Opcode.MESSAGE:
                self._message(chunk, start, offset)
            else:
                self.take(opcode, chunk[start:offset])

    def _message(self, data: bytes, start: int, stop: int) -> None:
        channel, sequence, log_ns, publish_ns = _MESSAGE.unpack_from(data, start)
        column = self.columns.get(channel)
        if column is None:
            column = self.columns[channel] = Topic("")
        column.log_ns.append(log_ns)
        column.publish_ns.append(publish_ns)
        column.sequence.append(sequence)
        column.payload.append(data[start + _MESSAGE.size : stop])

    def sort_into(self, found: Scan) -> None:
        found.messages = sum(len(column.payload) for column in self.columns.values())
        for number, channel in self.channels.items():
            column = self.columns.get(number, Topic(""))
            schema = self.schemas.get(channel.schema_id)
            if schema is not None:
                column.schema, column.definition = schema.name, schema.data
            found.topics[channel.topic] = column


def _records(data: bytes, found: Scan) -> Iterator[tuple[int, int, bytes]]:
    """Byte, opcode and body of each record, none of which can be longer than the file."""
    offset, opcode = len(MAGIC), 0
    while opcode != Opcode.FOOTER:
        if offset == len(data):
            found.blame(offset, "the file ends here and was never closed")
            return
        body_at = offset + _HEAD.size
        opcode, length = _HEAD.unpack_from(data, offset) if body_at <= len(data) else (0, len(data))
        if body_at + length > len(data):
            found.blame(offset, f"cut off inside the record that begins here, {len(data)} bytes are there")
            return
        yield offset, opcode, data[body_at : body_at + length]
        offset = body_at + length
    if data[offset:] != MAGIC:
        found.blame(offset, "cut off before the closing mark")


def _unpacked(body: bytes) -> bytes:
    """Records of a chunk; ValueError where its checksum does not match, before anything big is unpacked."""
    chunk = Chunk.read(_stream(body))
    if chunk.compression not in ("", "zstd"):
        raise ValueError(f"compression {chunk.compression!r} is not read, only zstd")
    size = zstandard.frame_content_size(chunk.data) if chunk.compression else len(chunk.data)
    if size != chunk.uncompressed_size or size > MAX_CHUNK_BYTES:
        raise ValueError(f"{size} bytes do not match the size that it states")
    plain = zstandard.decompress(chunk.data) if chunk.compression else chunk.data
    _check(chunk.uncompressed_crc, plain)
    return plain


def _check_footer(footer: Footer, data: bytes, offset: int, data_end: int | None) -> None:
    if data_end is None:
        raise ValueError("the mark that ends the data is missing")
    if footer.summary_start:
        _check(footer.summary_crc, data[footer.summary_start : offset + _HEAD.size + 16])


def _check(crc: int, data: bytes) -> None:
    """Compare a checksum, where there is one."""
    if crc not in (0, zlib.crc32(data)):
        raise ValueError("the checksum does not match")


def _stream(body: bytes) -> ReadDataStream:
    return ReadDataStream(io.BytesIO(body))


def _name(opcode: int) -> str:
    return Opcode(opcode).name.lower().replace("_", " ")
