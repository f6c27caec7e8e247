"""Inverse kinematics checked by the Denavit-Hartenberg product, and derivatives checked by analytic paths."""

import re
from itertools import pairwise

import numpy as np
import pytest
from scipy.linalg import null_space
from wam_by_hand import LOWER, UPPER, hand_frame, jacobian

from slidepipe.arm.inverse_kinematics import HandPath, InverseKinematics, differentiate
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
    return InverseKinematics(nominal_model(TOOL), POSTURE).solve(path)


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
    joints = inverse.solve(HandPath(TIME[before], asked.position_m[before], asked.matrix[before]))
    assert len(joints) == np.count_nonzero(before), "every pose before the one that is named can be reached"


def test_a_posture_within_the_limits_does_not_make_an_unreachable_turn_reachable() -> None:
    """The wrist cannot turn the hand once around."""
    poses = np.column_stack([np.zeros((101, 2)), np.pi + 2 * np.pi * TIME / TIME[-1]])
    with pytest.raises(InfeasibleError, match=r"inverse kinematics: the hand cannot reach its pose at t = "):
        InverseKinematics(nominal_model(TOOL), POSTURE).solve(HandPath(TIME, *PLANE.lift(poses)))


def piecewise(time_s: np.ndarray, boundaries_s: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Angle, speed and acceleration of one joint whose acceleration is another sine in every piece."""
    q, dq = 0.3, -0.2
    angle, speed, acceleration = (np.empty_like(time_s) for _ in range(3))
    for piece, (start, end) in enumerate(pairwise(boundaries_s)):
        size, rate = 5.0 * (-1) ** piece, 4.0 + piece

        def motion(t: np.ndarray, q: float, dq: float, size: float, rate: float) -> tuple[np.ndarray, ...]:
            swing = size * np.cos(rate * t)
            return q + dq * t + (size - swing) / rate**2, dq + size * np.sin(rate * t) / rate, swing

        here = time_s >= start - 1e-9
        angle[here], speed[here], acceleration[here] = motion(time_s[here] - start, q, dq, size, rate)
        q, dq, _ = motion(end - start, q, dq, size, rate)
    return angle, speed, acceleration


def test_derivatives_are_exact_on_both_sides_of_a_jump() -> None:
    time_s, boundaries_s = np.arange(401) * 0.002, np.array([0.0, 0.3, 0.4, 0.5, 0.8])
    angle, speed, acceleration = piecewise(time_s, boundaries_s)
    assert np.min(np.abs(acceleration[[150, 200, 250]] - acceleration[[149, 199, 249]])) > 1.0
    found = differentiate(time_s, np.tile(angle[:, None], 7), boundaries_s)
    np.testing.assert_array_equal(found.position_rad[:, 3], angle)
    for joint in (0, 6):
        np.testing.assert_allclose(found.velocity_rad_s[:, joint], speed, atol=1e-9)
        np.testing.assert_allclose(found.acceleration_rad_s2[:, joint], acceleration, atol=1e-6)


def test_a_boundary_that_is_not_told_is_smeared() -> None:
    """The control: without its boundary the same jump cannot be followed."""
    time_s, boundaries_s = np.arange(401) * 0.002, np.array([0.0, 0.3, 0.4, 0.5, 0.8])
    angle, _, acceleration = piecewise(time_s, boundaries_s)
    found = differentiate(time_s, np.tile(angle[:, None], 7), boundaries_s[[0, 1, 3, 4]])
    assert np.max(np.abs(found.acceleration_rad_s2[:, 0] - acceleration)) > 0.5
