"""Motions that the planner finds by itself: within every limit, at the goal, and as robust as they say."""

from dataclasses import replace

import numpy as np
import pytest
from free_block import FreeBlock
from paper_cases import BLOCK, LIMITS, LINEAR, ROTATIONAL, linear_finger, linear_setup, rotational_setup
from planning_setups import dense

from slidepipe.errors import InfeasibleError, InputError
from slidepipe.lab.grip_model import ContactSettings
from slidepipe.lab.planar_rig import planar_rig, run_rig
from slidepipe.mechanics.dynamics import Block
from slidepipe.mechanics.stepping import PlacedFinger, step_through
from slidepipe.planning.automatic import plan_automatically
from slidepipe.planning.course import CourseMotion
from slidepipe.planning.planner import Plan, Setup
from slidepipe.planning.search import Task
from slidepipe.planning.survival import MOST_TURN_RAD
from slidepipe.planning.wish import WEIGHTS, Objective, Weights, Wish

PAPER_LIMITS = replace(LIMITS, hand_acceleration_m_s2=20.0)
LINEAR_TASK = Task(LINEAR.q_o_start, LINEAR.r_start, LINEAR.r_goal, None)
ROTATIONAL_TASK = Task(ROTATIONAL.q_o_start, ROTATIONAL.r_start, ROTATIONAL.r_goal, None)
ROBUST = Wish(WEIGHTS[Objective.ROBUST])
STIFF = ContactSettings(timestep_s=5e-5, solref_s=2e-4, impratio=1000.0)


@pytest.fixture(scope="module")
def robust() -> Plan:
    """Section VIII-A's goal with its grip force, hand acceleration within 20 m/s^2 and speed within 3 m/s."""
    return plan_automatically(LINEAR_TASK, linear_setup(limits=PAPER_LIMITS), ROBUST)


@pytest.fixture(scope="module", params=list(Objective))
def rotational(request: pytest.FixtureRequest) -> tuple[Objective, Plan]:
    wish = Wish(WEIGHTS[request.param], friction_error=0.05)
    return request.param, plan_automatically(ROTATIONAL_TASK, rotational_setup(), wish)


def freely(chosen: Plan, share: float = 1.0, rest_s: float = 0.3) -> np.ndarray:
    """Final relative pose of a block that scipy simulates under the plan's hand, with another friction."""
    finger, block = chosen.setup.finger, chosen.setup.block
    free = FreeBlock(
        mass_kg=block.m,
        sides_m=(block.length, block.width),
        friction_n=share * finger.mu * finger.f_N,
        torsion_radius_m=finger.a * finger.c,
    )
    edges = np.append(chosen.course.boundaries, chosen.course.boundaries[-1] + rest_s)
    time_s = dense(edges)
    q_f = CourseMotion(chosen.course, block, chosen.setup.fingers).sample(time_s).q_f
    return free.follow(time_s, q_f, edges, chosen.course.r_start)


def in_mujoco(chosen: Plan, share: float = 1.0) -> np.ndarray:
    """Final relative pose in MuJoCo with a perfect tracker."""
    fingers = tuple(replace(f, finger=replace(f.finger, mu=share * f.finger.mu)) for f in chosen.setup.fingers)
    hand = CourseMotion(chosen.course, chosen.setup.block, chosen.setup.fingers).hand_motion()
    rig = planar_rig(chosen.setup.block, fingers, STIFF)
    return run_rig(rig, hand, chosen.course.r_start).r_f_b[-1]


def lands(chosen: Plan) -> None:
    missed = in_mujoco(chosen) - chosen.course.r_goal
    assert np.linalg.norm(missed[:2]) < 1.5e-3
    assert abs(missed[2]) < 0.03


def share_left(chosen: Plan, r_end: np.ndarray) -> float:
    weights = np.array([1.0, 1.0, chosen.setup.finger.a * chosen.setup.finger.c])
    way = (chosen.course.r_start - chosen.course.r_goal) * weights
    return float(np.linalg.norm((r_end - chosen.course.r_goal) * weights) / np.linalg.norm(way))


def test_the_papers_goal_survives_more_than_twice_what_the_papers_plan_does(robust: Plan, linear_plan: Plan) -> None:
    assert 0.05 < linear_plan.survival.friction_error < 0.08
    assert robust.survival.friction_error > 0.2
    assert all(check.satisfied for check in (*robust.margins, *robust.limits))
    assert np.max(np.linalg.norm(robust.motion.ddq_f[:, :2], axis=1)) <= 20.0 * (1 + 1e-9)


def test_what_is_promised_of_wrong_friction_holds_for_a_block_that_scipy_simulates(robust: Plan) -> None:
    told = robust.survival
    np.testing.assert_allclose(freely(robust), LINEAR.r_goal, atol=1e-5)
    for share in (1.0 - 0.98 * told.below, 1.0 + 0.98 * told.above):
        r_end = freely(robust, share)
        assert share_left(robust, r_end) < 1.0
        assert abs(r_end[2] - LINEAR.r_goal[2]) < MOST_TURN_RAD
        assert np.all(np.abs(r_end[:2]) <= robust.setup.half_size_m)


def test_beyond_what_is_promised_it_fails_as_is_said(robust: Plan) -> None:
    told = robust.survival
    assert told.why_below == "the finger slides off the object's face"
    assert told.why_above == "the object does not slide"
    np.testing.assert_allclose(freely(robust, 1.0 + 1.02 * told.above), LINEAR.r_start, atol=1e-9)


def test_mujoco_agrees_at_the_goal_and_at_both_ends_of_the_interval(robust: Plan) -> None:
    lands(robust)
    error = robust.survival.friction_error
    for share in (1.0 - 0.97 * error, 1.0 + 0.97 * error):
        r_end = in_mujoco(robust, share)
        assert share_left(robust, r_end) < 1.0
        assert abs(r_end[2] - LINEAR.r_goal[2]) < MOST_TURN_RAD


def test_the_map_over_friction_is_the_one_that_scipy_finds(robust: Plan) -> None:
    told = robust.survival
    for index in np.flatnonzero(np.isin(told.ratio, (0.9, 1.1, 1.3))):
        np.testing.assert_allclose(told.r_f_b[index], freely(robust, told.ratio[index]), atol=2e-5)


def test_a_turning_slide_is_found_for_every_objective(rotational: tuple[Objective, Plan]) -> None:
    _, chosen = rotational
    assert all(check.satisfied for check in (*chosen.margins, *chosen.limits))
    assert chosen.survival.friction_error >= 0.05
    lands(chosen)


def test_each_objective_is_best_at_its_own() -> None:
    setup = linear_setup(limits=PAPER_LIMITS)
    fast, gentle, robust = (plan_automatically(LINEAR_TASK, setup, Wish(WEIGHTS[objective])) for objective in Objective)

    def figures(chosen: Plan) -> tuple[float, float, float]:
        peak = float(np.max(np.linalg.norm(chosen.motion.ddq_f[:, :2], axis=1)))
        return float(chosen.course.edges[-1]), peak, -chosen.survival.friction_error

    table = np.array([figures(chosen) for chosen in (fast, gentle, robust)])
    assert np.argmin(table, axis=0).tolist() == [0, 1, 2]


def test_a_weighted_wish_lies_between() -> None:
    setup = linear_setup(limits=PAPER_LIMITS)
    both = plan_automatically(LINEAR_TASK, setup, Wish(Weights(time=1.0, friction_error=1.0)))
    assert both.survival.friction_error > 0.1
    assert both.course.edges[-1] < 0.6


def test_what_is_left_free_is_chosen() -> None:
    setup = linear_setup(limits=PAPER_LIMITS)
    wish = replace(ROBUST, angle_free=True, force_range=(0.3, 2.0))
    chosen = plan_automatically(LINEAR_TASK, setup, wish)
    assert chosen.survival.friction_error > 0.33
    assert 0.3 * 1.25 < chosen.setup.finger.f_N < 1.25
    upright = np.arctan2(0.01, 0.02)
    assert chosen.course.q_o_start[2] == pytest.approx(upright, abs=0.05), "the weight does not turn the block"


def test_the_hand_comes_to_rest_where_it_is_told_to() -> None:
    task = replace(LINEAR_TASK, q_f_end=LINEAR.q_f_end)
    chosen = plan_automatically(task, linear_setup(limits=PAPER_LIMITS), Wish(WEIGHTS[Objective.FAST]))
    np.testing.assert_allclose(chosen.motion.q_f[-1], LINEAR.q_f_end, atol=1e-9)


def test_the_hand_comes_to_rest_in_its_region() -> None:
    limits = replace(PAPER_LIMITS, region_centre_m=np.array([0.05, 0.0]), region_radius_m=0.02)
    chosen = plan_automatically(LINEAR_TASK, linear_setup(limits=limits), Wish(WEIGHTS[Objective.FAST]))
    assert np.linalg.norm(chosen.motion.q_f[-1, :2] - [0.05, 0.0]) <= 0.02


def test_a_turn_in_place() -> None:
    task = Task(np.zeros(3), np.array([0.0, 0.0, 0.75 * np.pi]), np.array([0.0, 0.0, np.pi]), None)
    setup = rotational_setup(linear_finger())
    chosen = plan_automatically(task, setup, Wish(WEIGHTS[Objective.FAST], friction_error=0.05))
    lands(chosen)


def test_a_grip_that_is_too_strong_to_turn_in_is_told_with_one_that_would_do() -> None:
    task = Task(np.zeros(3), np.array([0.0, 0.0, 0.75 * np.pi]), np.array([0.0, 0.0, np.pi]), None)
    with pytest.raises(InfeasibleError, match=r"nearest normal force: 0\.\d+ N of all fingers") as no:
        plan_automatically(task, rotational_setup(), Wish(WEIGHTS[Objective.FAST], friction_error=0.05))
    assert len(no.value.lines) > 1, "what conflicts stands before what would do"


def four_fingers() -> Setup:
    """The paper's Fig. 5 in spirit: three fingers around and one in the middle, which carries as much as they do."""
    third = 1.0 / 6.0
    places = np.array([[0.012, 0.0, third], [-0.006, 0.01, third], [-0.006, -0.01, third], [0.0, 0.0, 0.5]])
    return replace(linear_setup(), places=places)


def test_four_fingers_apart_slide_as_one_plans() -> None:
    setup = four_fingers()
    task = Task(np.zeros(3), np.array([-0.004, -0.012, np.pi]), np.array([0.004, 0.012, np.pi]), None)
    chosen = plan_automatically(task, setup, Wish(WEIGHTS[Objective.FAST], friction_error=0.05))
    hand = CourseMotion(chosen.course, setup.block, setup.fingers).hand_motion()
    ends = []
    for step_s in (1e-4, 5e-5):
        time_s = np.arange(0.0, hand.breaks[-1] + 0.2, step_s)
        ends.append(step_through(time_s, hand.at(time_s), setup.block, setup.fingers, task.r_start).r_f_b[-1])
    np.testing.assert_allclose(2 * ends[1] - ends[0], task.r_goal, atol=1e-4)
    lands(chosen)


def test_sixty_millimetres_on_a_longer_block() -> None:
    setup = replace(linear_setup(), block=Block(length=0.06, width=0.2, m=0.04))
    task = Task(np.zeros(3), np.array([0.0, -0.03, np.pi]), np.array([0.0, 0.03, np.pi]), None)
    chosen = plan_automatically(task, setup, Wish(WEIGHTS[Objective.ROBUST]))
    lands(chosen)


def test_a_hand_that_is_too_gentle_is_told_what_conflicts_and_what_would_do() -> None:
    setup = linear_setup(limits=replace(LIMITS, hand_acceleration_m_s2=9.0))
    with pytest.raises(InfeasibleError, match=r"hand acceleration: 1\d\.\d+ m/s\^2 at t = .*, beyond 9 m/s\^2") as no:
        plan_automatically(LINEAR_TASK, setup, Wish(WEIGHTS[Objective.FAST]))
    assert any(line.startswith("nearest normal force: 0.") for line in no.value.lines)


def test_friction_errors_that_cannot_be_survived_are_told_beside_what_can() -> None:
    setup = linear_setup(limits=PAPER_LIMITS)
    with pytest.raises(InfeasibleError, match=r"friction error survived: 0\.\d+, less than 0\.4 that is asked: there "):
        plan_automatically(LINEAR_TASK, setup, replace(ROBUST, friction_error=0.4))


def test_an_arm_that_is_too_slow_is_named_joint_by_joint() -> None:
    limits = replace(LIMITS, joint_speed_rad_s=np.full(7, 0.4))
    with pytest.raises(InfeasibleError, match=r"joint \d speed: .* rad/s at t = .*, beyond 0\.4 rad/s"):
        plan_automatically(LINEAR_TASK, linear_setup(limits=limits), Wish(WEIGHTS[Objective.FAST]))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"friction_error": 1.0}, r"^wish: friction_error must be from 0 to below 1, got 1\.0$"),
        ({"turn_rad": 4.0}, r"^wish: turn_rad must be from 0 to pi, got 4\.0$"),
        ({"force_range": (2.0, 1.0)}, r"^wish: force_range must be two positive shares that grow, got \(2\.0, 1\.0\)$"),
    ],
)
def test_wishes_that_mean_nothing(change: dict[str, float], message: str) -> None:
    with pytest.raises(InputError, match=message):
        replace(ROBUST, **change)


def test_weights_that_wish_nothing() -> None:
    with pytest.raises(InputError, match=r"^wish: weights must be numbers from zero on, one of them positive, got \["):
        Weights()


def test_the_same_wish_is_the_same_plan(robust: Plan) -> None:
    again = plan_automatically(LINEAR_TASK, linear_setup(limits=PAPER_LIMITS), ROBUST)
    np.testing.assert_array_equal(again.course.times, robust.course.times)
    np.testing.assert_allclose(again.joints.position_rad, robust.joints.position_rad, atol=1e-9)
    assert BLOCK is again.setup.block
    assert isinstance(again.setup.fingers[0], PlacedFinger)
