"""Which friction a plan survives: the trial simulated for many frictions, Theorem 1 carried over to the plane.

A trial survives where the finger stays on the object's face, the object ends stuck and turned in the hand by less than
0.3 rad from what it should, and the finger ends nearer to its goal than it began: then the next trial has less to do.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from slidepipe.mechanics.dynamics import Block
from slidepipe.mechanics.hand_motion import HandMotion
from slidepipe.mechanics.parameters import ParameterSets
from slidepipe.mechanics.planar import rotation
from slidepipe.mechanics.simulate import Ended, simulate_many
from slidepipe.mechanics.stepping import PlacedFinger, step_through
from slidepipe.planning.course import Course, CourseMotion, lone
from slidepipe.series import BoolArray, FloatArray, IntArray

MOST_TURN_RAD = 0.3
RATIOS = np.round(np.arange(0.4, 1.8001, 0.02), 6)
"""Frictions that are tried, beside the believed one."""
REFINED = 11
ROUNDS = 3
EVERY, STEP_S = 5, 1e-3
"""For fingers apart from each other, whose trials take a thousand times as long: every fifth friction, and the step."""
REST_S = 0.3
SURVIVED, LEFT, SLIDING, TURNED, NO_NEARER, NO_SLIDE = range(6)
WHY = {
    SURVIVED: "nothing within what was tried",
    LEFT: "the finger slides off the object's face",
    SLIDING: "the object does not come to rest in the hand",
    TURNED: f"the object turns more than {MOST_TURN_RAD:g} rad in the hand",
    NO_NEARER: "the finger ends no nearer to its goal than it began",
    NO_SLIDE: "the object does not slide",
}


@dataclass(frozen=True, slots=True)
class Survival:
    """What becomes of a plan when the friction is not what was believed.

    Attributes
    ----------
    ratio : (K,)
        Friction beside the believed one.
    r_f_b : (K, 3)
        Where the finger ends on the object, m and rad.
    error : (K,)
        Distance left to the goal beside the distance at the start, a radian counting as c a.
    verdict : (K,)
        0 where it survives, else a key of :data:`WHY`.
    below, above : float
        Largest share by which the friction may be less, and more, without a failure on the way.
    why_below, why_above : str
        What fails there.
    """

    ratio: FloatArray
    r_f_b: FloatArray
    error: FloatArray
    verdict: IntArray
    below: float
    above: float
    why_below: str
    why_above: str

    @property
    def friction_error(self) -> float:
        """The largest share by which the friction may be wrong either way: eps* of Theorem 1."""
        return min(self.below, self.above)

    def contraction(self, friction_error: float) -> float:
        """Largest share of the error that is left while the friction is wrong by no more than this: Theorem 1's k."""
        inside = np.abs(self.ratio - 1.0) <= friction_error + 1e-9
        return float(np.max(self.error[inside]))


@dataclass(frozen=True, slots=True)
class _Trials:
    r_f_b: FloatArray
    left: BoolArray
    stuck: BoolArray


Trial = Callable[[FloatArray], _Trials]


def survival(course: Course, block: Block, fingers: tuple[PlacedFinger, ...]) -> Survival:
    """Simulate a plan's trial for many frictions and find where it first fails, below and above the believed one."""
    hand = _with_rest(CourseMotion(course, block, fingers).hand_motion())
    trial = _lone_trial(hand, course, block, fingers) if lone(fingers) else _stepped_trial(hand, course, block, fingers)
    rho = sum(p.finger.f_N * p.finger.a * p.finger.c for p in fingers) / sum(p.finger.f_N for p in fingers)

    def judged(ratio: FloatArray) -> tuple[FloatArray, FloatArray, IntArray]:
        trials = trial(ratio)
        error = _distance(trials.r_f_b, course.r_goal, rho) / _distance(course.r_start, course.r_goal, rho)
        return trials.r_f_b, error, _verdict(trials, error, course)

    ratios = RATIOS if lone(fingers) else RATIOS[::EVERY]
    r_f_b, error, verdict = judged(ratios)
    below, why_below = _first_failure(judged, ratios, verdict, -1)
    above, why_above = _first_failure(judged, ratios, verdict, 1)
    return Survival(ratios, r_f_b, error, verdict, below, above, why_below, why_above)


def _first_failure(
    judged: Callable[[FloatArray], tuple[FloatArray, FloatArray, IntArray]],
    ratio: FloatArray,
    verdict: IntArray,
    way: int,
) -> tuple[float, str]:
    """Share of the friction up to the first failure one way, and what fails."""
    order = np.argsort(way * ratio)
    outward = order[way * (ratio[order] - 1.0) >= -1e-9]
    failed = np.flatnonzero(verdict[outward])
    if not len(failed):
        return abs(float(ratio[outward[-1]]) - 1.0), WHY[SURVIVED]
    bad = outward[failed[0]]
    low, high, reason = (1.0 if failed[0] == 0 else ratio[outward[failed[0] - 1]]), ratio[bad], verdict[bad]
    for _ in range(ROUNDS if len(ratio) == len(RATIOS) else 1):
        between = np.linspace(low, high, REFINED)
        found = judged(between)[2]
        first = int(np.argmax(found != SURVIVED))
        if found[first] == SURVIVED:
            break
        low, high, reason = between[max(first - 1, 0)], between[first], found[first]
    return abs(float(low) - 1.0), WHY[int(reason)]


def _verdict(trials: _Trials, error: FloatArray, course: Course) -> IntArray:
    turned = np.abs(trials.r_f_b[:, 2] - course.r_goal[2]) >= MOST_TURN_RAD
    still = np.all(np.abs(trials.r_f_b - course.r_start) < 1e-6, axis=1)
    checks = [trials.left, ~trials.stuck, still, turned, error >= 1.0]
    verdicts = [LEFT, SLIDING, NO_SLIDE, TURNED, NO_NEARER]
    return np.asarray(np.select(checks, verdicts, SURVIVED))


def _lone_trial(hand: HandMotion, course: Course, block: Block, fingers: tuple[PlacedFinger, ...]) -> Trial:
    finger = fingers[0].finger

    def trial(ratio: FloatArray) -> _Trials:
        outcomes = simulate_many(hand, ParameterSets.of(block, finger, course.r_start, mu=finger.mu * ratio))
        return _Trials(outcomes.r_f_b, outcomes.ended == Ended.LEFT, outcomes.ended == Ended.STUCK)

    return trial


def _stepped_trial(hand: HandMotion, course: Course, block: Block, fingers: tuple[PlacedFinger, ...]) -> Trial:
    time_s = np.arange(hand.breaks[0], hand.breaks[-1] + REST_S, STEP_S)
    q_f = hand.at(time_s)
    half, places = 0.5 * np.array([block.length, block.width]), np.array([p.place for p in fingers])

    def trial(ratio: FloatArray) -> _Trials:
        paths = np.array([step_through(time_s, q_f, block, _rubbed(fingers, r), course.r_start).r_f_b for r in ratio])
        at = paths[:, :, None, :2] + np.einsum("ktij,nj->ktni", rotation(paths[:, :, 2])[..., :2, :2], places)
        left = np.any(np.abs(at) > half, axis=(1, 2, 3))
        return _Trials(paths[:, -1], left, np.all(np.abs(paths[:, -1] - paths[:, -2]) < 1e-9, axis=1))

    return trial


def _rubbed(fingers: tuple[PlacedFinger, ...], ratio: float) -> tuple[PlacedFinger, ...]:
    return tuple(replace(p, finger=replace(p.finger, mu=p.finger.mu * ratio)) for p in fingers)


def _with_rest(hand: HandMotion) -> HandMotion:
    """The motion after a rest, in which a weak grip lets the object slip already."""
    still = np.zeros_like(hand.coefficients[:1])
    still[0, 0] = hand.coefficients[0, 0]
    return HandMotion(
        breaks=np.concatenate([[hand.breaks[0] - REST_S], hand.breaks]),
        coefficients=np.concatenate([still, hand.coefficients]),
        jumps=np.concatenate([[True], hand.jumps]),
    )


def _distance(a: FloatArray, b: FloatArray, rho: float) -> FloatArray:
    return np.asarray(np.linalg.norm((a - b) * np.array([1.0, 1.0, rho]), axis=-1))
