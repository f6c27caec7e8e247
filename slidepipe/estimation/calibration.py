"""Where the cameras are on the arm, and the finger in the hand's markers: from a motion that both saw.

The joints say where the finger frame {f} is in the base frame, the cameras where the hand's markers {h} are in their
own: ``T_base_f(t + delay) T_f_h = X T_cameras_h(t)`` at every frame, the robot-world and hand-eye problem. All thirteen
numbers are fitted in one weighted least squares, the delay among them. A motion in a plane cannot tell how far out of
the plane the hand's markers are: all that is known of this is that they are on a hand, and the object in the plane. It
tells the rest if the hand turns; a hand that does not turn leaves open where on it the finger is, and is refused.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import OptimizeResult
from scipy.spatial.transform import Rotation

from slidepipe.errors import EstimationError
from slidepipe.estimation.calibration_fit import (
    FEWEST_FRAMES,
    CalibrationRequest,
    Problem,
    fine_fit,
    inliers,
    make_problem,
    rough_fit,
)
from slidepipe.series import BoolArray, FloatArray, MocapSeries, PoseSeries

LARGEST_PLACE_STD_M = 0.0005
"""A calibration that tells the finger's place in the plane no better than this is refused."""
WORST_FIT_M, WORST_FIT_RAD, FIT_SHARE = 0.003, 0.03, 0.8
"""A calibration that leaves more than this is refused."""

__all__ = ["Calibration", "CalibrationRequest", "Placement", "calibrate", "calibrated"]


@dataclass(frozen=True, slots=True)
class Placement:
    """Pose of one frame in another: (3,) position, m, and rotation vector, rad, and their standard deviations."""

    position_m: FloatArray
    rotation_rad: FloatArray
    position_std_m: FloatArray
    rotation_std_rad: FloatArray


@dataclass(frozen=True, slots=True)
class Calibration:
    """What the motion tells.

    Attributes
    ----------
    cameras_in_base : Placement
        The cameras' frame in the base frame; deviations of the rotation about the base's axes.
    hand_markers : Placement
        The frame of the hand's markers in {f}. Along z the deviation is some mm where the motion was in a plane.
    object_tilt_rad, object_tilt_std_rad : (3,) or None
        Rotation vector, in the object's markers, from their z axis to the plane's normal; its z is zero. None where the
        object was not there.
    heading_rad, lean_rad, plane_std_rad : float
        Direction of the motion plane's x axis in the base's horizontal plane, as the hand's turning shows it to the
        cameras; by how much the plane leans out of the vertical; and the standard deviation of both.
    down_in_cameras : (3,)
        Direction of gravity in the cameras' frame, if the arm's base is level.
    down_std_rad : float
        Standard deviation of that direction.
    delay_s, delay_std_s : float
        By how much the joints' stamps are late beside the cameras' mapped ones.
    turn_rad : float
        How far the hand turned.
    rms_m, rms_rad : float
        What is left of positions and angles, along and about one axis.
    frames, outliers : int
        That were used, and that were left out.
    """

    cameras_in_base: Placement
    hand_markers: Placement
    object_tilt_rad: FloatArray | None
    object_tilt_std_rad: FloatArray | None
    heading_rad: float
    lean_rad: float
    plane_std_rad: float
    down_in_cameras: FloatArray
    down_std_rad: float
    delay_s: float
    delay_std_s: float
    turn_rad: float
    rms_m: float
    rms_rad: float
    frames: int
    outliers: int


def calibrate(request: CalibrationRequest) -> Calibration:
    """Calibrate cameras and hand from one motion.

    Raises
    ------
    InputError
        The recording contradicts itself.
    EstimationError
        The motion cannot tell, or joints and cameras do not belong together.
    """
    problem = make_problem(request)
    rough = rough_fit(problem)
    problem = problem.at(float(rough[12]))
    left = np.abs(problem.residual(rough))
    _refuse_misfit(float(np.median(left[:, :3])), float(np.median(left[:, 3:])), 1.0)
    kept = inliers(problem, rough)
    fit = fine_fit(problem, kept, rough)
    problem = problem.at(float(fit.x[12]))
    told = _told(problem, kept, fit)
    _refuse_misfit(told.rms_m, told.rms_rad, told.frames / len(kept))
    place = float(np.max(told.hand_markers.position_std_m[:2]))
    if not place < LARGEST_PLACE_STD_M:
        raise EstimationError(
            f"calibration: the hand turned by {np.degrees(told.turn_rad):.1f} degrees only, which tells the finger's "
            f"place on it to {1e3 * place:.3g} mm, at most {1e3 * LARGEST_PLACE_STD_M:g} mm are accepted: "
            "a calibration motion must turn the hand"
        )
    return told


def _refuse_misfit(left_m: float, left_rad: float, share: float) -> None:
    """Raise where too much is left between joints and cameras, or where that holds in too few frames."""
    if not (left_m < WORST_FIT_M and left_rad < WORST_FIT_RAD and share > FIT_SHARE):
        raise EstimationError(
            f"calibration: joints and cameras do not fit, {1e3 * left_m:.1f} mm and {1e3 * left_rad:.0f} mrad are left "
            f"between them in {100.0 * share:.0f} % of the frames, at most {1e3 * WORST_FIT_M:g} mm and "
            f"{1e3 * WORST_FIT_RAD:g} mrad in {100.0 * FIT_SHARE:g} % are accepted"
        )


def calibrated(mocap: MocapSeries, calibration: Calibration) -> MocapSeries:
    """Poses of {f} and {b} in the base frame, from those of the markers in the cameras' frame."""
    X, markers = calibration.cameras_in_base, calibration.hand_markers
    back = Rotation.from_rotvec(markers.rotation_rad).inv()
    tilt = calibration.object_tilt_rad
    level = Rotation.identity() if tilt is None else Rotation.from_rotvec(tilt)
    return MocapSeries(
        frames=mocap.frames,
        hand=_moved(mocap.hand, X, back, -back.apply(markers.position_m)),
        object=_moved(mocap.object, X, level, np.zeros(3)),
        clock=mocap.clock,
    )


def _moved(poses: PoseSeries, X: Placement, turn: Rotation, offset_m: FloatArray) -> PoseSeries:
    if not len(poses.sequence):
        return poses
    base, seen = Rotation.from_rotvec(X.rotation_rad), Rotation.from_quat(poses.quaternion_xyzw)
    return PoseSeries(
        stamp_ns=poses.stamp_ns,
        position_m=np.asarray(base.apply(poses.position_m + seen.apply(offset_m)) + X.position_m),
        quaternion_xyzw=np.asarray((base * seen * turn).as_quat()),
        sequence=poses.sequence,
    )


def _told(problem: Problem, kept: BoolArray, fit: OptimizeResult) -> Calibration:
    x, left = fit.x, problem.residual(fit.x)[kept]
    covariance = np.linalg.pinv(fit.jac.T @ fit.jac)
    std = np.sqrt(np.diagonal(covariance))
    base = Rotation.from_rotvec(x[0:3])
    down = base.inv().apply([0.0, 0.0, -1.0])
    tilt = _object_tilt(problem, base)
    axis = _turn_axis(problem.turn)
    normal = base.apply(axis.direction)
    normal *= np.sign(normal @ problem.plane.axes[:, 2])
    told = len(tilt) >= FEWEST_FRAMES
    return Calibration(
        cameras_in_base=Placement(x[3:6], x[0:3], std[3:6], std[0:3]),
        hand_markers=Placement(x[9:12], -x[6:9], std[9:12], std[6:9]),
        object_tilt_rad=np.median(tilt, axis=0) if told else None,
        object_tilt_std_rad=1.2533 * tilt.std(axis=0, ddof=1) / np.sqrt(len(tilt)) if told else None,
        heading_rad=float(np.arctan2(normal[0], -normal[1])),
        lean_rad=float(np.arcsin(np.clip(normal[2], -1.0, 1.0))),
        plane_std_rad=float(np.hypot(np.max(std[0:3]), axis.std_rad)),
        down_in_cameras=np.asarray(down),
        down_std_rad=float(np.hypot(std[0], std[1])),
        delay_s=float(x[12]),
        delay_std_s=float(std[12]),
        turn_rad=_turn(problem),
        rms_m=float(np.sqrt(np.mean(left[:, :3] ** 2))),
        rms_rad=float(np.sqrt(np.mean(left[:, 3:] ** 2))),
        frames=int(np.count_nonzero(kept)),
        outliers=int(np.count_nonzero(~kept)),
    )


def _object_tilt(problem: Problem, base: Rotation) -> FloatArray:
    """(T, 3) rotation vector that carries the z axis of the object's markers to the plane's normal, at each frame."""
    if not len(problem.object_turn):
        return np.zeros((0, 3))
    normal = (base * problem.object_turn).inv().apply(problem.plane.axes[:, 2])
    across = np.cross([0.0, 0.0, 1.0], normal)
    size = np.linalg.norm(across, axis=1)
    angle = np.arctan2(size, normal[:, 2])
    return np.asarray(across * (angle / np.maximum(size, 1e-12))[:, None])


@dataclass(frozen=True, slots=True)
class _Axis:
    direction: FloatArray
    std_rad: float


def _turn_axis(turns: Rotation) -> _Axis:
    """The axis that all turns of the hand share, in the cameras' frame: what their mean matrix leaves unshortened."""
    matrices = turns.as_matrix()
    _, _, rows = np.linalg.svd(matrices.mean(axis=0))
    each = matrices @ rows[0]
    direction = each.mean(axis=0) / np.linalg.norm(each.mean(axis=0))
    return _Axis(direction, float(np.sqrt(np.mean((each - direction) ** 2) / len(each))))


def _turn(problem: Problem) -> float:
    """Largest turn of the hand from its first orientation, by the joints."""
    turns = problem.finger_turn
    return float(np.max((turns[0].inv() * turns).magnitude()))
