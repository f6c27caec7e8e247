"""How a lab's cameras are reached, and what is looked for in them."""

from dataclasses import dataclass, field
from enum import Enum

from slidepipe.lab.camera_frame import CameraFrame, RigidPose

COMMAND_PORT, DATA_PORT, GROUP = 1510, 1511, "239.255.42.99"
"""What Motive uses unless told otherwise."""
TIMEOUT_S = 3.0
"""How long each step of connecting may take."""


class Transport(Enum):
    """How frames are sent."""

    UNICAST = "unicast"
    MULTICAST = "multicast"


@dataclass(frozen=True, slots=True)
class TrackedBody:
    """A rigid body of the cameras, by name or by number, and the pose of our frame, {f} or {b}, in it."""

    model: str | int
    offset: RigidPose = field(default_factory=RigidPose)


@dataclass(frozen=True, slots=True)
class NatNetSettings:
    """Where the server is, by which interface it is reached, and which bodies are the hand and the object.

    Attributes
    ----------
    server, interface : str
        IPv4 addresses: of the server, and of this machine's interface towards it, to which alone sockets are bound.
    hand, object : TrackedBody
    transport : Transport
    group : str
        Multicast group.
    command_port, data_port : int
    frame : CameraFrame
    timeout_s : float
        How long each step of connecting may take.
    """

    server: str
    interface: str
    hand: TrackedBody
    object: TrackedBody
    transport: Transport = Transport.UNICAST
    group: str = GROUP
    command_port: int = COMMAND_PORT
    data_port: int = DATA_PORT
    frame: CameraFrame = field(default_factory=CameraFrame)
    timeout_s: float = TIMEOUT_S
