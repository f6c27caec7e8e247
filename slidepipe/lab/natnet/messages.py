"""The messages of NatNet as plain records, in the order in which their fields are on the wire.

Lengths are metres, quaternions x y z w. A field that the version in use does not have keeps its default.
"""

from dataclasses import dataclass
from enum import IntFlag

Numbers = tuple[float, ...]
Bytes4 = tuple[int, int, int, int]
"""A version or an IPv4 address, as four bytes."""


class FrameFlags(IntFlag):
    """Bits of a frame's ``params``."""

    RECORDING = 1
    MODELS_CHANGED = 2


class BodyFlags(IntFlag):
    """Bits of a rigid body's ``params``."""

    TRACKED = 1


@dataclass(frozen=True, slots=True)
class Greeting:
    """Who asks, and which bitstream it would like (zeros: any)."""

    name: str = "Ping"
    application_version: Bytes4 = (0, 0, 0, 0)
    natnet_version: Bytes4 = (0, 0, 0, 0)
    flag: int = 0
    wanted_version: Bytes4 = (0, 0, 0, 0)


@dataclass(frozen=True, slots=True)
class Connect(Greeting):
    """A client asks for the server's information and, unicast, for frames."""


@dataclass(frozen=True, slots=True)
class Discovery(Greeting):
    """A client looks for servers."""


@dataclass(frozen=True, slots=True)
class Stream:
    """Where the server's frames go, and how fast its clock runs (since 3.0)."""

    clock_hz: int
    data_port: int
    multicast: int
    group: Bytes4


@dataclass(frozen=True, slots=True)
class ServerInfo:
    """What a server answers to a greeting."""

    name: str
    application_version: Bytes4
    natnet_version: Bytes4
    stream: Stream | None = None


@dataclass(frozen=True, slots=True)
class Words:
    """What is said in words."""

    text: str


@dataclass(frozen=True, slots=True)
class Request(Words):
    """A command, such as ``Bitstream,4.1``."""


@dataclass(frozen=True, slots=True)
class Response:
    """The answer to a command: a number or words."""

    value: int | str


@dataclass(frozen=True, slots=True)
class ModelDefRequest:
    """A client asks for the list of models."""


@dataclass(frozen=True, slots=True)
class FrameRequest:
    """A client asks for one frame."""


@dataclass(frozen=True, slots=True)
class MessageString(Words):
    """Words from the server."""


@dataclass(frozen=True, slots=True)
class Disconnect:
    """A client goes."""


@dataclass(frozen=True, slots=True)
class KeepAlive:
    """A client is still there."""


@dataclass(frozen=True, slots=True)
class EchoRequest:
    """A client's own stamp, to be sent back."""

    client_stamp: int


@dataclass(frozen=True, slots=True)
class EchoResponse:
    """The client's stamp, and the server's clock when it was answered."""

    client_stamp: int
    server_ticks: int


@dataclass(frozen=True, slots=True)
class Unrecognized:
    """The server did not understand."""


@dataclass(frozen=True, slots=True)
class MarkerSet:
    """A named group of markers and where they are, (K, 3) m."""

    name: str
    positions_m: tuple[Numbers, ...]


@dataclass(frozen=True, slots=True)
class BodyMarker:
    """A marker of a rigid body, in the frame of a server before 3.0."""

    position_m: Numbers
    id: int
    size_m: float


@dataclass(frozen=True, slots=True)
class RigidBody:
    """Pose of a rigid body; ``params`` as :class:`BodyFlags` (since 2.6)."""

    id: int
    position_m: Numbers
    quaternion_xyzw: Numbers
    markers: tuple[BodyMarker, ...] = ()
    mean_error_m: float = 0.0
    params: int = 1

    @property
    def tracked(self) -> bool:
        """Whether the pose of this frame was measured."""
        return bool(self.params & BodyFlags.TRACKED)


@dataclass(frozen=True, slots=True)
class Skeleton:
    """Bones, as rigid bodies."""

    id: int
    bodies: tuple[RigidBody, ...]


@dataclass(frozen=True, slots=True)
class LabelledMarker:
    """A marker that is known: its id holds the model in the upper and the marker in the lower 16 bits.

    The markers of a trained asset are told in the same way.
    """

    id: int
    position_m: Numbers
    size_m: float
    params: int = 0
    residual_m: float = 0.0


@dataclass(frozen=True, slots=True)
class Asset:
    """A trained asset (since 4.1)."""

    id: int
    bodies: tuple[RigidBody, ...]
    markers: tuple[LabelledMarker, ...]


@dataclass(frozen=True, slots=True)
class Analog:
    """Samples of a force plate or a device, by channel."""

    id: int
    channels: tuple[Numbers, ...]


@dataclass(frozen=True, slots=True)
class Ptp:
    """Time of a frame by the precision time protocol."""

    seconds: int
    fraction: int


@dataclass(frozen=True, slots=True)
class Frame:
    """One frame of the cameras; ``params`` as :class:`FrameFlags`, times in ticks of the server's clock (since 3.0)."""

    number: int
    marker_sets: tuple[MarkerSet, ...] = ()
    legacy_markers: tuple[Numbers, ...] = ()
    bodies: tuple[RigidBody, ...] = ()
    skeletons: tuple[Skeleton, ...] = ()
    assets: tuple[Asset, ...] = ()
    labelled_markers: tuple[LabelledMarker, ...] = ()
    force_plates: tuple[Analog, ...] = ()
    devices: tuple[Analog, ...] = ()
    latency_s: float = 0.0
    timecode: int = 0
    subframe: int = 0
    timestamp_s: float = 0.0
    exposure_ticks: int = 0
    received_ticks: int = 0
    sent_ticks: int = 0
    ptp: Ptp | None = None
    params: int = 0
