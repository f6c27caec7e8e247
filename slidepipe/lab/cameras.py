"""The simulated cameras: noise, dropouts, a delay, and a clock of their own."""

from dataclasses import dataclass, field

import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

from slidepipe.errors import InputError
from slidepipe.lab.protocols import BodyPose, ClockExchange, MocapFrame
from slidepipe.series import FloatArray

TICKS_PER_S = 10_000_000.0
CAPTURE_RADIUS_M = 1.5
"""A body farther than this from the middle of the plane is out of every camera's sight."""
ECHO_TRIP_S = 0.0009
"""Shortest round trip of an echo."""


@dataclass(frozen=True, slots=True)
class Offset:
    """Where a frame really is in the one that it is taken for: position (3,), m, and rotation vector (3,), rad."""

    position_m: FloatArray = field(default_factory=lambda: np.zeros(3))
    rotation_rad: FloatArray = field(default_factory=lambda: np.zeros(3))


@dataclass(frozen=True, slots=True)
class CameraSettings:
    """What the cameras do to the truth.

    Attributes
    ----------
    rate_hz : float
    position_noise_m, angle_noise_rad : float
        Standard deviation for each axis and frame.
    dropout_share : float
        Share of frames in which a body is not tracked, each body for itself.
    clock_offset_s, clock_drift_ppm : float
        The cameras' clock against the host's.
    latency_s, latency_jitter_s : float
        From exposure to arrival at the host; the jitter only ever adds.
    frame : Offset
        The cameras' own frame in the arm's base frame.
    hand_markers, object_markers : Offset
        The frames that the cameras track, in {f} and in {b}.
    """

    rate_hz: float
    position_noise_m: float
    angle_noise_rad: float
    dropout_share: float
    clock_offset_s: float
    clock_drift_ppm: float
    latency_s: float
    latency_jitter_s: float
    frame: Offset = field(default_factory=Offset)
    hand_markers: Offset = field(default_factory=Offset)
    object_markers: Offset = field(default_factory=Offset)

    def __post_init__(self) -> None:
        if not self.rate_hz > 0.0:
            raise InputError(f"cameras: rate_hz must be positive, got {self.rate_hz!r}")


class Cameras:
    """Makes frames out of true poses; every random number comes from the generator that it is given."""

    def __init__(self, settings: CameraSettings, centre_m: FloatArray, random: np.random.Generator) -> None:
        self._settings, self._centre_m, self._random = settings, centre_m, random
        self._last_received_ns = 0
        from_base = Rotation.from_rotvec(settings.frame.rotation_rad).inv()
        self._from_base, self._turn_from_base = from_base.as_matrix(), from_base.as_quat(scalar_first=True)
        self._hand_markers, self._object_markers = (
            (one.position_m, Rotation.from_rotvec(one.rotation_rad).as_quat(scalar_first=True))
            for one in (settings.hand_markers, settings.object_markers)
        )

    def ticks(self, time_s: float) -> int:
        """Reading of the cameras' clock at a time on the host's."""
        rate = 1.0 + 1e-6 * self._settings.clock_drift_ppm
        return round((time_s * rate + self._settings.clock_offset_s) * TICKS_PER_S)

    def expose(
        self, frame: int, time_s: float, hand: tuple[FloatArray, FloatArray], block: tuple[FloatArray, FloatArray]
    ) -> MocapFrame:
        """One frame of the hand and the block, each a true position (3,) and rotation matrix (3, 3)."""
        delay = self._settings.latency_s + self._random.exponential(max(self._settings.latency_jitter_s, 1e-12))
        # Frames share one wire: a late one holds up those behind it.
        received_ns = max(round(1e9 * (time_s + delay)), self._last_received_ns + 1000)
        self._last_received_ns = received_ns
        seen = (self._see(hand, *self._hand_markers), self._see(block, *self._object_markers))
        return MocapFrame(frame, self.ticks(time_s), received_ns, *seen)

    def echo(self, time_s: float) -> ClockExchange:
        """Answer an echo that is sent now; the way there and the way back jitter apart."""
        there, back = ECHO_TRIP_S / 2 + self._random.exponential(5e-5, 2)
        return ClockExchange(
            sent_ns=round(1e9 * time_s),
            ticks=self.ticks(time_s + there),
            received_ns=round(1e9 * (time_s + there + back)),
        )

    def _see(self, body: tuple[FloatArray, FloatArray], markers_m: FloatArray, markers: FloatArray) -> BodyPose | None:
        position_m, matrix = body
        dropped = self._random.random() < self._settings.dropout_share
        noise_m = self._random.normal(0.0, self._settings.position_noise_m, 3)
        noise_rad = self._random.normal(0.0, self._settings.angle_noise_rad, 3)
        if dropped or np.linalg.norm(position_m - self._centre_m) > CAPTURE_RADIUS_M:
            return None
        place_m = self._from_base @ (position_m + matrix @ markers_m - self._settings.frame.position_m)
        w, *xyz = _product(_of_vector(noise_rad), self._turn_from_base, _of_matrix(matrix), markers)
        turn = np.array([*xyz, w])
        return BodyPose(_on_the_wire(place_m + noise_m), _on_the_wire(turn if w >= 0.0 else -turn))


# Two poses a frame, while the emulator keeps time: MuJoCo's quaternions, scalar first, cost a tenth of scipy's.


def _of_vector(rotation_rad: FloatArray) -> FloatArray:
    turn, angle_rad = np.empty(4), float(np.linalg.norm(rotation_rad))
    mujoco.mju_axisAngle2Quat(turn, rotation_rad / max(angle_rad, 1e-300), angle_rad)
    return turn


def _of_matrix(matrix: FloatArray) -> FloatArray:
    turn = np.empty(4)
    mujoco.mju_mat2Quat(turn, matrix.ravel())
    return turn


def _product(first: FloatArray, *others: FloatArray) -> FloatArray:
    turn = first
    for other in others:
        turn, left = np.empty(4), turn
        mujoco.mju_mulQuat(turn, left, other)
    return turn


def _on_the_wire(values: FloatArray) -> FloatArray:
    """The cameras send single precision."""
    return np.asarray(values, dtype=np.float32).astype(np.float64)
