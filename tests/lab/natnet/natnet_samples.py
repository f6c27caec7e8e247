"""Messages of every kind, and hypothesis strategies for them."""

import struct
from pathlib import Path

from hypothesis import strategies as st

from slidepipe.lab.natnet import messages as m
from slidepipe.lab.natnet import models
from slidepipe.lab.natnet.version import NatNetVersion

VERSIONS = [
    NatNetVersion.parse(text)
    for text in ("2.5", "2.6", "2.7", "2.8", "2.9", "2.10", "2.11", "3.0", "3.1", "4.0", "4.1")
]
PACKETS = Path(__file__).resolve().parents[4] / "shared" / "data" / "natnet_packets"
"""Real packets, beside the checkout."""


def single(number: float) -> float:
    return struct.unpack("<f", struct.pack("<f", number))[0]


def body(number: int, x: float = 0.5) -> m.RigidBody:
    return m.RigidBody(number, (x, single(0.1), -2.0), (0.0, 0.0, 0.0, 1.0), mean_error_m=single(1e-4))


FRAME = m.Frame(
    number=77,
    marker_sets=(m.MarkerSet("hand", ((1.0, 2.0, 3.0), (4.0, 5.0, 6.0))), m.MarkerSet("", ())),
    legacy_markers=((0.5, 0.25, 0.125),),
    bodies=(body(3), m.RigidBody(7, (1.0, 2.0, 3.0), (0.0, 1.0, 0.0, 0.0), params=0)),
    skeletons=(m.Skeleton(9, (body(1), body(2))),),
    assets=(m.Asset(4, (body(5),), (m.LabelledMarker(6, (0.0, 0.0, 1.0), 0.5, 2, 0.25),)),),
    labelled_markers=(m.LabelledMarker(3 << 16 | 1, (1.5, 0.0, 0.0), 0.5, 10, 0.25),),
    force_plates=(m.Analog(1, ((1.0, 2.0), ())),),
    devices=(m.Analog(2, ((3.0,),)),),
    latency_s=0.5,
    timecode=11,
    subframe=12,
    timestamp_s=1.25,
    exposure_ticks=2**63,
    received_ticks=2**63 + 1,
    sent_ticks=2**63 + 2,
    ptp=m.Ptp(5, 6),
    params=3,
)
BODY_MODEL = models.RigidBodyModel(
    "block",
    7,
    -1,
    (0.5, 0.0, 0.0),
    (models.BodyMarkerModel((1.0, 0.0, 0.0), 2, "corner"), models.BodyMarkerModel((0.0, 1.0, 0.0))),
)
MODELS = models.ModelDef(
    (
        models.MarkerSetModel("all", ("a", "b")),
        BODY_MODEL,
        models.SkeletonModel("person", 1, (BODY_MODEL,)),
        models.ForcePlateModel(1, "serial", 0.5, 0.25, (1.0, 2.0, 3.0), (0.5,) * 144, (0.25,) * 12, 1, 2, ("Fx", "Fy")),
        models.DeviceModel(2, "daq", "s1", 3, 4, ("ch0",)),
        models.CameraModel("Prime #1", (0.0, 1.0, 2.0), (0.0, 0.0, 0.0, 1.0)),
    )
)
"""Every kind that versions before 4.1 have, too."""
ASSET = models.AssetModel("tree", 1, 8, (BODY_MODEL,), (models.AssetMarkerModel("leaf", 1, (0.0, 0.5, 1.0), 0.25, 3),))
STREAM = m.Stream(10_000_000, 1511, 1, (239, 255, 42, 99))
MESSAGES = (
    m.Connect("Ping", (1, 2, 3, 4), (4, 1, 0, 0), 0, (4, 1, 0, 0)),
    m.Discovery("me"),
    m.ServerInfo("Motive", (3, 1, 0, 0), (4, 1, 0, 0), STREAM),
    m.ServerInfo("Motive", (1, 8, 0, 0), (2, 8, 0, 0)),
    m.Request("Bitstream,4.1"),
    m.Response(-1),
    m.Response("Bitstream,4.1"),
    m.ModelDefRequest(),
    MODELS,
    m.FrameRequest(),
    FRAME,
    m.MessageString("hello"),
    m.Disconnect(),
    m.KeepAlive(),
    m.EchoRequest(2**64 - 1),
    m.EchoResponse(1, 2**64 - 1),
    m.Unrecognized(),
)

floats = st.floats(width=32, allow_nan=False)
points = st.tuples(floats, floats, floats)
quaternions = st.tuples(floats, floats, floats, floats)
whole = st.integers(-(2**31), 2**31 - 1)
short = st.integers(-(2**15), 2**15 - 1)
long = st.integers(0, 2**64 - 1)
words = st.text(st.characters(exclude_characters="\0", exclude_categories=("Cs",)), max_size=9)


def several(of: st.SearchStrategy, most: int = 3) -> st.SearchStrategy:
    return st.lists(of, max_size=most).map(tuple)


markers = st.builds(m.BodyMarker, points, whole, floats)
bodies = st.builds(m.RigidBody, whole, points, quaternions, several(markers), floats, short)
analog = st.builds(m.Analog, whole, several(several(floats)))
frames = st.builds(
    m.Frame,
    number=whole,
    marker_sets=several(st.builds(m.MarkerSet, words, several(points))),
    legacy_markers=several(points),
    bodies=several(bodies),
    skeletons=several(st.builds(m.Skeleton, whole, several(bodies))),
    assets=several(
        st.builds(
            m.Asset, whole, several(bodies), several(st.builds(m.LabelledMarker, whole, points, floats, short, floats))
        )
    ),
    labelled_markers=several(st.builds(m.LabelledMarker, whole, points, floats, short, floats)),
    force_plates=several(analog),
    devices=several(analog),
    latency_s=floats,
    timecode=st.integers(0, 2**32 - 1),
    subframe=st.integers(0, 2**32 - 1),
    timestamp_s=floats,
    exposure_ticks=long,
    received_ticks=long,
    sent_ticks=long,
    ptp=st.builds(m.Ptp, st.integers(0, 2**32 - 1), st.integers(0, 2**32 - 1)),
    params=short,
)
