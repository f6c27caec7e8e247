"""From the cameras' own frame to the arm's base frame, in plain floats: it is done 360 times a second in the loop."""

from dataclasses import dataclass, field
from enum import Enum

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]


class UpAxis(Enum):
    """Which axis of the cameras' frame points up; Motive's default is y."""

    Y = "y"
    Z = "z"


@dataclass(frozen=True, slots=True)
class RigidPose:
    """A position in m and a unit quaternion x y z w.

    Examples
    --------
    >>> quarter = RigidPose((1.0, 0.0, 0.0), (0.0, 0.0, 0.5**0.5, 0.5**0.5))
    >>> [round(number, 12) + 0.0 for number in quarter.then(RigidPose((1.0, 0.0, 0.0))).position_m]
    [1.0, 1.0, 0.0]
    >>> [round(number, 12) + 0.0 for number in quarter.then(quarter.inverse()).position_m]
    [0.0, 0.0, 0.0]
    """

    position_m: Vector = (0.0, 0.0, 0.0)
    quaternion_xyzw: Quaternion = (0.0, 0.0, 0.0, 1.0)

    def then(self, inner: "RigidPose") -> "RigidPose":
        """Pose of something that has the pose ``inner`` in the frame of this one."""
        x, y, z = _turned(self.quaternion_xyzw, inner.position_m)
        at = self.position_m
        return RigidPose((at[0] + x, at[1] + y, at[2] + z), _product(self.quaternion_xyzw, inner.quaternion_xyzw))

    def inverse(self) -> "RigidPose":
        """Pose of the outer frame in this one."""
        x, y, z, w = self.quaternion_xyzw
        back = (-x, -y, -z, w)
        px, py, pz = _turned(back, self.position_m)
        return RigidPose((-px, -py, -pz), back)


@dataclass(frozen=True, slots=True)
class CameraFrame:
    """Where the cameras' frame is: its up axis, and its pose in the arm's base frame once its z points up.

    A frame with y up becomes one with z up as Motive itself does it: ``(x, y, z)`` is then ``(x, -z, y)``, for
    positions and for the axes of the bodies alike.
    """

    up: UpAxis = UpAxis.Y
    in_base: RigidPose = field(default_factory=RigidPose)

    def to_base(self, pose: RigidPose) -> RigidPose:
        """Pose in the base frame of a body that the cameras report."""
        return self.in_base.then(_y_to_z(pose) if self.up is UpAxis.Y else pose)

    def from_base(self, pose: RigidPose) -> RigidPose:
        """Pose that the cameras report of a body: the inverse of :meth:`to_base`."""
        seen = self.in_base.inverse().then(pose)
        return _z_to_y(seen) if self.up is UpAxis.Y else seen


def _y_to_z(pose: RigidPose) -> RigidPose:
    (x, y, z), (qx, qy, qz, qw) = pose.position_m, pose.quaternion_xyzw
    return RigidPose((x, -z, y), (qx, -qz, qy, qw))


def _z_to_y(pose: RigidPose) -> RigidPose:
    (x, y, z), (qx, qy, qz, qw) = pose.position_m, pose.quaternion_xyzw
    return RigidPose((x, z, -y), (qx, qz, -qy, qw))


def _product(a: Quaternion, b: Quaternion) -> Quaternion:
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def _turned(turn: Quaternion, vector: Vector) -> Vector:
    x, y, z, w = turn
    vx, vy, vz = vector
    tx, ty, tz = 2.0 * (y * vz - z * vy), 2.0 * (z * vx - x * vz), 2.0 * (x * vy - y * vx)
    return (
        vx + w * tx + y * tz - z * ty,
        vy + w * ty + z * tx - x * tz,
        vz + w * tz + x * ty - y * tx,
    )
