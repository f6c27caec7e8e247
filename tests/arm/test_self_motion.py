"""The arm's self-motion against differences of Jacobians that were multiplied out by hand."""

import numpy as np
from scipy.linalg import null_space
from wam_by_hand import hand_frame, jacobian, random_joints

from slidepipe.arm.self_motion_kernel import towards_posture, turning

LENGTH_M = 0.1


def of_hand(joints: np.ndarray) -> np.ndarray:
    return np.vstack(jacobian(joints, hand_frame(joints, LENGTH_M, 0.0)[:3, 3], 7))


def test_how_the_free_direction_turns_is_the_jacobians_derivative() -> None:
    random, step = np.random.default_rng(4), 1e-5
    for _ in range(20):
        joints, multiplier, turned = random_joints(random), random.normal(size=6), np.empty(7)
        free = null_space(of_hand(joints))[:, 0]
        turning(of_hand(joints), free, multiplier, turned)
        ahead = [of_hand(joints + step * each) for each in np.eye(7)]
        behind = [of_hand(joints - step * each) for each in np.eye(7)]
        differences = [multiplier @ (a - b) @ free / (2.0 * step) for a, b in zip(ahead, behind, strict=True)]
        np.testing.assert_allclose(turned, differences, atol=1e-8)


def test_steps_shrink_with_their_square() -> None:
    posture = np.array([1.38, -1.06, -1.18, 1.98, 0.9, -0.37, -0.09])
    # Along the free direction, too: the posture is some way off on the self-motion.
    start = posture + 0.3 * null_space(of_hand(posture))[:, 0] + 0.05
    target = hand_frame(start, LENGTH_M, 0.0)
    joints, sizes = start, []
    for _ in range(5):
        now = hand_frame(joints, LENGTH_M, 0.0)
        turn = target[:3, :3] @ now[:3, :3].T
        spin = 0.5 * np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
        twist = np.concatenate([target[:3, 3] - now[:3, 3], spin])
        step = np.sum(towards_posture(of_hand(joints), twist, joints - posture), axis=0)
        joints = joints + step
        sizes.append(float(np.max(np.abs(step))))
    assert sizes[0] > 0.05
    assert sizes[1] < 2.0 * sizes[0] ** 2
    assert sizes[2] < 2.0 * sizes[1] ** 2
    assert sizes[3] < 2.0 * sizes[2] ** 2 + 1e-12
    free = null_space(of_hand(joints))[:, 0]
    assert abs(free @ (joints - posture)) < 1e-10
    assert np.linalg.norm(hand_frame(joints, LENGTH_M, 0.0) - target) < 1e-10
