"""The hand or the object among the bodies of a frame."""

import math
from collections.abc import Iterable

import numpy as np

from slidepipe.lab.camera_frame import CameraFrame, RigidPose
from slidepipe.lab.natnet.messages import RigidBody
from slidepipe.lab.natnet.models import ModelDef
from slidepipe.lab.natnet.settings import TrackedBody
from slidepipe.lab.protocols import BodyPose

FAR_FROM_UNIT = 0.1
"""A quaternion whose length is further from one belongs to a body that was never tracked."""


class WatchedBody:
    """A body that is looked for in every frame.

    Parameters
    ----------
    role : str
        What it is to us: hand or object.
    asked : TrackedBody
        Which model it is.
    frame : CameraFrame
        Where the cameras' frame is.
    """

    __slots__ = ("_frame", "asked", "id", "missing", "role")

    def __init__(self, role: str, asked: TrackedBody, frame: CameraFrame) -> None:
        self.role, self.asked, self._frame = role, asked, frame
        self.id: int | None = None
        self.missing = 0

    def find(self, models: ModelDef) -> None:
        """Look up its number among the server's models."""
        self.id = next((one.id for one in models.bodies if self.asked.model in (one.name, one.id)), None)

    def pose(self, bodies: Iterable[RigidBody]) -> BodyPose | None:
        """Its pose in the base frame; None, and counted, where it was not tracked."""
        body = next((one for one in bodies if one.id == self.id), None)
        if body is None or not body.tracked or not _is_a_pose(body):
            self.missing += 1
            return None
        x, y, z = body.position_m
        qx, qy, qz, qw = body.quaternion_xyzw
        pose = self._frame.to_base(RigidPose((x, y, z), (qx, qy, qz, qw))).then(self.asked.offset)
        turn = np.array(pose.quaternion_xyzw)
        return BodyPose(np.array(pose.position_m), turn / math.sqrt(turn @ turn))


def _is_a_pose(body: RigidBody) -> bool:
    numbers = (*body.position_m, *body.quaternion_xyzw)
    return all(map(math.isfinite, numbers)) and abs(math.hypot(*body.quaternion_xyzw) - 1.0) < FAR_FROM_UNIT
