"""What each message holds, field by field, and since which version."""

from typing import Any

from slidepipe.errors import PacketError
from slidepipe.lab.natnet import messages as m
from slidepipe.lab.natnet import models
from slidepipe.lab.natnet.records import Columns, Field, Record
from slidepipe.lab.natnet.version import NatNetVersion
from slidepipe.lab.natnet.wire import SIZED_SINCE, Many, Name, Number, Piece, Reader, Text

V2_6, V2_7, V2_9, V2_11 = NatNetVersion(2, 6), NatNetVersion(2, 7), NatNetVersion(2, 9), NatNetVersion(2, 11)
V3_0, V4_0, V4_1 = NatNetVersion(3, 0), NatNetVersion(4, 0), NatNetVersion(4, 1)

I16, I32, U8, U16, U32, U64 = (Number(code) for code in "hiBHIQ")
F32, F64 = Number("f"), Number("d")
POINT, QUATERNION, BYTES4 = Number("f", 3), Number("f", 4), Number("B", 4)
TEXT = Text()
SUFFIX_WITH_PTP = 14
"""Bytes that remain before the precision time, if there is one: 6 without."""


class _Timestamp(Piece):
    """Seconds: in double precision since 2.7."""

    __slots__ = ()

    def least(self, version: NatNetVersion) -> int:
        return self._number(version).least(version)

    def read(self, reader: Reader) -> float:
        return float(self._number(reader.version).read(reader))

    def write(self, out: bytearray, value: float, version: NatNetVersion) -> None:
        self._number(version).write(out, value, version)

    def _number(self, version: NatNetVersion) -> Number:
        return F64 if version >= V2_7 else F32


class _PtpPiece(Piece):
    """Precision time: since 4.1 always, in 4.0 where there is room for it."""

    __slots__ = ()
    _RECORD = Record(m.Ptp, Field("seconds", U32), Field("fraction", U32))

    def least(self, version: NatNetVersion) -> int:
        return 8 if version >= V4_1 else 0

    def read(self, reader: Reader) -> m.Ptp | None:
        if reader.version < V4_1 and reader.remaining != SUFFIX_WITH_PTP:
            return None
        ptp: m.Ptp = self._RECORD.read(reader)
        return ptp

    def write(self, out: bytearray, value: m.Ptp | None, version: NatNetVersion) -> None:
        if value is not None or version >= V4_1:
            self._RECORD.write(out, value or m.Ptp(0, 0), version)


class _StreamPiece(Piece):
    """Where the stream goes: since 3.0, told by whether anything remains."""

    __slots__ = ()
    _RECORD = Record(
        m.Stream, Field("clock_hz", U64), Field("data_port", U16), Field("multicast", U8), Field("group", BYTES4)
    )

    def least(self, version: NatNetVersion) -> int:  # noqa: ARG002  # the same in every version
        return 0

    def read(self, reader: Reader) -> m.Stream | None:
        if not reader.remaining:
            return None
        stream: m.Stream = self._RECORD.read(reader)
        return stream

    def write(self, out: bytearray, value: m.Stream | None, version: NatNetVersion) -> None:
        if value is not None:
            self._RECORD.write(out, value, version)


class _ModelPiece(Piece):
    """A description: its kind, since 4.1 its size, and what the kind holds."""

    __slots__ = ()

    def least(self, version: NatNetVersion) -> int:
        return 8 if version >= SIZED_SINCE else 4

    def read(self, reader: Reader) -> Any:
        (kind,) = reader.unpack(I32.flat(reader.version).form)
        size = reader.count(1) if reader.version >= SIZED_SINCE else None
        if 0 <= kind < len(MODELS):
            return MODELS[kind].read(reader)
        if size is None:
            raise PacketError(f"byte {reader.offset}: description of unknown kind {kind}")
        return models.UnknownModel(kind, reader.take(size))

    def write(self, out: bytearray, value: Any, version: NatNetVersion) -> None:
        body = bytearray()
        if isinstance(value, models.UnknownModel):
            kind, body = value.kind, bytearray(value.data)
        else:
            kind = next(number for number, model in enumerate(MODELS) if isinstance(value, model.kind))
            MODELS[kind].write(body, value, version)
        I32.write(out, kind, version)
        if version >= SIZED_SINCE:
            I32.write(out, len(body), version)
        out += body


GREETING = (
    Field("name", Name(256)),
    Field("application_version", BYTES4),
    Field("natnet_version", BYTES4),
    Field("flag", U8),
    Field("wanted_version", BYTES4),
)
GREETING_BYTES = 270
"""With one more at the end, as clients of version 4 send it."""

SERVER_INFO = Record(
    m.ServerInfo,
    Field("name", Name(256)),
    Field("application_version", BYTES4),
    Field("natnet_version", BYTES4),
    Field("stream", _StreamPiece()),
)

BODY = Record(
    m.RigidBody,
    Field("id", I32),
    Field("position_m", POINT),
    Field("quaternion_xyzw", QUATERNION),
    Field(
        "markers",
        Columns(m.BodyMarker, Field("position_m", POINT), Field("id", I32), Field("size_m", F32)),
        before=V3_0,
        default=(),
    ),
    Field("mean_error_m", F32),
    Field("params", I16, since=V2_6, default=int(m.BodyFlags.TRACKED)),
)
_ANALOG = Record(m.Analog, Field("id", I32), Field("channels", Many(Many(F32))))
_LABELLED = Record(
    m.LabelledMarker,
    Field("id", I32),
    Field("position_m", POINT),
    Field("size_m", F32),
    Field("params", I16, since=V2_6, default=0),
    Field("residual_m", F32, since=V3_0, default=0.0),
)


def _section(name: str, item: Piece, since: NatNetVersion | None = None) -> Field:
    field = Field(name, Many(item, sized=True), default=())
    return field if since is None else Field(name, field.piece, since=since, default=())


FRAME = Record(
    m.Frame,
    Field("number", I32),
    _section("marker_sets", Record(m.MarkerSet, Field("name", TEXT), Field("positions_m", Many(POINT)))),
    _section("legacy_markers", POINT),
    _section("bodies", BODY),
    _section("skeletons", Record(m.Skeleton, Field("id", I32), Field("bodies", Many(BODY)))),
    _section(
        "assets",
        Record(m.Asset, Field("id", I32), Field("bodies", Many(BODY)), Field("markers", Many(_LABELLED))),
        V4_1,
    ),
    _section("labelled_markers", _LABELLED),
    _section("force_plates", _ANALOG, V2_9),
    _section("devices", _ANALOG, V2_11),
    Field("latency_s", F32, before=V3_0, default=0.0),
    Field("timecode", U32),
    Field("subframe", U32),
    Field("timestamp_s", _Timestamp()),
    Field("exposure_ticks", U64, since=V3_0, default=0),
    Field("received_ticks", U64, since=V3_0, default=0),
    Field("sent_ticks", U64, since=V3_0, default=0),
    Field("ptp", _PtpPiece(), since=V4_0),
    Field("params", I16),
)

_BODY_MODEL = Record(
    models.RigidBodyModel,
    Field("name", TEXT),
    Field("id", I32),
    Field("parent_id", I32),
    Field("offset_m", POINT),
    Field(
        "markers",
        Columns(
            models.BodyMarkerModel,
            Field("position_m", POINT),
            Field("label", I32),
            Field("name", TEXT, since=V4_0, default=""),
        ),
        since=V3_0,
        default=(),
    ),
)
_ASSET_MARKER_MODEL = Record(
    models.AssetMarkerModel,
    Field("name", TEXT),
    Field("id", I32),
    Field("position_m", POINT),
    Field("size_m", F32),
    Field("params", I16),
)
_CHANNELS = (Field("channel_type", I32), Field("channels", Many(TEXT)))

MODELS = (
    Record(models.MarkerSetModel, Field("name", TEXT), Field("markers", Many(TEXT))),
    _BODY_MODEL,
    Record(models.SkeletonModel, Field("name", TEXT), Field("id", I32), Field("bodies", Many(_BODY_MODEL))),
    Record(
        models.ForcePlateModel,
        Field("id", I32),
        Field("serial", TEXT),
        Field("width", F32),
        Field("length", F32),
        Field("origin", POINT),
        Field("calibration", Number("f", 144)),
        Field("corners", Number("f", 12)),
        Field("plate_type", I32),
        *_CHANNELS,
    ),
    Record(
        models.DeviceModel,
        Field("id", I32),
        Field("name", TEXT),
        Field("serial", TEXT),
        Field("device_type", I32),
        *_CHANNELS,
    ),
    Record(models.CameraModel, Field("name", TEXT), Field("position_m", POINT), Field("quaternion_xyzw", QUATERNION)),
    Record(
        models.AssetModel,
        Field("name", TEXT),
        Field("asset_type", I32),
        Field("id", I32),
        Field("bodies", Many(_BODY_MODEL)),
        Field("markers", Many(_ASSET_MARKER_MODEL)),
    ),
)
"""Kinds of description by their number on the wire."""
MODEL_DEF = Record(models.ModelDef, Field("models", Many(_ModelPiece())))
ECHO_REQUEST = Record(m.EchoRequest, Field("client_stamp", U64))
ECHO_RESPONSE = Record(m.EchoResponse, Field("client_stamp", U64), Field("server_ticks", U64))
