"""Planar poses of one thing, frame by frame."""

from dataclasses import dataclass

from slidepipe.series import BoolArray, FloatArray


@dataclass(frozen=True, slots=True)
class Track:
    """Planar poses of one thing at every frame; rows that are not valid hold zeros.

    Attributes
    ----------
    pose : (T, 3)
        m and rad.
    valid : (T,) bool
        Where it was tracked and believed.
    """

    pose: FloatArray
    valid: BoolArray
