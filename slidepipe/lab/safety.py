"""What is watched while the arm moves, and why it is stopped."""

from dataclasses import dataclass
from enum import Enum

import numpy as np

from slidepipe.lab.protocols import JointCommand, JointState, MocapFrame
from slidepipe.lab.swap import SwapWatch
from slidepipe.series import FloatArray


class StopCause(Enum):
    """Why an arm was stopped on its way."""

    TRACKING = "tracking error"
    JOINT_LIMIT = "joint limit"
    LINK = "link lost"
    ARM = "arm fault"
    MOCAP = "cameras lost"
    SWAP = "markers swapped"
    OBJECT = "object lost"
    OPERATOR = "Ctrl-C"
    ALONE = "left alone"


@dataclass(frozen=True, slots=True)
class Stop:
    """A stop: why, in which words, and when it began."""

    cause: StopCause
    text: str
    stamp_ns: int

    def __str__(self) -> str:
        """``cause: text``."""
        return f"{self.cause.value}: {self.text}"


@dataclass(frozen=True, slots=True)
class SafetyLimits:
    """Bounds of what is let go on.

    Attributes
    ----------
    tracking_error_rad : (7,)
        Between what was commanded a tick ago and what is measured.
    lower_rad, upper_rad : (7,)
        Where the joints may be.
    link_timeout_s, mocap_timeout_s, object_timeout_s : float
        How long the arm, the cameras with the hand in their sight, and the object may not be heard of.
    object_reach_m : float
        From the hand to the middle of the object while it is held.
    """

    tracking_error_rad: FloatArray
    lower_rad: FloatArray
    upper_rad: FloatArray
    link_timeout_s: float
    mocap_timeout_s: float
    object_timeout_s: float
    object_reach_m: float


FAR_FRAMES = 5
"""Frames one after the other with the object out of reach before it counts as lost: one may be a wrong pose."""


class Guard:
    """Looks at every tick and every frame; the first thing that is wrong is the reason to stop."""

    def __init__(self, limits: SafetyLimits) -> None:
        self._limits = limits
        self._frame_ns = self._hand_ns = self._object_ns = -1
        self._far, self._number = 0, -1
        self._swap = SwapWatch()

    def begin(self, now_ns: int) -> None:
        """Count silence from now on."""
        self._frame_ns, self._hand_ns, self._object_ns = (max(at, now_ns) for at in self._heard)

    def frame(self, frame: MocapFrame, now_ns: int) -> None:
        """Take note of a frame that has arrived by now; one that came before tells nothing new."""
        if frame.frame == self._number:
            return
        self._number, self._frame_ns = frame.frame, now_ns
        if frame.hand is not None:
            self._hand_ns = now_ns
        if frame.object is not None:
            self._object_ns = now_ns
        if frame.hand is not None and frame.object is not None:
            self._swap.see(frame.hand, frame.object, now_ns)
            apart_m = np.linalg.norm(frame.hand.position_m - frame.object.position_m)
            self._far = self._far + 1 if apart_m > self._limits.object_reach_m else 0

    def check(self, commanded: JointCommand, state: JointState) -> Stop | None:
        """Find what is wrong at a tick, given what was commanded a tick ago: the arm first, then the cameras."""
        found = self._link(state) or self._arm(commanded, state) or self._cameras(state.stamp_ns)
        return None if found is None else Stop(found[0], found[1], state.stamp_ns)

    @property
    def swaps(self) -> int:
        """How often hand and object changed names from one frame to the next."""
        return self._swap.count

    def error(self, commanded: JointCommand, state: JointState) -> float:
        """Largest tracking error of a joint, rad."""
        return float(np.abs(commanded.position_rad - state.position_rad).max())

    @property
    def _heard(self) -> "tuple[int, ...]":
        return self._frame_ns, self._hand_ns, self._object_ns

    def _link(self, state: JointState) -> "tuple[StopCause, str] | None":
        age_s, allowed_s = 1e-9 * state.link.age_ns, self._limits.link_timeout_s
        if state.link.fault:
            return StopCause.ARM, "its own checks have stopped it"
        if age_s > allowed_s:
            return StopCause.LINK, f"nothing heard of the arm for {_ms(age_s)}, allowed are {_ms(allowed_s)}"
        if not state.link.linked:
            return StopCause.LINK, "the arm no longer follows our commands"
        return None

    def _arm(self, commanded: JointCommand, state: JointState) -> "tuple[StopCause, str] | None":
        error, allowed = np.abs(commanded.position_rad - state.position_rad), self._limits.tracking_error_rad
        if (error > allowed).any():
            joint = int(np.argmax(error / allowed))
            return StopCause.TRACKING, f"joint {joint + 1} is {error[joint]:.3f} rad off, allowed {allowed[joint]:.3f}"
        lower, upper, at = self._limits.lower_rad, self._limits.upper_rad, state.position_rad
        if (at < lower).any() or (at > upper).any():
            joint = int(np.argmax(np.maximum(lower - at, at - upper)))
            return StopCause.JOINT_LIMIT, (
                f"joint {joint + 1} is at {at[joint]:.3f} rad, allowed {lower[joint]:.3f} to {upper[joint]:.3f}"
            )
        return None

    def _cameras(self, now_ns: int) -> "tuple[StopCause, str] | None":
        limits = self._limits
        for what, since_ns, allowed_s, cause in (
            ("no new frame", self._frame_ns, limits.mocap_timeout_s, StopCause.MOCAP),
            ("the hand was not seen", self._hand_ns, limits.mocap_timeout_s, StopCause.MOCAP),
            ("the object was not seen", self._object_ns, limits.object_timeout_s, StopCause.OBJECT),
        ):
            if 1e-9 * (now_ns - since_ns) > allowed_s:
                return cause, f"{what} for {_ms(1e-9 * (now_ns - since_ns))}, allowed are {_ms(allowed_s)}"
        if self._swap.lasts_s(now_ns) > limits.mocap_timeout_s:
            return StopCause.SWAP, "the cameras took the hand for the object and the object for the hand"
        if self._far >= FAR_FRAMES:
            return StopCause.OBJECT, f"it is farther than {1e3 * limits.object_reach_m:.0f} mm from the hand"
        return None


def _ms(value_s: float) -> str:
    return f"{1e3 * value_s:.0f} ms"
