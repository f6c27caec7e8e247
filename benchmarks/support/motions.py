"""Motions to measure with: the paper's two regrasps, and random ones of their kind."""

from dataclasses import dataclass, replace

import numpy as np

from slidepipe.mechanics.dynamics import Block
from slidepipe.mechanics.hand_motion import HandMotion
from slidepipe.mechanics.limit_surface import SoftFinger
from slidepipe.mechanics.planar import rotation
from slidepipe.mechanics.stepping import PlacedFinger
from slidepipe.planning.three_phase import Regrasp, ThreePhaseMotion
from slidepipe.series import FloatArray

MILLISECONDS = 1e3
FASTEST_M_S = 3.0
"""Of a random motion's hand."""
STICKS = 0.95
"""Largest share of the friction that a random motion uses while it is to stick."""


@dataclass(frozen=True, slots=True)
class Case:
    """A block in a hand that moves; ``r_f_b`` (3,) is where the hand holds it first."""

    name: str
    block: Block
    fingers: tuple[PlacedFinger, ...]
    hand: HandMotion
    r_f_b: FloatArray

    @property
    def lone(self) -> SoftFinger | None:
        """The finger, where there is only one at the hand's origin."""
        first = self.fingers[0]
        return first.finger if len(self.fingers) == 1 and not np.any(first.place) else None

    def with_friction(self, share: float) -> "Case":
        """The same motion with every friction coefficient multiplied."""
        rubbed = [replace(f, finger=replace(f.finger, mu=f.finger.mu * share)) for f in self.fingers]
        return replace(self, fingers=tuple(rubbed))

    def margin_m(self, r_f_b: FloatArray) -> float:
        """How far inside the face the outermost finger stays along relative poses (T, 3)."""
        places = np.array([placed.place for placed in self.fingers])
        turned = np.einsum("tij,nj->tni", rotation(r_f_b[:, 2])[:, :2, :2], places)
        inside = np.array([self.block.length, self.block.width]) / 2 - np.abs(r_f_b[:, None, :2] + turned)
        return float(np.min(inside))


def linear() -> Case:
    """Section VIII-A with 1.25 N in all."""
    start, goal = np.array([-0.01, -0.02, np.pi]), np.array([0.01, 0.02, np.pi])
    return _paper("VIII-A", start, goal, settle_s=1.1, finger=SoftFinger(0.38, 1.25, 0.0174, 0.6))


def rotational() -> Case:
    """Section VIII-B with 2.5 N in all."""
    start, goal = np.array([-0.01, 0.04, 0.75 * np.pi]), np.array([0.01, 0.04, np.pi])
    return _paper("VIII-B", start, goal, settle_s=0.3, finger=SoftFinger(0.38, 2.5, 0.05, 0.6))


def random_case(random: np.random.Generator, name: str, count: int) -> Case:
    """A three-phase motion for one equivalent finger, with that finger's force spread over ``count`` in the hand."""
    while True:
        regrasp, block, finger = _random_regrasp(random)
        motion = ThreePhaseMotion(regrasp, block, finger)
        if _reasonable(motion):
            break
    places = random.uniform(-0.015, 0.015, (count, 2)) if count > 1 else np.zeros((1, 2))
    share = replace(finger, f_N=finger.f_N / count)
    fingers = tuple(PlacedFinger(share, place) for place in places)
    return Case(name, block, fingers, motion.hand_motion(), regrasp.r_start)


def _paper(name: str, start: FloatArray, goal: FloatArray, *, settle_s: float, finger: SoftFinger) -> Case:
    block = Block(length=0.06, width=0.1, m=0.023)
    regrasp = Regrasp(np.zeros(3), start, goal, goal, T1=0.3, T23=0.2, T4=settle_s)
    hand = ThreePhaseMotion(regrasp, block, finger).hand_motion()
    return Case(name, block, (PlacedFinger(finger, np.zeros(2)),), hand, start)


def _random_regrasp(random: np.random.Generator) -> tuple[Regrasp, Block, SoftFinger]:
    block = Block(random.uniform(0.06, 0.12), random.uniform(0.06, 0.12), random.uniform(0.02, 0.2))
    mu, acceleration = random.uniform(0.2, 0.7), random.uniform(15.0, 45.0)
    finger = SoftFinger(mu, acceleration * block.m / mu, random.uniform(0.01, 0.04), 0.6)
    half = 0.25 * np.array([block.length, block.width])
    start = np.append(random.uniform(-half, half), random.uniform(-np.pi, np.pi))
    goal = np.append(random.uniform(-half, half), start[2] + random.uniform(-1.0, 1.0))
    end = np.append(random.uniform(-0.1, 0.1, 2), goal[2])
    stick_s, slide_s, settle_s = (
        np.round(MILLISECONDS * random.uniform([0.2, 0.05, 0.2], [0.4, 0.12, 0.8])) / MILLISECONDS
    )
    return Regrasp(np.zeros(3), start, goal, end, stick_s, 2.0 * slide_s, settle_s), block, finger


def _reasonable(motion: ThreePhaseMotion) -> bool:
    _, slide_s, _, settle_s, end_s = motion.regrasp.boundaries
    time_s = np.linspace(0.0, end_s, 400)
    sampled = motion.sample(time_s)
    sticks = (time_s < slide_s) | (time_s > settle_s)
    fast = np.max(np.linalg.norm(sampled.dq_f[:, :2], axis=1)) > FASTEST_M_S
    return not fast and bool(np.max(sampled.load[sticks]) < STICKS)
