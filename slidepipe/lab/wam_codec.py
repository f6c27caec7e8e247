"""What goes over the wire to the arm and back, in three dialects behind one interface; no I/O here.

========== ====== ===========================================================================================
dialect    bytes  content, little-endian, the same both ways but for the bridge
========== ====== ===========================================================================================
positions  56     7 doubles, rad: the vendor's ``ex11_master_master``, unmodified
velocities 112    7 doubles rad, 7 doubles rad/s: ``wam_teleop``
bridge     200    our own program on the control PC, see ``wam_bridge/``: header of 32 bytes, then 3 times 7 doubles
========== ====== ===========================================================================================

A datagram of any other size is not decoded. The bridge's header is ``"SPWB"``, version, kind (1 command, 2 state),
flags, a byte that is 0, then sequence number (u32), time in ns (u64), the gripper's force in N (double) and the
sequence number that is answered (u32); its doubles are angles, speeds, and torques beyond gravity.
"""

import math
import struct
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from slidepipe.arm.wam import JOINT_COUNT
from slidepipe.lab.protocols import JointCommand
from slidepipe.series import FloatArray

MAGIC = b"SPWB"
BRIDGE_VERSION = 1
COMMAND, STATE = 1, 2
"""Kinds of the bridge's packets."""
LINKED, FAULT = 1, 2
"""Flags of the bridge's states: it follows our commands; its safety module or its own checks have stopped it."""
_HEADER = struct.Struct("<4sBBBxIQdI")
_JOINTS = struct.Struct(f"<{JOINT_COUNT}d")
_ALL = struct.Struct(f"<{3 * JOINT_COUNT}d")


@dataclass(frozen=True, slots=True)
class Stamp:
    """What the bridge's packets carry beside the joints: running number, sender's time, the gripper's force in N."""

    sequence: int
    time_ns: int
    gripper_n: float = 0.0


@dataclass(frozen=True, slots=True)
class ArmReport:
    """What the arm said of itself: None where the dialect has no word for it.

    Attributes
    ----------
    position_rad, velocity_rad_s, effort_n_m : (7,)
        Angles, speeds and applied torques.
    linked : bool
        Whether it follows our commands.
    fault : bool
        Whether its own checks have stopped it.
    stamp : Stamp
    answers : int
        Sequence number of the last command that it had taken.
    """

    position_rad: FloatArray
    velocity_rad_s: FloatArray | None = None
    effort_n_m: FloatArray | None = None
    linked: bool | None = None
    fault: bool = False
    stamp: Stamp | None = None
    answers: int | None = None


@dataclass(frozen=True, slots=True)
class Order:
    """A command as the arm's side finds it; speeds are NaN and the stamp is None where the dialect has none."""

    command: JointCommand
    stamp: Stamp | None = None


class WamCodec(Protocol):
    """One dialect; ``name`` is the lab file's word for it, ``size`` the datagrams' only size in bytes."""

    name: str
    size: int
    carries_torque: bool
    tells_linked: bool

    def body(self, command: JointCommand) -> bytes:
        """Encode what does not change with the time of sending; it can be done beforehand."""

    def seal(self, body: bytes, stamp: Stamp) -> bytes:
        """Complete a command at the time of sending."""

    def decode_command(self, packet: bytes) -> Order | None:
        """Read a command as the arm's side does: None where it is none."""

    def encode_report(self, report: ArmReport) -> bytes:
        """Encode a state, as the arm's side does."""

    def decode_report(self, packet: bytes) -> ArmReport | None:
        """Read a state: None where it is none, or holds a number that is not finite."""


class PositionsCodec:
    """The vendor's own example: angles and nothing else."""

    name, size = "positions", _JOINTS.size
    carries_torque = tells_linked = False

    def body(self, command: JointCommand) -> bytes:
        """Encode the angles."""
        return _JOINTS.pack(*command.position_rad)

    def seal(self, body: bytes, stamp: Stamp) -> bytes:  # noqa: ARG002  # there is no place for it
        """Nothing to add."""
        return body

    def decode_command(self, packet: bytes) -> Order | None:
        """Read the angles as the vendor's program does: the first 56 bytes, whatever they are."""
        if len(packet) < self.size:
            return None
        angles = _numbers(_JOINTS, packet[: self.size])
        return Order(JointCommand(angles, np.full(JOINT_COUNT, np.nan), np.zeros(JOINT_COUNT)))

    def encode_report(self, report: ArmReport) -> bytes:
        """Encode the angles."""
        return _JOINTS.pack(*report.position_rad)

    def decode_report(self, packet: bytes) -> ArmReport | None:
        """Read the angles."""
        if len(packet) != self.size:
            return None
        angles = _numbers(_JOINTS, packet)
        return ArmReport(angles) if _finite(angles) else None


class VelocitiesCodec:
    """Angles and speeds, as wam_teleop has them."""

    name, size = "velocities", 2 * _JOINTS.size
    carries_torque = tells_linked = False

    def body(self, command: JointCommand) -> bytes:
        """Encode angles and speeds."""
        return _JOINTS.pack(*command.position_rad) + _JOINTS.pack(*command.velocity_rad_s)

    def seal(self, body: bytes, stamp: Stamp) -> bytes:  # noqa: ARG002  # there is no place for it
        """Nothing to add."""
        return body

    def decode_command(self, packet: bytes) -> Order | None:
        """Read angles and speeds."""
        if len(packet) != self.size:
            return None
        angles, speeds = _numbers(_JOINTS, packet[: _JOINTS.size]), _numbers(_JOINTS, packet[_JOINTS.size :])
        return Order(JointCommand(angles, speeds, np.zeros(JOINT_COUNT)))

    def encode_report(self, report: ArmReport) -> bytes:
        """Encode angles and speeds."""
        speeds = np.zeros(JOINT_COUNT) if report.velocity_rad_s is None else report.velocity_rad_s
        return _JOINTS.pack(*report.position_rad) + _JOINTS.pack(*speeds)

    def decode_report(self, packet: bytes) -> ArmReport | None:
        """Read angles and speeds."""
        order = self.decode_command(packet)
        if order is None or not _finite(order.command.position_rad, order.command.velocity_rad_s):
            return None
        return ArmReport(order.command.position_rad, order.command.velocity_rad_s)


class BridgeCodec:
    """Our own program's dialect."""

    name, size = "bridge", _HEADER.size + _ALL.size
    carries_torque = tells_linked = True

    def body(self, command: JointCommand) -> bytes:
        """Encode angles, speeds and torques."""
        return _ALL.pack(*command.position_rad, *command.velocity_rad_s, *command.feedforward_n_m)

    def seal(self, body: bytes, stamp: Stamp) -> bytes:
        """Put the header in front."""
        return _header(COMMAND, 0, stamp, 0) + body

    def decode_command(self, packet: bytes) -> Order | None:
        """Read a command; None where it is none or a number in it is not finite."""
        if (head := _Head.read(packet, COMMAND)) is None:
            return None
        angles, speeds, torques = _numbers(_ALL, packet[_HEADER.size :]).reshape(3, JOINT_COUNT)
        if not _finite(angles, speeds, torques):
            return None
        return Order(JointCommand(angles, speeds, torques), head.stamp)

    def encode_report(self, report: ArmReport) -> bytes:
        """Encode a state."""
        flags = (LINKED if report.linked else 0) | (FAULT if report.fault else 0)
        still = np.zeros(JOINT_COUNT)
        columns = (report.position_rad, report.velocity_rad_s, report.effort_n_m)
        numbers = [value for column in columns for value in (still if column is None else column)]
        return _header(STATE, flags, report.stamp or Stamp(0, 0), report.answers or 0) + _ALL.pack(*numbers)

    def decode_report(self, packet: bytes) -> ArmReport | None:
        """Read a state."""
        if (head := _Head.read(packet, STATE)) is None:
            return None
        angles, speeds, torques = _numbers(_ALL, packet[_HEADER.size :]).reshape(3, JOINT_COUNT)
        if not _finite(angles, speeds, torques):
            return None
        return ArmReport(
            angles,
            speeds,
            torques,
            linked=bool(head.flags & LINKED),
            fault=bool(head.flags & FAULT),
            stamp=head.stamp,
            answers=head.answers,
        )


CODECS: dict[str, WamCodec] = {codec.name: codec for codec in (PositionsCodec(), VelocitiesCodec(), BridgeCodec())}
"""By the name that a lab file gives."""


@dataclass(frozen=True, slots=True)
class _Head:
    flags: int
    stamp: Stamp
    answers: int

    @classmethod
    def read(cls, packet: bytes, wanted: int) -> "_Head | None":
        if len(packet) != _HEADER.size + _ALL.size:
            return None
        magic, version, kind, flags, sequence, time_ns, gripper_n, answers = _HEADER.unpack_from(packet)
        if (magic, version, kind) != (MAGIC, BRIDGE_VERSION, wanted) or not math.isfinite(gripper_n):
            return None
        return cls(flags, Stamp(sequence, time_ns, gripper_n), answers)


def _header(kind: int, flags: int, stamp: Stamp, answers: int) -> bytes:
    return _HEADER.pack(MAGIC, BRIDGE_VERSION, kind, flags, stamp.sequence, stamp.time_ns, stamp.gripper_n, answers)


def _numbers(layout: struct.Struct, packet: bytes) -> FloatArray:
    return np.array(layout.unpack(packet))


def _finite(*columns: FloatArray) -> bool:
    return all(bool(np.isfinite(column).all()) for column in columns)
