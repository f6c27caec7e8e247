"""The simulated lab in virtual time: an arm, a gripper and a block in MuJoCo, watched by simulated cameras."""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

import numpy as np
from scipy.interpolate import CubicHermiteSpline
from scipy.spatial.transform import Rotation

from slidepipe.lab.cameras import TICKS_PER_S, Cameras, CameraSettings
from slidepipe.lab.controller import JointController, read_encoders, to_drive
from slidepipe.lab.protocols import ClockExchange, JointCommand, JointState, MocapFrame
from slidepipe.lab.world import PRESCRIBED_INERTIA, World, WorldSettings
from slidepipe.mechanics.planar import relative_pose
from slidepipe.series import FloatArray, PoseSeries
from slidepipe.tick import TICK_S

HOST_START_NS = 1_000_000_000
"""The virtual host's clock when the world begins: no stamp is ever before its zero."""


class Tracker(Enum):
    """How the simulated arm follows its commands."""

    PERFECT = "perfect"
    """Exactly, one tick late."""
    FEEDFORWARD = "feedforward"
    """The vendor's joint control with inverse-dynamics feedforward."""
    VENDOR = "vendor"
    """The vendor's joint control alone."""


@dataclass(frozen=True, slots=True)
class Truth:
    """What really happened: poses at every exposure on the host's clock, and the relative pose (T, 3) in {b}."""

    hand: PoseSeries
    object: PoseSeries
    r_f_b: FloatArray


class SimulatedLab:
    """An arm and cameras over one simulated world; implements ``Arm`` and ``MotionCapture``.

    Parameters
    ----------
    settings : WorldSettings
    tracker : Tracker
    cameras : CameraSettings
    joints_rad : (7,)
        Where the arm rests.
    r_f_b : (3,)
        Where the finger holds the block, in {b}.
    random : numpy.random.Generator
        Where the cameras' noise comes from.
    history : int, optional
        How many exposures are remembered for the truth; all of them unless told otherwise.
    """

    def __init__(
        self,
        settings: WorldSettings,
        tracker: Tracker,
        cameras: CameraSettings,
        joints_rad: FloatArray,
        r_f_b: FloatArray,
        *,
        random: np.random.Generator,
        history: int | None = None,
    ) -> None:
        self._world = World(settings, joints_rad, r_f_b)
        self._start_angle_rad = float(r_f_b[2])
        self._controller = JointController(settings.tool, feedforward=tracker is Tracker.FEEDFORWARD)
        self._prescribed = tracker is Tracker.PERFECT
        self._target = (np.array(joints_rad, dtype=float), np.zeros_like(joints_rad))
        self._cameras = Cameras(cameras, settings.plane.origin_m, random)
        self._timestep_s = settings.contact.timestep_s
        self._steps_per_tick = round(TICK_S / self._timestep_s)
        self._frame_period_s = 1.0 / cameras.rate_hz
        self._steps = 0
        self._frames: deque[MocapFrame] = deque()
        self._exposures: deque[_Exposure] = deque(maxlen=history)
        self._exposed = 0

    @property
    def ticks_per_s(self) -> float:
        """Rate of the cameras' clock."""
        return TICKS_PER_S

    def exchange(self, command: JointCommand) -> JointState:
        """Advance the world by one tick under a command; returns what was measured when the tick began."""
        measured = read_encoders(self._world.joints_rad)
        torque = to_drive(self._controller.torque(command, measured))
        state = JointState(self._now_ns(), measured, self._controller.velocity_rad_s.copy(), torque)
        if self._prescribed:
            self._follow(command)
        else:
            self._world.torque[:] = torque
            self._advance(self._steps_per_tick)
        return state

    def take(self) -> list[MocapFrame]:
        """Frames that have arrived by now."""
        arrived = []
        while self._frames and self._frames[0].received_ns <= self._now_ns():
            arrived.append(self._frames.popleft())
        return arrived

    def echo(self) -> ClockExchange:
        """Ask the cameras for their clock."""
        return self._cameras.echo(1e-9 * HOST_START_NS + self._world.time_s)

    def camera_ticks(self, host_ns: int) -> int:
        """Reading of the cameras' clock at a time on the virtual host's."""
        return self._cameras.ticks(1e-9 * host_ns)

    def relative_pose(self) -> FloatArray:
        """Pose (3,) of {f} in {b} now, wherever the hand is; the angle within half a turn of the one at the start."""
        (hand_m, hand), (block_m, block) = self._world.hand(), self._world.block()
        x, y, _ = block.T @ (hand_m - block_m)
        turn = block.T @ hand
        angle = np.arctan2(turn[1, 0], turn[0, 0])
        angle += 2 * np.pi * np.round((self._start_angle_rad - angle) / (2 * np.pi))
        return np.array([x, y, angle])

    def truth(self) -> Truth:
        """What no camera saw."""
        hand = _series(self._exposures, [e.hand for e in self._exposures])
        block = _series(self._exposures, [e.block for e in self._exposures])
        plane = self._world.settings.plane
        q_f = np.array([plane.project(*e.hand) for e in self._exposures])
        q_o = np.array([plane.project(*e.block) for e in self._exposures])
        r_f_b = relative_pose(q_o, q_f)
        turns = np.unwrap(r_f_b[:, 2])
        turns += 2 * np.pi * np.round((self._start_angle_rad - turns[0]) / (2 * np.pi))
        return Truth(hand, block, np.column_stack([r_f_b[:, :2], turns]))

    def _now_ns(self) -> int:
        return HOST_START_NS + round(1e9 * self._steps * self._timestep_s)

    def _follow(self, command: JointCommand) -> None:
        """Move the prescribed arm from the last command to this one on a cubic, step by step.

        The speed of each step is the one that carries MuJoCo's semi-implicit integrator exactly to the next position;
        the cubic's own speed would leave the block behind the hand by half a step of it.
        """
        last, target = self._target, (command.position_rad, command.velocity_rad_s)
        positions = _cubic(np.arange(self._steps_per_tick + 1) / self._steps_per_tick, last, target)
        for position, speed in zip(positions[:-1], np.diff(positions, axis=0) / self._timestep_s, strict=True):
            self._world.joints_rad[:] = position
            change = speed - self._world.joint_speeds_rad_s
            self._world.torque[:] = PRESCRIBED_INERTIA * change / self._timestep_s
            self._advance(1)
        self._target = target

    def _advance(self, count: int) -> None:
        """Step the world, stopping for every exposure on the way."""
        end = self._steps + count
        while (due := round(self._exposed * self._frame_period_s / self._timestep_s)) <= end:
            self._step_to(due)
            self._expose()
        self._step_to(end)

    def _step_to(self, step: int) -> None:
        if step > self._steps:
            self._world.step(step - self._steps)
        self._steps = step

    def _expose(self) -> None:
        exposure = _Exposure(1e-9 * self._now_ns(), self._world.hand(), self._world.block())
        frame = self._cameras.expose(self._exposed, exposure.time_s, exposure.hand, exposure.block)
        self._exposures.append(exposure)
        self._exposed += 1
        self._frames.append(frame)


@dataclass(frozen=True, slots=True)
class _Exposure:
    """True poses at one instant of the host's clock: each a position (3,) and a matrix (3, 3) in the base frame."""

    time_s: float
    hand: tuple[FloatArray, FloatArray]
    block: tuple[FloatArray, FloatArray]


def _series(exposures: Sequence[_Exposure], poses: list[tuple[FloatArray, FloatArray]]) -> PoseSeries:
    matrices = np.array([matrix for _, matrix in poses])
    return PoseSeries(
        stamp_ns=np.array([round(1e9 * exposure.time_s) for exposure in exposures], dtype=np.int64),
        position_m=np.array([position for position, _ in poses]),
        quaternion_xyzw=Rotation.from_matrix(matrices).as_quat(canonical=True),
        sequence=np.arange(len(exposures), dtype=np.int64),
    )


def _cubic(share: FloatArray, start: tuple[FloatArray, FloatArray], end: tuple[FloatArray, FloatArray]) -> FloatArray:
    """Positions (K, 7) at shares (K,) of a tick between two joint states, each angles and speeds."""
    spline = CubicHermiteSpline([0.0, TICK_S], np.array([start[0], end[0]]), np.array([start[1], end[1]]))
    return np.asarray(spline(share * TICK_S))
