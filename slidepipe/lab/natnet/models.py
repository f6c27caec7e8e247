"""Descriptions of what a server tracks: what the numbers in a frame belong to.

Lengths are metres, quaternions x y z w. A field that the version in use does not have keeps its default.
"""

from dataclasses import dataclass
from typing import Any

from slidepipe.lab.natnet.messages import Numbers


@dataclass(frozen=True, slots=True)
class MarkerSetModel:
    """Description of a marker set."""

    name: str
    markers: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class BodyMarkerModel:
    """Where a marker is on its body; ``label`` of an active one, ``name`` since 4.0."""

    position_m: Numbers
    label: int = 0
    name: str = ""


@dataclass(frozen=True, slots=True)
class RigidBodyModel:
    """Description of a rigid body; markers since 3.0."""

    name: str
    id: int
    parent_id: int = -1
    offset_m: Numbers = (0.0, 0.0, 0.0)
    markers: tuple[BodyMarkerModel, ...] = ()


@dataclass(frozen=True, slots=True)
class SkeletonModel:
    """Description of a skeleton."""

    name: str
    id: int
    bodies: tuple[RigidBodyModel, ...]


@dataclass(frozen=True, slots=True)
class ForcePlateModel:
    """Description of a force plate: (144,) calibration matrix by rows, (12,) corners."""

    id: int
    serial: str
    width: float
    length: float
    origin: Numbers
    calibration: Numbers
    corners: Numbers
    plate_type: int
    channel_type: int
    channels: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class DeviceModel:
    """Description of a device."""

    id: int
    name: str
    serial: str
    device_type: int
    channel_type: int
    channels: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class CameraModel:
    """Where a camera is."""

    name: str
    position_m: Numbers
    quaternion_xyzw: Numbers


@dataclass(frozen=True, slots=True)
class AssetMarkerModel:
    """Where a marker of a trained asset is."""

    name: str
    id: int
    position_m: Numbers
    size_m: float
    params: int


@dataclass(frozen=True, slots=True)
class AssetModel:
    """Description of a trained asset (since 4.1)."""

    name: str
    asset_type: int
    id: int
    bodies: tuple[RigidBodyModel, ...]
    markers: tuple[AssetMarkerModel, ...]


@dataclass(frozen=True, slots=True)
class UnknownModel:
    """A description of a kind that a newer server has; told apart by its stated size (since 4.1)."""

    kind: int
    data: bytes


@dataclass(frozen=True, slots=True)
class ModelDef:
    """The list of models: what the numbers in a frame belong to."""

    models: tuple[Any, ...] = ()

    @property
    def bodies(self) -> tuple[RigidBodyModel, ...]:
        """The rigid bodies among them."""
        return tuple(model for model in self.models if isinstance(model, RigidBodyModel))
