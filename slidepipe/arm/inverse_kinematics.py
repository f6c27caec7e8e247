"""Joint trajectories for hand trajectories, by mink's differential inverse kinematics on the nominal model."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import mink
import mujoco
import numpy as np
from numpy.polynomial import chebyshev
from scipy.spatial.transform import Rotation

from slidepipe.arm.model import HAND
from slidepipe.arm.self_motion_kernel import towards_posture
from slidepipe.errors import InfeasibleError
from slidepipe.series import FloatArray

APPROACH_POSTURE_COST = 1e-3
"""Weight of the posture beside the hand's pose on the way to the start of a path; along it the pose is exact."""
STEP_TOLERANCE_RAD = 3e-6
"""Steps after which none is made: the next would be about as long as the square of the last."""
EXACT_RAD = 1e-8
"""Steps that are not made, told by Newton's method before."""
MAX_STEPS = 50
POSITION_TOLERANCE_M = 1e-7
ANGLE_TOLERANCE_RAD = 1e-6
NODES = (8, 15, 29, 57)
"""How many points of a piece are solved for; at the first, a search that asked the arm knows the angles already."""
CONVERGED_RAD = 1e-8


@dataclass(frozen=True, slots=True)
class HandPath:
    """Hand poses in the base frame over time: (T,), (T, 3) and (T, 3, 3)."""

    time_s: FloatArray
    position_m: FloatArray
    matrix: FloatArray


@dataclass(frozen=True, slots=True)
class JointPath:
    """Joint motion over time: (T,) and (T, 7), in rad, rad/s and rad/s^2."""

    time_s: FloatArray
    position_rad: FloatArray
    velocity_rad_s: FloatArray
    acceleration_rad_s2: FloatArray


class InverseKinematics:
    """Answers hand poses with the joint angles nearest to a posture, within the joint limits.

    Parameters
    ----------
    model : mujoco.MjModel
        An arm with a hand site.
    posture_rad : (7,)
        What the redundancy keeps near, and where the search starts.
    """

    def __init__(self, model: mujoco.MjModel, posture_rad: FloatArray) -> None:
        self._configuration = mink.Configuration(model, q=np.array(posture_rad, dtype=float))
        self._hand = mink.FrameTask(HAND, "site", position_cost=1.0, orientation_cost=0.3)
        self._posture = mink.PostureTask(model, cost=APPROACH_POSTURE_COST)
        self._posture_rad = np.array(posture_rad, dtype=float)
        self._limits = [mink.ConfigurationLimit(model)]
        self._range_rad = model.jnt_range.T.copy()

    def approach(self, path: HandPath) -> None:
        """Come near the first pose of a path from wherever the search is, with the posture held loosely."""
        self._hand.set_target(_targets(path)[0])
        self._posture.set_target(self._posture_rad)
        _descend(lambda: self._step([self._hand, self._posture], []))

    def solve(self, path: HandPath, near: FloatArray | None = None) -> FloatArray:
        """Joint angles (T, 7) along a path, each sought from the one before or from ``near`` (T, 7).

        What ``near`` misses at one pose is added to it at the next.

        Raises
        ------
        InfeasibleError
            A pose is out of reach within the limits.
        """
        angles = np.empty((len(path.time_s), len(self._configuration.q)))
        missed = np.zeros(angles.shape[1])
        for index, target in enumerate(_targets(path)):
            if near is not None:
                self._configuration.update(np.clip(near[index] + missed, *self._range_rad))
            self._hand.set_target(target)
            angles[index] = self._pose(path.time_s[index])
            if near is not None:
                missed = angles[index] - near[index]
        return angles

    def _pose(self, time_s: float) -> FloatArray:
        """Nearest to the posture among the configurations that hold the hand exactly on its target."""
        _descend(self._step_along_self_motion)
        error = self._hand.compute_error(self._configuration)
        missed_m, missed_rad = np.linalg.norm(error[:3]), np.linalg.norm(error[3:])
        if missed_m > POSITION_TOLERANCE_M or missed_rad > ANGLE_TOLERANCE_RAD:
            raise InfeasibleError(
                f"inverse kinematics: the hand cannot reach its pose at t = {time_s:.3f} s within the joint limits: "
                f"{1e3 * missed_m:.3g} mm and {1e3 * missed_rad:.3g} mrad off (allowed: "
                f"{1e3 * POSITION_TOLERANCE_M:g} mm, {1e3 * ANGLE_TOLERANCE_RAD:g} mrad); "
                "move arm.plane or change arm.posture_rad"
            )
        return np.array(self._configuration.q)

    def _step_along_self_motion(self) -> float:
        """Step onto the target and to where the self-motion is nearest to the posture, as Newton's method tells it.

        Asked to go there instead of to the posture, steps that hold the pose converge as fast as the pose itself.
        """
        configuration = self._configuration
        jacobian = configuration.get_frame_jacobian(HAND, "site")
        twist, away = self._hand.compute_error(configuration), configuration.q - self._posture_rad
        onto_target, along = towards_posture(jacobian, twist, away)
        if np.max(np.abs(onto_target + along)) < EXACT_RAD:
            return 0.0
        self._posture.set_target(configuration.q + along)
        return self._step([self._posture], [self._hand])

    def _step(self, tasks: list[mink.Task], constraints: list[mink.Task]) -> float:
        """Step once; by how much the joint moves that moves most.

        Most steps stay within the ranges though none is asked for, and are the same without.
        """
        solve = partial(mink.solve_ik, self._configuration, tasks, 1.0, "daqp", constraints=constraints)
        step = solve(limits=[])
        lower, upper = self._range_rad
        if np.any(self._configuration.q + step < lower) or np.any(self._configuration.q + step > upper):
            step = solve(limits=self._limits)
        self._configuration.integrate_inplace(step, 1.0)
        return float(np.max(np.abs(step)))


def _descend(step: Callable[[], float]) -> None:
    """Step until there is nothing to gain, or no step that does: how far the hand misses its pose then tells."""
    with suppress(mink.NoSolutionFound):
        for _ in range(MAX_STEPS):
            if step() < STEP_TOLERANCE_RAD:
                break


def _targets(path: HandPath) -> list[mink.SE3]:
    """Poses as mink takes them."""
    quaternions = Rotation.from_matrix(path.matrix).as_quat(scalar_first=True)
    return [mink.SE3(values) for values in np.hstack([quaternions, path.position_m])]


def joint_path(
    kinematics: InverseKinematics,
    hand: Callable[[FloatArray], HandPath],
    time_s: FloatArray,
    boundaries_s: FloatArray,
    *,
    near: Callable[[FloatArray], FloatArray] | None = None,
) -> JointPath:
    """Joint motion for a motion of the hand that is smooth between boundaries and whose acceleration jumps there.

    The angles are solved for at the Chebyshev points of each piece, twice as many until their polynomial has converged.

    Parameters
    ----------
    kinematics : InverseKinematics
    hand : callable
        Poses of the hand at (K,) times.
    time_s : (T,)
        Where the joint motion is wanted; at a boundary the piece that begins there counts.
    boundaries_s : (B,)
        First and last included.
    near : callable, optional
        Joint angles (K, 7) to start from at (K,) times between two boundaries.

    Raises
    ------
    InfeasibleError
        A pose is out of reach within the limits, or the joints do not move smoothly.
    """
    if near is None:
        kinematics.approach(hand(boundaries_s[:1]))
    values = np.empty((3, len(time_s), 7))
    for start, stop in pairwise(boundaries_s):
        coefficients = _converged(kinematics, hand, float(start), float(stop), near)
        inside = time_s >= start - 1e-9
        share = 2.0 * (time_s[inside] - start) / (stop - start) - 1.0
        for order in range(3):
            scale = (2.0 / (stop - start)) ** order
            values[order, inside] = scale * chebyshev.chebval(share, chebyshev.chebder(coefficients, order)).T
    return JointPath(time_s, *values)


def _converged(
    kinematics: InverseKinematics,
    hand: Callable[[FloatArray], HandPath],
    start: float,
    stop: float,
    near: Callable[[FloatArray], FloatArray] | None,
) -> FloatArray:
    """Chebyshev coefficients (N, 7) of the joint angles along one piece."""
    points = _points(NODES[0])
    time_s = start + (stop - start) * points
    angles = kinematics.solve(hand(time_s), None if near is None else near(time_s))
    for count in NODES:
        coefficients = np.linalg.solve(chebyshev.chebvander(2.0 * points - 1.0, count - 1), angles)
        if np.max(np.abs(coefficients[-2:])) < CONVERGED_RAD:
            return np.asarray(coefficients)
        # The points between, sought from where the polynomial has them.
        finer, angles = _points(2 * count - 1), np.repeat(angles, 2, axis=0)[:-1]
        between = finer[1::2]
        told = chebyshev.chebval(2.0 * between - 1.0, coefficients).T
        angles[1::2] = kinematics.solve(hand(start + (stop - start) * between), told)
        points = finer
    raise InfeasibleError(
        f"inverse kinematics: the joints do not move smoothly between t = {start:.3f} s and {stop:.3f} s, "
        "near a singular pose: move arm.plane or change arm.posture_rad"
    )


def _points(count: int) -> FloatArray:
    """Chebyshev points of the second kind on [0, 1]."""
    return np.asarray(0.5 - 0.5 * np.cos(np.pi * np.arange(count) / (count - 1)))
