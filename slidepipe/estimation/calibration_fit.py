"""The least squares behind a calibration: robot-world and hand-eye in one, with the delay between the two clocks."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import OptimizeResult, least_squares
from scipy.spatial.transform import Rotation, RotationSpline

from slidepipe.errors import EstimationError, InputError
from slidepipe.estimation.clock import fit_clock
from slidepipe.estimation.plane import to_plane
from slidepipe.mechanics.planar import MotionPlane
from slidepipe.series import BoolArray, FloatArray, MocapSeries, PoseSeries

FEWEST_FRAMES = 50
ON_A_HAND_M = 0.2
"""How far from the finger the hand's markers may be: one standard deviation of what is known beforehand."""
IN_PLANE_M = 0.005
"""How far out of the plane the object's markers may be that a motion in the plane says nothing of."""
LONGEST_DELAY_S = 0.05
OUTLIER = 5.0
SPIN_STEP_S = 1e-4
ROUNDS = 2
ROUGH = np.repeat([0.002, 0.02], 3)
"""Weights of the first fit: m, and rad."""
ROUGH_FRAMES = 60
MOST_TRIES = 40
STEPS = np.array([0.1] * 12 + [0.001])
QUARTERS = (0.0, np.pi / 2.0, np.pi, -np.pi / 2.0)


@dataclass(frozen=True, slots=True)
class CalibrationRequest:
    """A motion as the cameras saw it, and as the joints say it was.

    Attributes
    ----------
    mocap : MocapSeries
        Hand's markers and object in the cameras' frame, and the clock exchanges.
    finger : PoseSeries
        {f} in the base frame by the measured joints, on the host's clock.
    plane : MotionPlane
        {w} in the base frame.
    """

    mocap: MocapSeries
    finger: PoseSeries
    plane: MotionPlane


@dataclass(frozen=True, slots=True)
class Problem:
    """Frames with the hand in them: time, markers in the cameras' frame; the finger by the joints at these times.

    The finger is taken at ``delay_s`` after each frame, and on from there at its velocity, m/s, and spin, rad/s in {f}.
    """

    time_s: FloatArray
    position_m: FloatArray
    turn: Rotation
    object_m: FloatArray
    object_turn: Rotation
    plane: MotionPlane
    path: "JointPath"
    delay_s: float
    finger_m: FloatArray
    finger_turn: Rotation
    velocity: FloatArray
    spin: FloatArray

    def residual(self, x: FloatArray) -> FloatArray:
        """(T, 6) position, m, and rotation vector, rad, by which the two sides differ.

        ``x`` holds the rotation vector and the position of the cameras in the base, the rotation vector of {f} in the
        hand's markers, the markers' place in {f}, and the delay.
        """
        base, hand, later = Rotation.from_rotvec(x[0:3]), Rotation.from_rotvec(x[6:9]), x[12] - self.delay_s
        finger = self.finger_turn * Rotation.from_rotvec(self.spin * later)
        # The markers' place goes by the joints' angles: the cameras' are noisy, and noise in a lever pulls it to zero.
        markers_m = self.finger_m + self.velocity * later + finger.apply(x[9:12])
        away = base.apply(self.position_m) + x[3:6] - markers_m
        return np.hstack([away, (finger.inv() * base * self.turn * hand).as_rotvec()])

    def at(self, delay_s: float) -> "Problem":
        """Return the same with the finger taken after another delay, which is where it is exact."""
        when = self.time_s + delay_s
        turn = self.path.turn(when)
        return replace(
            self,
            delay_s=delay_s,
            finger_m=self.path.place_m(when),
            finger_turn=turn,
            velocity=self.path.place_m(when, 1),
            spin=(turn.inv() * self.path.turn(when + SPIN_STEP_S)).as_rotvec() / SPIN_STEP_S,
        )


@dataclass(frozen=True, slots=True)
class JointPath:
    """{f} in the base frame by the joints, at any time."""

    place_m: CubicSpline
    turn: RotationSpline


def make_problem(request: CalibrationRequest) -> Problem:
    """Put the cameras' frames and the joints on one time, and say what is wrong with them."""
    mocap, finger = request.mocap, request.finger
    for name, body in (("hand", mocap.hand), ("object", mocap.object)):
        to_plane(name, body, request.plane)  # which says what is wrong with a series
    if len(finger.stamp_ns) < FEWEST_FRAMES or np.any(np.diff(finger.stamp_ns) <= 0):
        raise InputError(
            f"calibration: the joints' stamps must increase and be {FEWEST_FRAMES} at least, got {len(finger.stamp_ns)}"
        )
    zero_ns = int(finger.stamp_ns[0])
    joints_s = 1e-9 * (finger.stamp_ns - zero_ns)
    frames = mocap.frames
    rows = np.minimum(np.searchsorted(frames.frame, mocap.hand.sequence), len(frames.frame) - 1)
    time_s = 1e-9 * (fit_clock(mocap.clock).to_host(frames.ticks[rows]) - zero_ns)
    inside = frames.hand_valid[rows] & (frames.frame[rows] == mocap.hand.sequence)
    inside &= (time_s > joints_s[0] + LONGEST_DELAY_S) & (time_s < joints_s[-1] - LONGEST_DELAY_S)
    if np.count_nonzero(inside) < FEWEST_FRAMES:
        raise EstimationError(
            f"calibration: the hand was tracked in {np.count_nonzero(inside)} frames while the joints were recorded, "
            f"at least {FEWEST_FRAMES} are needed"
        )
    still = np.zeros((np.count_nonzero(inside), 3))
    path = JointPath(
        CubicSpline(joints_s, finger.position_m), RotationSpline(joints_s, Rotation.from_quat(finger.quaternion_xyzw))
    )
    return Problem(
        time_s=time_s[inside],
        position_m=mocap.hand.position_m[inside],
        turn=Rotation.from_quat(mocap.hand.quaternion_xyzw[inside]),
        object_m=mocap.object.position_m,
        object_turn=Rotation.from_quat(mocap.object.quaternion_xyzw)
        if len(mocap.object.sequence)
        else Rotation.identity(0),
        plane=request.plane,
        path=path,
        delay_s=0.0,
        finger_m=still,
        finger_turn=Rotation.identity(len(still)),
        velocity=still,
        spin=still,
    ).at(0.0)


def _start(problem: Problem, about_normal_rad: float) -> FloatArray:
    """Cameras by the best rigid fit of the two paths about their middles, turned on; the hand by the rotation left."""
    finger, seen = problem.finger_m, problem.position_m
    base, _ = Rotation.align_vectors(finger - finger.mean(axis=0), seen - seen.mean(axis=0))
    base = Rotation.from_rotvec(about_normal_rad * problem.plane.axes[:, 2]) * base
    hand = ((base * problem.turn).inv() * problem.finger_turn).mean()
    shift = finger.mean(axis=0) - base.apply(seen.mean(axis=0))
    return np.concatenate([base.as_rotvec(), shift, hand.as_rotvec(), np.zeros(4)])


def rough_fit(problem: Problem) -> FloatArray:
    """The best of four rough fits: markers far from the finger bend the path that the first guess goes by."""
    few = np.arange(len(problem.time_s)) % max(1, len(problem.time_s) // ROUGH_FRAMES) == 0
    best = _round(problem, few, _start(problem, QUARTERS[0]), ROUGH, loss="soft_l1")
    for turn in QUARTERS[1:]:
        if best.cost < np.count_nonzero(few):
            break
        found = _round(problem, few, _start(problem, turn), ROUGH, loss="soft_l1")
        best = found if found.cost < best.cost else best
    return np.asarray(best.x)


def fine_fit(problem: Problem, kept: BoolArray, start: FloatArray) -> OptimizeResult:
    """Weigh positions and angles by their own residuals, and take the finger at the delay that was found."""
    x, scale = start, ROUGH
    for _ in range(ROUNDS):
        problem = problem.at(float(x[12]))
        left = problem.residual(x)[kept]
        scale = np.repeat([_spread(left[:, :3]), _spread(left[:, 3:])], 3)
        x = _round(problem, kept, x, scale, loss="linear").x
    return _round(problem, kept, x, scale, loss="linear")


def _round(problem: Problem, kept: BoolArray, x: FloatArray, scale: FloatArray, *, loss: str) -> OptimizeResult:
    """One least squares fit; what is known beforehand holds what the motion does not tell."""
    middle, normal = np.median(problem.object_m, axis=0) if len(problem.object_m) else None, problem.plane.axes[:, 2]

    def whole(x: FloatArray) -> FloatArray:
        known = np.append(x[9:12] / ON_A_HAND_M, x[12] / LONGEST_DELAY_S)
        if middle is not None:
            place = Rotation.from_rotvec(x[0:3]).apply(middle) + x[3:6] - problem.plane.origin_m
            known = np.append(known, normal @ place / IN_PLANE_M)
        return np.concatenate([np.ravel(problem.residual(x)[kept] / scale), known])

    return least_squares(whole, x, loss=loss, x_scale=STEPS, max_nfev=MOST_TRIES)


def _spread(values: FloatArray) -> float:
    return max(1.4826 * float(np.median(np.abs(values))), 1e-7)


def inliers(problem: Problem, x: FloatArray) -> BoolArray:
    """(T,) frames whose residuals are no outliers among all of them."""
    left = np.abs(problem.residual(x))
    bounds = np.repeat([OUTLIER * _spread(left[:, :3]), OUTLIER * _spread(left[:, 3:])], 3)
    return np.asarray(np.all(left <= bounds, axis=1))
