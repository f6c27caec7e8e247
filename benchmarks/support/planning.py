"""Planning problems to measure with: the paper's, Fig. 5's grip, a long slide, and random goals."""

from dataclasses import dataclass, replace

import numpy as np

from slidepipe.arm.model import Tool
from slidepipe.mechanics.dynamics import Block
from slidepipe.mechanics.limit_surface import SoftFinger
from slidepipe.mechanics.planar import MotionPlane
from slidepipe.planning.limits import Limits
from slidepipe.planning.planner import Setup
from slidepipe.planning.search import Task
from slidepipe.planning.wish import WEIGHTS, Objective, Wish

HAND_ACCELERATION_M_S2 = 20.0
HAND_SPEED_M_S = 3.0


@dataclass(frozen=True, slots=True)
class Problem:
    """What is asked of the planner."""

    name: str
    task: Task
    setup: Setup
    wish: Wish


def limits(hand_acceleration_m_s2: float = np.inf) -> Limits:
    """The WAM's limits as the shipped experiments have them."""
    return Limits(
        workspace_centre_m=np.zeros(2),
        workspace_radius_m=0.5,
        joint_speed_rad_s=np.array([4.0, 4.0, 5.0, 5.0, 6.0, 6.0, 12.0]),
        joint_torque_n_m=np.array([77.3, 160.6, 95.6, 29.4, 11.6, 11.6, 2.7]),
        tip_speed_m_s=HAND_SPEED_M_S,
        elbow_speed_m_s=2.5,
        hand_acceleration_m_s2=hand_acceleration_m_s2,
    )


def linear_setup(hand_acceleration_m_s2: float = HAND_ACCELERATION_M_S2) -> Setup:
    """Section VIII-A's block and grip, 1.25 N in all, on the WAM."""
    return Setup(
        block=Block(0.06, 0.1, 0.023),
        finger=SoftFinger(0.38, 1.25, 0.0174, 0.6),
        plane=MotionPlane(np.array([0.4, -0.4, 0.5]), np.pi / 2),
        tool=Tool(0.1, 3.4),
        posture_rad=np.array([1.38, -1.06, -1.18, 1.98, 0.9, -0.37, -0.09]),
        limits=limits(hand_acceleration_m_s2),
    )


def rotational_setup() -> Setup:
    """Section VIII-B's grip, 2.5 N in all, where the wrist can turn as it asks."""
    return replace(
        linear_setup(np.inf),
        finger=SoftFinger(0.38, 2.5, 0.05, 0.6),
        plane=MotionPlane(np.array([0.65, 0.1, 0.4]), np.pi / 2),
        tool=Tool(0.1, 3.7),
        posture_rad=np.array([0.72, 0.89, -1.09, 1.58, -0.24, -0.22, 0.0]),
    )


def linear_task() -> Task:
    """Section VIII-A's way, wherever the hand ends."""
    return Task(np.zeros(3), np.array([-0.01, -0.02, np.pi]), np.array([0.01, 0.02, np.pi]), None)


def rotational_task() -> Task:
    """Section VIII-B's way."""
    return Task(np.zeros(3), np.array([-0.01, 0.04, 0.75 * np.pi]), np.array([0.01, 0.04, np.pi]), None)


def robust_problems() -> dict[str, Problem]:
    """VIII-A's way with hand acceleration within 20 m/s^2 and speed within 3 m/s, with more and more left free."""
    wish = Wish(WEIGHTS[Objective.ROBUST])
    freer = replace(wish, angle_free=True)
    wishes = {
        "eps_paper_grip": wish,
        "eps_free_orientation": freer,
        "eps_free_grip": replace(freer, force_range=(0.3, 2.0)),
    }
    return {key: Problem(key, linear_task(), linear_setup(), one) for key, one in wishes.items()}


def named_problems() -> list[Problem]:
    """The problems that have a name."""
    robust, fast = Wish(WEIGHTS[Objective.ROBUST]), Wish(WEIGHTS[Objective.FAST], friction_error=0.05)
    third = 1.0 / 6.0
    places = np.array([[0.012, 0.0, third], [-0.006, 0.01, third], [-0.006, -0.01, third], [0.0, 0.0, 0.5]])
    turn = Task(np.zeros(3), np.array([0.0, 0.0, 0.75 * np.pi]), np.array([0.0, 0.0, np.pi]), None)
    short = Task(np.zeros(3), np.array([-0.004, -0.012, np.pi]), np.array([0.004, 0.012, np.pi]), None)
    far = Task(np.zeros(3), np.array([0.0, -0.03, np.pi]), np.array([0.0, 0.03, np.pi]), None)
    weak = replace(rotational_setup(), finger=linear_setup().finger)
    long_block = replace(linear_setup(np.inf), block=Block(0.06, 0.2, 0.04))
    return [
        Problem("VIII-A, robust", linear_task(), linear_setup(), robust),
        Problem("VIII-B, robust", rotational_task(), rotational_setup(), replace(robust, friction_error=0.05)),
        Problem("VIII-B, fast", rotational_task(), rotational_setup(), fast),
        Problem("turn in place by 45 degrees", turn, weak, fast),
        Problem("four fingers", short, replace(linear_setup(np.inf), places=places), fast),
        Problem("60 mm on a longer block", far, long_block, robust),
    ]


def random_problems(count: int, seed: int) -> list[Problem]:
    """Goals anywhere on the face, turned by up to half a radian, for VIII-A's block and grip."""
    random, problems = np.random.default_rng(seed), []
    half, wish = np.array([0.03, 0.05]), Wish(WEIGHTS[Objective.FAST], friction_error=0.05)
    setup = linear_setup(np.inf)
    while len(problems) < count:
        start = np.append(random.uniform(-0.7, 0.7, 2) * half, np.pi)
        goal = np.append(random.uniform(-0.7, 0.7, 2) * half, np.pi + random.uniform(-0.5, 0.5))
        if np.linalg.norm((goal - start)[:2]) < 0.005:
            continue
        angle = random.uniform(-0.8, 0.8)
        task = Task(np.array([0.0, 0.0, angle]), start, goal, None)
        problems.append(Problem(f"random {len(problems) + 1}", task, setup, wish))
    return problems
