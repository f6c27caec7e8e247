"""The WAM by hand: its vendor's Denavit-Hartenberg table multiplied out in numpy, which knows nothing of MuJoCo."""

import numpy as np

from slidepipe.arm import wam

PI = np.pi
DH = (
    (-PI / 2, 0.0, 0.0),
    (PI / 2, 0.0, 0.0),
    (-PI / 2, 0.045, 0.55),
    (PI / 2, -0.045, 0.0),
    (-PI / 2, 0.0, 0.30),
    (PI / 2, 0.0, 0.0),
    (0.0, 0.0, 0.0609),
)
"""alpha, a, d of each joint, as the vendor gives them."""
LOWER = np.array([-2.6, -2.0, -2.8, -0.9, -4.76, -1.6, -3.0])
UPPER = np.array([2.6, 2.0, 2.8, 3.1, 1.24, 1.6, 3.0])
MASS = (10.7677, 3.8749, 1.8023, 2.17266, 0.35656, 0.40916, 0.07548)


def link_frames(joints_rad: np.ndarray) -> list[np.ndarray]:
    """(4, 4) frame of the base and of every link in the base frame."""
    frames = [np.eye(4)]
    for angle, (alpha, a, d) in zip(joints_rad, DH, strict=True):
        c, s, ca, sa = np.cos(angle), np.sin(angle), np.cos(alpha), np.sin(alpha)
        step = [[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d], [0, 0, 0, 1]]
        frames.append(frames[-1] @ np.array(step))
    return frames


def hand_frame(joints_rad: np.ndarray, length_m: float, angle_rad: float) -> np.ndarray:
    """(4, 4) frame {f} in the base frame, for a tool along the wrist axis and a turn about it."""
    c, s = np.cos(angle_rad), np.sin(angle_rad)
    tool = np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, length_m], [0, 0, 0, 1]])
    return link_frames(joints_rad)[-1] @ tool


def jacobian(joints_rad: np.ndarray, point_m: np.ndarray, link: int) -> tuple[np.ndarray, np.ndarray]:
    """Linear and angular (3, 7) Jacobians of a point in the base frame that moves with a link, 1 to 7."""
    linear, angular = np.zeros((3, 7)), np.zeros((3, 7))
    for joint, frame in enumerate(link_frames(joints_rad)[:link]):
        axis, origin = frame[:3, 2], frame[:3, 3]
        linear[:, joint], angular[:, joint] = np.cross(axis, point_m - origin), axis
    return linear, angular


def mass_matrix(joints_rad: np.ndarray) -> np.ndarray:
    """(7, 7) of the bare arm: the links' masses and inertias in their own frames, and the rotors."""
    total = np.diag(wam.ROTOR_INERTIA)
    for index, (link, frame) in enumerate(zip(wam.LINKS, link_frames(joints_rad)[1:], strict=True)):
        turn = frame[:3, :3]
        linear, angular = jacobian(joints_rad, frame[:3, 3] + turn @ link.com_m, index + 1)
        xx, yy, zz, xy, xz, yz = link.inertia_kg_m2
        inertia = turn @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ turn.T
        total = total + link.mass_kg * linear.T @ linear + angular.T @ inertia @ angular
    return total


def random_joints(random: np.random.Generator) -> np.ndarray:
    """Joint angles anywhere in their ranges."""
    return random.uniform(LOWER, UPPER)
