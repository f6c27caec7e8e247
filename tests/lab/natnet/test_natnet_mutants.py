"""Packets with damage of every kind: each is read or refused, at once, and with little memory."""

import random
import signal
import struct
import tracemalloc
from collections.abc import Iterator

from natnet_samples import ASSET, MESSAGES, MODELS, PACKETS, VERSIONS

from slidepipe.errors import PacketError
from slidepipe.lab.natnet.codec import decode, encode
from slidepipe.lab.natnet.models import ModelDef
from slidepipe.lab.natnet.version import NatNetVersion

MUTANTS = 200_000
MEASURED = 4000
MOST_BYTES = 4_000_000
WATCHDOG_S = 120
NASTY = (
    b"\xff\xff\xff\x7f",
    b"\xff\xff\xff\xff",
    b"\0\0\0\x80",
    b"\0\0\0\0",
    b"\1\0\0\0",
    b"\xff\xff\0\0",
    b"\0\0\xc0\x7f",
)


def corpus() -> list[tuple[bytes, NatNetVersion]]:
    whole = [(encode(message, version), version) for version in VERSIONS for message in MESSAGES]
    whole.append((encode(ModelDef((*MODELS.models, ASSET)), VERSIONS[-1]), VERSIONS[-1]))
    whole += [(path.read_bytes(), NatNetVersion(3, 0)) for path in sorted(PACKETS.glob("*.bin"))]
    return whole


def damaged(packet: bytes, chance: random.Random, whole: list[tuple[bytes, NatNetVersion]]) -> bytes:
    data = bytearray(packet)
    for _ in range(chance.randint(1, 4)):
        place = chance.randrange(len(data) + 1)
        kind = chance.randrange(6)
        if kind == 0 and place < len(data):
            data[place] ^= 1 << chance.randrange(8)
        elif kind == 1:
            data[place : place + 4] = chance.choice(NASTY)
        elif kind == 2:
            del data[place:]
        elif kind == 3:
            data[place:place] = chance.randbytes(chance.randint(1, 40))
        elif kind == 4:
            other = chance.choice(whole)[0]
            data[place:] = other[chance.randrange(len(other)) :]
        else:
            del data[place : place + chance.randint(1, 16)]
    if len(data) >= 4 and chance.random() < 0.8:  # else most would fail by their stated length alone
        data[2:4] = struct.pack("<H", min(len(data) - 4, 65535))
    return bytes(data)


def mutants(count: int) -> Iterator[tuple[bytes, NatNetVersion]]:
    chance, whole = random.Random(20_261_124), corpus()  # the same ones every time
    for _ in range(count):
        packet, version = chance.choice(whole)
        yield damaged(packet, chance, whole), chance.choice((version, version, chance.choice(VERSIONS)))


def refused(data: bytes, version: NatNetVersion) -> bool:
    try:
        decode(data, version)
    except PacketError:
        return True
    return False


def test_mutants_are_read_or_refused() -> None:
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    signal.alarm(WATCHDOG_S)  # one that hangs ends the test run
    try:
        count = sum(refused(data, version) for data, version in mutants(MUTANTS))
    finally:
        signal.alarm(0)
    assert 0.3 * MUTANTS < count < 0.95 * MUTANTS, "both kinds must be tried"


def test_mutants_take_little_memory() -> None:
    biggest = 0
    tracemalloc.start()
    try:
        for data, version in mutants(MEASURED):
            tracemalloc.reset_peak()
            before = tracemalloc.get_traced_memory()[0]
            refused(data, version)
            biggest = max(biggest, tracemalloc.get_traced_memory()[1] - before)
    finally:
        tracemalloc.stop()
    assert biggest < MOST_BYTES


def test_the_worst_list_takes_little_memory() -> None:
    """As many one-byte names as a datagram holds."""
    packet = struct.pack("<HHiii", 7, 65_000, 1, 1, 0)[:12] + b"\0" + bytes(64_000)
    names = struct.pack("<iis", 1, 0, b"\0") + struct.pack("<i", 64_000) + bytes(64_000)
    tracemalloc.start()
    try:
        for number, body in ((7, packet[4:]), (5, names)):
            refused(struct.pack("<HH", number, len(body)) + body, NatNetVersion(3, 0))
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak < MOST_BYTES
