"""The three dialects, byte by byte, and what they refuse."""

import struct

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slidepipe.lab.protocols import JointCommand
from slidepipe.lab.wam_codec import CODECS, ArmReport, Stamp, WamCodec

COMMAND = JointCommand(np.arange(7.0), 0.1 * np.arange(7.0), -np.arange(7.0))
STAMP = Stamp(258, 3, 1.25)
SIZES = {"positions": 56, "velocities": 112, "bridge": 200}


@pytest.fixture(params=sorted(SIZES))
def codec(request: pytest.FixtureRequest) -> WamCodec:
    return CODECS[request.param]


def sealed(codec: WamCodec, command: JointCommand = COMMAND) -> bytes:
    return codec.seal(codec.body(command), STAMP)


def test_datagrams_have_exactly_their_size(codec: WamCodec) -> None:
    assert len(sealed(codec)) == len(codec.encode_report(ArmReport(np.ones(7)))) == codec.size == SIZES[codec.name]


def test_the_vendors_example_is_seven_little_endian_doubles() -> None:
    assert sealed(CODECS["positions"]) == struct.pack("<7d", *range(7))


def test_wam_teleop_is_angles_then_speeds() -> None:
    assert sealed(CODECS["velocities"]) == struct.pack("<14d", *range(7), *(0.1 * np.arange(7)))


def test_the_bridges_header() -> None:
    assert sealed(CODECS["bridge"])[:32] == (
        b"SPWB\x01\x01\x00\x00" + struct.pack("<I", 258) + struct.pack("<Q", 3) + struct.pack("<d", 1.25) + bytes(4)
    )


def test_commands_come_back(codec: WamCodec) -> None:
    order = codec.decode_command(sealed(codec))
    assert order is not None
    np.testing.assert_array_equal(order.command.position_rad, COMMAND.position_rad)
    if codec.name == "positions":
        assert np.isnan(order.command.velocity_rad_s).all()
    else:
        np.testing.assert_array_equal(order.command.velocity_rad_s, COMMAND.velocity_rad_s)
    wanted = COMMAND.feedforward_n_m if codec.carries_torque else np.zeros(7)
    np.testing.assert_array_equal(order.command.feedforward_n_m, wanted)
    assert order.stamp == (STAMP if codec.name == "bridge" else None)


def test_states_come_back(codec: WamCodec) -> None:
    told = ArmReport(np.ones(7), np.full(7, 2.0), np.full(7, 3.0), linked=True, fault=True, stamp=STAMP, answers=7)
    report = codec.decode_report(codec.encode_report(told))
    assert report is not None
    np.testing.assert_array_equal(report.position_rad, 1.0)
    if codec.name == "bridge":
        assert (report.linked, report.fault, report.stamp, report.answers) == (True, True, STAMP, 7)
        np.testing.assert_array_equal(report.effort_n_m, 3.0)
    else:
        assert (report.linked, report.fault, report.stamp, report.answers) == (None, False, None, None)
        assert report.effort_n_m is None


@pytest.mark.parametrize("size", [0, 32, 55, 57, 111, 113, 199, 201, 4096])
def test_states_of_another_size_are_none(codec: WamCodec, size: int) -> None:
    assert codec.decode_report(bytes(size)) is None


def test_the_vendors_program_cuts_what_is_too_long_and_this_is_how_it_is_played() -> None:
    order = CODECS["positions"].decode_command(struct.pack("<14d", *range(14)))
    assert order is not None
    np.testing.assert_array_equal(order.command.position_rad, np.arange(7.0))


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_states_that_are_not_finite_are_none(codec: WamCodec, bad: float) -> None:
    assert codec.decode_report(codec.encode_report(ArmReport(np.full(7, bad)))) is None


@given(st.binary(max_size=300))
def test_any_bytes_are_read_or_refused(data: bytes) -> None:
    for codec in CODECS.values():
        report, order = codec.decode_report(data), codec.decode_command(data)
        assert report is None or np.isfinite(report.position_rad).all()
        assert order is None or len(order.command.position_rad) == 7
