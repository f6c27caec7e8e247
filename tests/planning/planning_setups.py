"""What several tests of the planner need: dense samples, and the independent block fed with a planned hand."""

from itertools import pairwise

import numpy as np
from free_block import FreeBlock
from paper_cases import BLOCK, LINEAR, ROTATIONAL, linear_finger, rotational_finger

from slidepipe.mechanics.limit_surface import SoftFinger
from slidepipe.mechanics.planar import finger_pose
from slidepipe.planning.course import Course
from slidepipe.planning.three_phase import Regrasp, ThreePhaseMotion

CASES = {"linear": (LINEAR, linear_finger), "rotational": (ROTATIONAL, rotational_finger)}


def dense(boundaries_s: np.ndarray, step_s: float = 1e-3) -> np.ndarray:
    """Times about a step apart, every boundary among them."""
    pieces = [np.linspace(a, b, max(7, round((b - a) / step_s) + 1)) for a, b in pairwise(boundaries_s)]
    return np.unique(np.concatenate(pieces))


def as_regrasp(course: Course) -> Regrasp:
    """What a course with given times answers."""
    q_f_end = finger_pose(course.q_o_end, course.r_goal)
    return Regrasp(course.q_o_start, course.r_start, course.r_goal, q_f_end, course.T1, course.T23, course.T4)


def slide_freely(
    regrasp: Regrasp, believed: SoftFinger, true: SoftFinger, *, end_s: float | None = None
) -> tuple[np.ndarray, FreeBlock]:
    """Final relative pose of a free block on the hand of a plan that believes in another friction than the true one."""
    boundaries = regrasp.boundaries.copy()
    boundaries[-1] = end_s or boundaries[-1]
    time_s = dense(boundaries)
    block = FreeBlock(
        mass_kg=BLOCK.m,
        sides_m=(BLOCK.length, BLOCK.width),
        friction_n=true.mu * true.f_N,
        torsion_radius_m=true.a * true.c,
    )
    q_f = ThreePhaseMotion(regrasp, BLOCK, believed).sample(time_s).q_f
    return block.follow(time_s, q_f, boundaries, regrasp.r_start), block
