"""The codec against real packets, against sizes that are written down, and against itself."""

import struct
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from natnet_samples import ASSET, BODY_MODEL, FRAME, MESSAGES, MODELS, PACKETS, VERSIONS, body, frames

from slidepipe.errors import PacketError
from slidepipe.lab.natnet import messages as m
from slidepipe.lab.natnet import models
from slidepipe.lab.natnet.codec import decode, encode
from slidepipe.lab.natnet.version import NatNetVersion

V2_5, V2_6, V2_7, V2_9, V2_11 = (NatNetVersion.parse(text) for text in ("2.5", "2.6", "2.7", "2.9", "2.11"))
V3_0, V4_0, V4_1 = (NatNetVersion.parse(text) for text in ("3.0", "4.0", "4.1"))
real = pytest.mark.skipif(not PACKETS.is_dir(), reason=f"no recorded packets in {PACKETS}")


def recorded(name: str) -> bytes:
    return (PACKETS / f"{name}_v3.bin").read_bytes()


def at(data: bytes, form: str, offset: int) -> tuple[float, ...]:
    return struct.unpack_from(f"<{form}", data, offset)


@real
def test_recorded_questions() -> None:
    greeting = m.Greeting("NatNetLib", (3, 0, 0, 0), (3, 0, 0, 0))
    for name, kind in (("connect_packet", m.Connect), ("discovery_packet", m.Discovery)):
        decoded = decode(recorded(name), V3_0)
        assert decoded == kind(greeting.name, greeting.application_version, greeting.natnet_version)
    assert decode(recorded("requestmodeldef_packet"), V3_0) == m.ModelDefRequest()
    assert decode(recorded("echorequest_packet"), V3_0) == m.EchoRequest(0x109A664E)
    assert decode(recorded("echoresponse_packet"), V3_0) == m.EchoResponse(0x109A664E, 0x149CDE48504)


@real
def test_recorded_server_info() -> None:
    data = recorded("serverinfo_packet")
    assert data[11] != 0, "there is garbage after the name"
    assert decode(data, V3_0) == m.ServerInfo(
        "Motive", (2, 1, 0, 0), (3, 0, 0, 0), m.Stream(0x328C93, 1511, 1, (239, 255, 42, 99))
    )


@real
def test_recorded_models() -> None:
    data = recorded("modeldef_packet")
    told = decode(data, V3_0)
    assert isinstance(told, models.ModelDef)
    quad, markers, everything = told.models
    corners = tuple(models.BodyMarkerModel(at(data, "3f", 0x2D + 12 * index)) for index in range(5))
    assert quad == models.RigidBodyModel("RaceQuad", 2, -1, (0.0, 0.0, 0.0), corners)
    assert corners[0].position_m == pytest.approx((0.161159, 0.0350516, -0.0321813), abs=1e-7)
    assert markers == models.MarkerSetModel("RaceQuad", tuple(f"Marker{number}" for number in range(1, 6)))
    assert everything == models.MarkerSetModel("all", tuple(f"RaceQuad_{number}" for number in range(1, 6)))
    assert encode(told, V3_0) == data


@real
def test_recorded_frame() -> None:
    data = recorded("mocapframe_packet")
    frame = decode(data, V3_0)
    assert frame == m.Frame(
        number=162734,
        legacy_markers=tuple(at(data, "3f", 0x10 + 12 * index) for index in range(5)),
        bodies=(m.RigidBody(2, at(data, "3f", 0x54), at(data, "4f", 0x60), (), *at(data, "fh", 0x70)),),
        labelled_markers=tuple(
            m.LabelledMarker(*at(data, "i", place), at(data, "3f", place + 4), *at(data, "fhf", place + 16))
            for place in range(0x7E, 0x7E + 6 * 26, 26)
        ),
        timestamp_s=at(data, "d", 0x12A)[0],
        exposure_ticks=0x149CDD813D6,
        received_ticks=0x149CDD84F90,
        sent_ticks=0x149CDD85AF2,
    )
    assert frame.bodies[0].tracked
    assert frame.bodies[0].position_m == pytest.approx((0.1744466, 1.4471314, -0.734304), abs=1e-7)
    assert [marker.id for marker in frame.labelled_markers] == [0x20001, 0x20002, 0x20003, 0x20004, 0x20005, 50007]
    assert encode(frame, V3_0) == data


@real
def test_recorded_frame_with_an_occluded_marker() -> None:
    data = recorded("mocapframe_packet_occluded")
    frame = decode(data, V3_0)
    points = tuple(at(data, "3f", 0x19 + 12 * index) for index in range(5))
    assert frame == m.Frame(
        number=269007,
        marker_sets=(m.MarkerSet("FakeTree", points), m.MarkerSet("all", points)),
        bodies=(m.RigidBody(7, at(data, "3f", 0xA5), at(data, "4f", 0xB1), (), *at(data, "fh", 0xC1)),),
        labelled_markers=tuple(
            m.LabelledMarker(*at(data, "i", place), at(data, "3f", place + 4), *at(data, "fhf", place + 16))
            for place in range(0xCF, 0xCF + 4 * 26, 26)
        ),
        timestamp_s=at(data, "d", 0x147)[0],
        exposure_ticks=0x7DC303DF8E3,
        received_ticks=0x7DC303E3467,
        sent_ticks=0x7DC303E456D,
    )
    assert encode(frame, V3_0) == data


@pytest.mark.parametrize("size", [0, 5, 264, 270, 271])
def test_greetings_of_every_length(size: int) -> None:
    data = b"Ping".ljust(264, b"\0") + bytes((0, 4, 1, 0, 0, 0, 0))
    greeting = decode(struct.pack("<HH", 0, size) + data[:size], V4_1)
    assert greeting == m.Connect("Ping" if size else "", wanted_version=(4, 1, 0, 0) if size >= 269 else (0, 0, 0, 0))


@pytest.mark.parametrize("version", VERSIONS, ids=str)
def test_every_message_comes_back(version: NatNetVersion) -> None:
    for message in MESSAGES:
        packet = encode(message, version)
        again = decode(packet, version)
        assert encode(again, version) == packet
        assert decode(packet + b"\0", version) == again, "clients send a byte too many"
        if not isinstance(message, m.Frame | models.ModelDef):
            assert again == message


@given(frame=frames, version=st.sampled_from(VERSIONS))
def test_frames_come_back(frame: m.Frame, version: NatNetVersion) -> None:
    def known(one: m.RigidBody) -> m.RigidBody:
        older = replace(one, params=1) if version < V2_6 else one
        return older if version < V3_0 else replace(older, markers=())

    def bones(one: m.Skeleton | m.Asset) -> m.Skeleton | m.Asset:
        return replace(one, bodies=tuple(map(known, one.bodies)))

    expected = replace(
        frame,
        bodies=tuple(map(known, frame.bodies)),
        skeletons=tuple(map(bones, frame.skeletons)),
        assets=tuple(map(bones, frame.assets)) if version >= V4_1 else (),
        force_plates=frame.force_plates if version >= V2_9 else (),
        devices=frame.devices if version >= V2_11 else (),
        ptp=frame.ptp if version >= V4_0 else None,
    )
    if version < V3_0:
        labelled = tuple(replace(one, residual_m=0.0) for one in frame.labelled_markers)
        if version < V2_6:
            labelled = tuple(replace(one, params=0) for one in labelled)
        expected = replace(expected, labelled_markers=labelled, exposure_ticks=0, received_ticks=0, sent_ticks=0)
    else:
        expected = replace(expected, latency_s=0.0)
    assert decode(encode(frame, version), version) == expected


@pytest.mark.parametrize(
    ("version", "size"),
    [
        (V2_5, 4 + 36 + 16),
        (V2_6, 4 + 38 + 16),
        (V2_7, 4 + 38 + 16),
        (V2_9, 4 + 38 + 16),
        (V3_0, 38),
        (V4_0, 38),
        (V4_1, 38),
    ],
    ids=str,
)
def test_a_rigid_body_has_the_size_that_is_written_down(version: NatNetVersion, size: int) -> None:
    one = replace(body(1), markers=() if version >= V3_0 else (m.BodyMarker((0.0, 0.0, 0.0), 1, 0.5),))
    with_body = m.Frame(0, bodies=(one,))
    extra = 4 if version < V3_0 else 0
    assert len(encode(with_body, version)) - len(encode(m.Frame(0), version)) == size + extra


@pytest.mark.parametrize(
    ("version", "lists", "suffix"),
    [(V2_5, 5, 22), (V2_7, 5, 26), (V2_11, 7, 26), (V3_0, 7, 46), (V4_1, 8, 54)],
    ids=str,
)
def test_an_empty_frame_has_the_size_that_is_written_down(version: NatNetVersion, lists: int, suffix: int) -> None:
    listed = lists * (8 if version >= V4_1 else 4)
    lists_then_suffix = 4 + 4 + listed + suffix
    latency = 4 if version < V3_0 else 0
    assert len(encode(m.Frame(0), version)) == lists_then_suffix + latency - (4 if latency else 0)


def test_frames_of_4_0_end_with_and_without_precision_time() -> None:
    without = encode(replace(FRAME, ptp=None), V4_0)
    with_ptp = encode(FRAME, V4_0)
    assert len(with_ptp) == len(without) + 8
    assert decode(without, V4_0).ptp is None
    assert decode(with_ptp, V4_0).ptp == m.Ptp(5, 6)


def test_lists_of_4_1_state_their_bytes() -> None:
    packet = encode(m.Frame(0, bodies=(body(1), body(2))), V4_1)
    assert struct.unpack_from("<ii", packet, 4 + 4 + 8 + 8) == (2, 76)
    assert struct.unpack_from("<ii", packet, 8) == (0, 0)


def test_descriptions_by_version() -> None:
    told = models.ModelDef((*MODELS.models, ASSET, models.UnknownModel(57, b"some")))
    assert decode(encode(told, V4_1), V4_1) == told
    assert decode(encode(MODELS, V4_0), V4_0) == MODELS
    nameless = tuple(replace(marker, name="") for marker in BODY_MODEL.markers)
    assert decode(encode(MODELS, V3_0), V3_0).models[1] == replace(BODY_MODEL, markers=nameless)
    assert decode(encode(MODELS, V2_5), V2_5).models[1] == replace(BODY_MODEL, markers=())


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", r"^0 bytes are no packet, a header has 4$"),
        (b"\x07\x00\x05\x00ab", r"^message 7: 5 bytes are stated, 2 are there$"),
        (b"\x39\x00\x00\x00", r"^message 57: there is no such message$"),
        (
            struct.pack("<HHii", 7, 8, 1, 2**31 - 1),
            r"^byte 4: 2147483647 items of 5 bytes or more cannot be in 0 bytes$",
        ),
        (struct.pack("<HHii", 7, 8, 1, -1), r"^byte 4: -1 items of"),
        (struct.pack("<HHiii", 5, 12, 1, 57, 0), r"^byte 8: description of unknown kind 57$"),
        (struct.pack("<HHii4s", 5, 12, 1, 0, b"name"), r"^byte 8: a text begins here that nothing ends$"),
        (b"\x0d\x00\x08\x00" + bytes(8), r"^byte 0: 16 more bytes are needed, 8 are there$"),
    ],
)
def test_what_is_no_packet(data: bytes, message: str) -> None:
    with pytest.raises(PacketError, match=message):
        decode(data, V3_0)


def test_a_frame_ends_where_it_should() -> None:
    packet = encode(FRAME, V4_1)
    with pytest.raises(PacketError, match=r"^frame 77: does not end as a frame of NatNet 4\.1$"):
        decode(packet[:-1] + b"\1", V4_1)
    longer = struct.pack("<HH", 7, len(packet) - 3) + packet[4:] + b"\0"
    with pytest.raises(PacketError, match=r"^frame 77: does not end"):
        decode(longer, V4_1)


@pytest.mark.parametrize("version", [NatNetVersion(2, 4), NatNetVersion(4, 2)])
def test_other_versions_are_refused(version: NatNetVersion) -> None:
    expected = rf"^NatNet {version}: is not spoken, from 2\.5 to 4\.1 is$"
    with pytest.raises(PacketError, match=expected):
        encode(m.KeepAlive(), version)
    with pytest.raises(PacketError, match=expected):
        decode(b"\x0a\0\0\0", version)


@pytest.mark.parametrize(
    ("message", "complaint"),
    [
        (m.EchoRequest(-1), r"^-1 cannot be sent as <Q"),
        (m.Request("a\0b"), r"holds a zero byte$"),
        (m.Connect("n" * 256), r"it must be shorter than 256 bytes"),
        (m.Frame(0, legacy_markers=((0.0, 0.0, 0.0),) * 6000), r"^Frame: 72122 bytes do not fit a datagram of 65503$"),
    ],
)
def test_what_cannot_be_sent(message: m.Frame, complaint: str) -> None:
    with pytest.raises(PacketError, match=complaint):
        encode(message, V4_1)


@pytest.mark.parametrize("text", ["4", "", "a.b", "4.", "-1.2", "99999.1"])
def test_what_is_no_version(text: str) -> None:
    with pytest.raises(PacketError, match=r"^NatNet version: must be major\.minor, got"):
        NatNetVersion.parse(text)
