"""Datagrams to messages and back, without any I/O."""

import struct
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from slidepipe.errors import PacketError
from slidepipe.lab.natnet import layouts
from slidepipe.lab.natnet import messages as m
from slidepipe.lab.natnet.models import ModelDef
from slidepipe.lab.natnet.records import Record
from slidepipe.lab.natnet.version import NatNetVersion
from slidepipe.lab.natnet.wire import Reader, check_version

Message = (
    m.Connect
    | m.Discovery
    | m.ServerInfo
    | m.Request
    | m.Response
    | m.ModelDefRequest
    | ModelDef
    | m.FrameRequest
    | m.Frame
    | m.MessageString
    | m.Disconnect
    | m.KeepAlive
    | m.EchoRequest
    | m.EchoResponse
    | m.Unrecognized
)
MAX_PAYLOAD = 65_503
"""A UDP datagram over IPv4 holds no more than this and the header."""
_HEADER = struct.Struct("<HH")
_I32 = struct.Struct("<i")
_END = bytes(4)
"""What closes a frame."""


def encode(message: Message, version: NatNetVersion) -> bytes:
    """Datagram of a message.

    Raises
    ------
    PacketError
        The version is not spoken, a value does not fit its field, or the message does not fit a datagram.

    Examples
    --------
    >>> encode(m.KeepAlive(), NatNetVersion(4, 1)).hex()
    '0a000000'
    """
    check_version(version)
    kind = _BY_TYPE[type(message)]
    body = bytearray()
    kind.write(body, message, version)
    if len(body) > MAX_PAYLOAD:
        raise PacketError(f"{type(message).__name__}: {len(body)} bytes do not fit a datagram of {MAX_PAYLOAD}")
    return _HEADER.pack(kind.number, len(body)) + bytes(body)


def decode(data: bytes, version: NatNetVersion) -> Message:
    """Message of a datagram; bytes after the stated length are ignored, as clients send one too many.

    Raises
    ------
    PacketError
        The version is not spoken, or the bytes are no such message.

    Examples
    --------
    >>> decode(bytes.fromhex("0d0010004e669a10000000000485e4cd49010000"), NatNetVersion(3, 0))
    EchoResponse(client_stamp=278554190, server_ticks=1416498545924)
    """
    check_version(version)
    if len(data) < _HEADER.size:
        raise PacketError(f"{len(data)} bytes are no packet, a header has {_HEADER.size}")
    number, size = _HEADER.unpack_from(data)
    body = data[_HEADER.size : _HEADER.size + size]
    if len(body) < size:
        raise PacketError(f"message {number}: {size} bytes are stated, {len(body)} are there")
    if number not in _BY_NUMBER:
        raise PacketError(f"message {number}: there is no such message")
    message: Message = _BY_NUMBER[number].read(Reader(bytes(body), version))
    return message


@dataclass(frozen=True, slots=True)
class _Kind:
    """One kind of message on the wire."""

    number: int
    type: type[Any]
    read: Callable[[Reader], Any]
    write: Callable[[bytearray, Any, NatNetVersion], None]


def _greeting(number: int, kind: type[m.Greeting]) -> _Kind:
    """Greetings come with 0, 5, 264, 270 or 271 bytes: what is missing is zero."""
    record = Record(kind, *layouts.GREETING)

    def read(reader: Reader) -> m.Greeting:
        padded = reader.data[: layouts.GREETING_BYTES].ljust(layouts.GREETING_BYTES, b"\0")
        greeting: m.Greeting = record.read(Reader(padded, reader.version))
        return greeting

    def write(out: bytearray, value: m.Greeting, version: NatNetVersion) -> None:
        record.write(out, value, version)
        out += b"\0"

    return _Kind(number, kind, read, write)


def _empty(number: int, kind: type[Any]) -> _Kind:
    return _Kind(number, kind, lambda _reader: kind(), lambda _out, _value, _version: None)


def _words(number: int, kind: type[m.Words]) -> _Kind:
    """Words up to a zero byte, or to the end."""

    def read(reader: Reader) -> m.Words:
        return kind(_text(reader.data))

    return _Kind(number, kind, read, lambda out, value, version: layouts.TEXT.write(out, value.text, version))


def _of_record(number: int, record: Record) -> _Kind:
    return _Kind(number, record.kind, record.read, record.write)


def _read_response(reader: Reader) -> m.Response:
    """Four bytes are a number, all else is words."""
    if reader.remaining == _I32.size:
        return m.Response(int(reader.unpack(_I32)[0]))
    return m.Response(_text(reader.data))


def _write_response(out: bytearray, value: m.Response, version: NatNetVersion) -> None:
    if isinstance(value.value, int):
        layouts.I32.write(out, value.value, version)
    else:
        layouts.TEXT.write(out, value.value, version)


def _read_frame(reader: Reader) -> m.Frame:
    frame: m.Frame = layouts.FRAME.read(reader)
    end = reader.take(len(_END))
    if end != _END or reader.remaining:
        raise PacketError(f"frame {frame.number}: does not end as a frame of NatNet {reader.version}")
    return frame


def _write_frame(out: bytearray, value: m.Frame, version: NatNetVersion) -> None:
    layouts.FRAME.write(out, value, version)
    out += _END


def _text(data: bytes) -> str:
    return data.partition(b"\0")[0].decode("utf-8", "replace")


_KINDS = (
    _greeting(0, m.Connect),
    _of_record(1, layouts.SERVER_INFO),
    _words(2, m.Request),
    _Kind(3, m.Response, _read_response, _write_response),
    _empty(4, m.ModelDefRequest),
    _of_record(5, layouts.MODEL_DEF),
    _empty(6, m.FrameRequest),
    _Kind(7, m.Frame, _read_frame, _write_frame),
    _words(8, m.MessageString),
    _empty(9, m.Disconnect),
    _empty(10, m.KeepAlive),
    _of_record(12, layouts.ECHO_REQUEST),
    _of_record(13, layouts.ECHO_RESPONSE),
    _greeting(14, m.Discovery),
    _empty(100, m.Unrecognized),
)
_BY_NUMBER = {kind.number: kind for kind in _KINDS}
_BY_TYPE = {kind.type: kind for kind in _KINDS}
