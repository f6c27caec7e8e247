"""Inverse kinematics checked by the Denavit-Hartenberg product, and derivatives checked by analytic paths."""

import re

import numpy as np
import pytest
from scipy.linalg import null_space
from wam_by_hand import LOWER, UPPER, hand_frame, jacobian

from slidepipe.arm.inverse_kinematics import HandPath, InverseKinematics, JointPath, joint_path
from slidepipe.arm.model import Tool, nominal_model
from slidepipe.errors import InfeasibleError
from slidepipe.mechanics.planar import MotionPlane

TOOL = Tool(length_m=0.1, angle_rad=3.4)
POSTURE = np.array([1.38, -1.06, -1.18, 1.98, 0.9, -0.37, -0.09])
PLANE = MotionPlane(np.array([0.4, -0.4, 0.5]), np.pi / 2)
TIME = np.arange(101) * 0.002


def circle(radius_m: float, turn_rad: float) -> HandPath:
    """Once around the plane's origin while the hand turns to and fro."""
    phase = 2 * np.pi * TIME / TIME[-1]
    poses = np.column_stack([radius_m * np.cos(phase), radius_m * np.sin(phase), np.pi + turn_rad * np.sin(phase)])
    return HandPath(TIME, *PLANE.lift(poses))


@pytest.fixture(scope="module")
def path() -> HandPath:
    return circle(0.15, 0.3)


@pytest.fixture(scope="module")
def joints(path: HandPath) -> np.ndarray:
    inverse = InverseKinematics(nominal_model(TOOL), POSTURE)
    inverse.approach(path)
    return inverse.solve(path)


def test_the_hand_reaches_every_pose(path: HandPath, joints: np.ndarray) -> None:
    for angles, position, matrix in zip(joints, path.position_m, path.matrix, strict=True):
        frame = hand_frame(angles, TOOL.length_m, TOOL.angle_rad)
        assert np.linalg.norm(frame[:3, 3] - position) < 1e-7
        assert np.linalg.norm(frame[:3, :3] - matrix) < np.sqrt(2) * 1e-6


def test_the_joints_stay_within_their_ranges_and_do_not_jump(joints: np.ndarray) -> None:
    assert np.all(joints >= LOWER)
    assert np.all(joints <= UPPER)
    assert np.max(np.abs(np.diff(joints, axis=0))) < 0.1


def test_what_the_hand_leaves_free_is_nearest_to_the_posture(joints: np.ndarray) -> None:
    """At the nearest point the way that leaves the hand in place is square to the way to the posture."""
    for angles in joints[::10]:
        point = hand_frame(angles, TOOL.length_m, TOOL.angle_rad)[:3, 3]
        free = null_space(np.vstack(jacobian(angles, point, 7)))
        assert free.shape == (7, 1)
        assert abs(free[:, 0] @ (angles - POSTURE)) < 1e-6


def test_a_pose_out_of_reach_is_named_by_its_time() -> None:
    inverse = InverseKinematics(nominal_model(TOOL), POSTURE)
    outwards = np.column_stack([np.zeros(101), 4.0 * TIME, np.full(101, np.pi)])
    asked = HandPath(TIME, *PLANE.lift(outwards))
    with pytest.raises(InfeasibleError, match=r"cannot reach its pose at t = 0\.\d{3} s within the joint limits") as no:
        inverse.solve(asked)
    failed = float(re.search(r"t = ([0-9.]+) s", str(no.value))[1])
    shoulder_to_hand = np.linalg.norm(asked.position_m, axis=1)
    longest = np.hypot(0.55, 0.045) + np.hypot(0.30, 0.045) + 0.0609 + 0.1
    surely_out = TIME[np.argmax(shoulder_to_hand > longest)]
    assert 0.05 < failed <= surely_out + 1e-9
    how_far = r"[0-9.e+-]+ mm and [0-9.e+-]+ mrad off \(allowed: 0\.0001 mm, 0\.001 mrad\); move arm.plane or change"
    assert re.search(how_far, str(no.value))
    assert "\n" not in str(no.value)
    before = failed - 1e-9 > TIME
    reachable = HandPath(TIME[before], asked.position_m[before], asked.matrix[before])
    inverse.approach(reachable)
    joints = inverse.solve(reachable)
    assert len(joints) == np.count_nonzero(before), "every pose before the one that is named can be reached"


def test_a_posture_within_the_limits_does_not_make_an_unreachable_turn_reachable() -> None:
    """The wrist cannot turn the hand once around."""
    poses = np.column_stack([np.zeros((101, 2)), np.pi + 2 * np.pi * TIME / TIME[-1]])
    with pytest.raises(InfeasibleError, match=r"inverse kinematics: the hand cannot reach its pose at t = "):
        InverseKinematics(nominal_model(TOOL), POSTURE).solve(HandPath(TIME, *PLANE.lift(poses)))


def hopping(time_s: np.ndarray) -> HandPath:
    """A path along the plane whose acceleration jumps at 0.1 s, while the hand turns."""
    back = np.maximum(time_s - 0.1, 0.0)
    poses = np.column_stack([3.0 * time_s**2 - 9.0 * back**2, 0.2 * np.sin(5.0 * time_s), np.pi + 0.5 * time_s])
    return HandPath(time_s, *PLANE.lift(poses))


@pytest.fixture(scope="module")
def smooth() -> JointPath:
    kinematics = InverseKinematics(nominal_model(TOOL), POSTURE)
    return joint_path(kinematics, hopping, TIME, np.array([0.0, 0.1, TIME[-1]]))


def test_between_the_points_that_are_solved_for_the_hand_is_on_its_path(smooth: JointPath) -> None:
    asked = hopping(TIME)
    for angles, position, matrix in zip(smooth.position_rad, asked.position_m, asked.matrix, strict=True):
        frame = hand_frame(angles, TOOL.length_m, TOOL.angle_rad)
        assert np.linalg.norm(frame[:3, 3] - position) < 2e-7
        assert np.linalg.norm(frame[:3, :3] - matrix) < 2e-6


def test_speeds_and_accelerations_are_the_derivatives_on_both_sides_of_a_jump(smooth: JointPath) -> None:
    step, jump = TIME[1], 50
    for piece in (slice(0, jump), slice(jump, len(TIME))):
        angles, speeds, accelerations = (
            values[piece] for values in (smooth.position_rad, smooth.velocity_rad_s, smooth.acceleration_rad_s2)
        )
        np.testing.assert_allclose(speeds[1:-1], (angles[2:] - angles[:-2]) / (2 * step), atol=2e-3)
        second = (angles[2:] - 2 * angles[1:-1] + angles[:-2]) / step**2
        np.testing.assert_allclose(accelerations[1:-1], second, atol=0.05)
    assert np.max(np.abs(smooth.acceleration_rad_s2[jump] - smooth.acceleration_rad_s2[jump - 1])) > 5.0


def test_a_jump_that_is_not_told_is_no_smooth_path() -> None:
    """The control: no polynomial converges across it."""
    kinematics = InverseKinematics(nominal_model(TOOL), POSTURE)
    with pytest.raises(InfeasibleError, match=r"do not move smoothly between t = 0\.000 s and 0\.200 s"):
        joint_path(kinematics, hopping, TIME, TIME[[0, -1]])
