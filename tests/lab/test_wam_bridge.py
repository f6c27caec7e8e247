"""The bridge's packets and playout in C++ beside those in Python; the program itself needs the vendor's library."""

import random
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from slidepipe.lab import wam_bridge
from slidepipe.lab.playout import InTurn
from slidepipe.lab.protocols import JointCommand
from slidepipe.lab.wam_codec import ArmReport, BridgeCodec, Order, Stamp

SOURCES = Path(wam_bridge.__file__).parent
COMPILER = shutil.which("g++")
HARNESS = r"""
#include <cstdio>
#include "playout.h"
using namespace slidepipe;

// Lines of hexadecimal commands: each comes back as a state, or as "no"; a line "t" is a tick of the playout.
int main() {
  static char line[1024];
  Playout playout;
  while (std::fgets(line, sizeof line, stdin)) {
    Packet packet;
    if (line[0] == 't') {
      if (playout.take(&packet)) std::printf("%u\n", packet.sequence); else std::printf("-\n");
      continue;
    }
    std::uint8_t bytes[500];
    std::size_t size = 0;
    unsigned value;
    while (std::sscanf(line + 2 * size, "%2x", &value) == 1) bytes[size++] = static_cast<std::uint8_t>(value);
    if (!decode(bytes, size, COMMAND, &packet)) { std::printf("no\n"); continue; }
    playout.put(packet);
    packet.kind = STATE;
    packet.flags = LINKED | FAULT;
    packet.answers = packet.sequence;
    encode(packet, bytes);
    for (std::size_t i = 0; i < PACKET_BYTES; ++i) std::printf("%02x", bytes[i]);
    std::printf("\n");
  }
}
"""


@pytest.fixture(scope="module")
def cpp(tmp_path_factory: pytest.TempPathFactory) -> Path:
    if COMPILER is None:
        pytest.skip("there is no g++ on this machine")
    directory = tmp_path_factory.mktemp("bridge")
    (directory / "harness.cpp").write_text(HARNESS)
    program = directory / "harness"
    subprocess.run(  # noqa: S603  # our own source
        [COMPILER, "-std=c++11", "-Wall", "-Wextra", "-Werror", f"-I{SOURCES}", str(directory / "harness.cpp"), "-o",
         str(program)],
        check=True,
    )  # fmt: skip
    return program


def ask(program: Path, lines: list[str]) -> list[str]:
    text = "".join(f"{line}\n" for line in lines)
    done = subprocess.run([str(program)], input=text, capture_output=True, text=True, check=True)  # noqa: S603
    return done.stdout.split("\n")[:-1]


def command(numbers: np.ndarray, stamp: Stamp) -> bytes:
    codec = BridgeCodec()
    return codec.seal(codec.body(JointCommand(*numbers)), stamp)


def test_commands_come_back_as_states_to_the_last_bit(cpp: Path) -> None:
    generator = np.random.default_rng(0)
    numbers = generator.normal(scale=10.0 ** generator.integers(-300, 300, (50, 3, 7)))
    stamps = [Stamp(int(generator.integers(2**32)), int(generator.integers(2**63)), 1.25) for _ in numbers]
    told = ask(cpp, [command(row, stamp).hex() for row, stamp in zip(numbers, stamps, strict=True)])
    for row, stamp, line in zip(numbers, stamps, told, strict=True):
        report = BridgeCodec().decode_report(bytes.fromhex(line))
        assert isinstance(report, ArmReport)
        np.testing.assert_array_equal([report.position_rad, report.velocity_rad_s, report.effort_n_m], row)
        assert (report.stamp, report.answers, report.linked, report.fault) == (stamp, stamp.sequence, True, True)


def test_both_refuse_the_same_damaged_packets(cpp: Path) -> None:
    draw = random.Random(1)  # no secret
    sound = command(np.ones((3, 7)), Stamp(1, 2))
    damaged = [sound[:-1], sound + b"\0", b"", command(np.full((3, 7), np.nan), Stamp(1, 2))]
    damaged.append(command(np.full((3, 7), -np.inf), Stamp(1, 2)))
    for _ in range(200):
        at = draw.randrange(len(sound))
        damaged.append(sound[:at] + bytes([draw.randrange(256)]) + sound[at + 1 :])
    told = ask(cpp, [packet.hex() or "zz" for packet in damaged])
    refused = [BridgeCodec().decode_command(packet) is None for packet in damaged]
    assert [line == "no" for line in told] == refused
    assert 5 < sum(refused) < len(damaged)


def test_both_follow_the_same_commands_in_the_same_ticks(cpp: Path) -> None:
    """A stream with losses, doubles, wrong order and two pauses, one of them so long that it begins anew."""
    draw = random.Random(2)  # no secret
    playout, lines, wanted = InTurn(), [], []
    late: list[int] = []
    for tick in range(3000):
        arriving = [] if 500 <= tick < 540 else [tick + 5000 * (tick > 2000)]
        if draw.random() < 0.2:
            late, arriving = late + arriving, []
        elif draw.random() < 0.2:
            arriving, late = arriving + late, []
        for number in arriving * draw.choice([1, 1, 2]):
            playout.put(Order(JointCommand(*np.zeros((3, 7))), Stamp(number, 0)))
            lines.append(command(np.zeros((3, 7)), Stamp(number, 0)).hex())
        order = playout.take()
        lines.append("t")
        wanted.append("-" if order is None or order.stamp is None else str(order.stamp.sequence))
    told = [line for line in ask(cpp, lines) if len(line) < 20]
    assert told == wanted
    assert sum(one == "-" for one in told) < 1000
