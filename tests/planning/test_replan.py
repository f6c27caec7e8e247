"""The next plan: shorter with the square root of what is left, as safe, and at the goal."""

import dataclasses

import numpy as np
import pytest
from paper_cases import LIMITS, LINEAR, ROTATIONAL, linear_finger, linear_setup, rotational_finger, rotational_setup
from planning_setups import as_regrasp, slide_freely

from slidepipe.errors import InfeasibleError, InputError
from slidepipe.planning.planner import stick_load
from slidepipe.planning.predict import SampledHand
from slidepipe.planning.replan import SAFE_LOAD, SHORTEST_SLIDE_S, replan, slide_distance
from slidepipe.planning.three_phase import Regrasp


def left(first: Regrasp, share: float) -> np.ndarray:
    """Where the last trial ended: on the way with a share of it still to go."""
    return first.r_goal + share * (first.r_start - first.r_goal)


@pytest.mark.parametrize("share", [1.0, 0.64, 0.25, 0.04])
def test_a_correction_takes_the_square_root_of_its_share_of_the_way(share: float) -> None:
    chosen = replan(LINEAR, left(LINEAR, share), linear_setup())
    assert pytest.approx(0.2 * np.sqrt(share), abs=0.0021) == chosen.course.T23
    np.testing.assert_allclose(chosen.course.ddr, LINEAR.ddr, rtol=0.12)
    assert chosen.course.T1 == chosen.course.T4


def test_a_slide_is_never_shorter_than_the_arm_can_follow() -> None:
    chosen = replan(LINEAR, left(LINEAR, 0.001), linear_setup())
    assert 0 <= chosen.course.T23 - SHORTEST_SLIDE_S < 0.004
    assert np.linalg.norm(chosen.course.ddr) < np.linalg.norm(LINEAR.ddr)


OVERSHOT = np.array([0.0115, 0.023, np.pi])
OVERTURNED = np.array([0.012, 0.0245, np.pi + 0.05])
BESIDE = np.array([0.004, 0.012, np.pi - 0.1])
TURNED = np.array([0.008, 0.0405, 0.98 * np.pi])


@pytest.mark.parametrize("r_now", [OVERSHOT, BESIDE], ids=["overshot", "beside"])
def test_a_linear_correction_ends_at_the_goal_and_holds_safely(r_now: np.ndarray) -> None:
    chosen = as_regrasp(replan(LINEAR, r_now, linear_setup()).course)
    np.testing.assert_array_equal(chosen.r_start, r_now)
    for name in ("r_goal", "q_f_end", "q_o_start"):
        np.testing.assert_allclose(getattr(chosen, name), getattr(LINEAR, name), atol=1e-15)
    assert stick_load(chosen, linear_setup()) <= SAFE_LOAD
    np.testing.assert_allclose(slide_freely(chosen, linear_finger(), linear_finger())[0], LINEAR.r_goal, atol=1e-5)


def test_a_rotational_correction_ends_at_the_goal_and_holds_safely() -> None:
    chosen = as_regrasp(replan(ROTATIONAL, TURNED, rotational_setup()).course)
    assert stick_load(chosen, rotational_setup()) <= SAFE_LOAD
    r_end, _ = slide_freely(chosen, rotational_finger(), rotational_finger())
    np.testing.assert_allclose(r_end, ROTATIONAL.r_goal, atol=1e-5)


def test_a_correction_believes_in_the_friction_that_it_is_given() -> None:
    """After a first trial in a world with 10 % more friction: the estimate brings the rest to the goal."""
    true = linear_finger(1.1 * 0.38)
    r_now, _ = slide_freely(LINEAR, linear_finger(), true)
    assert np.linalg.norm((r_now - LINEAR.r_goal)[:2]) > 0.02
    informed = as_regrasp(replan(LINEAR, r_now, linear_setup(true)).course)
    np.testing.assert_allclose(slide_freely(informed, true, true)[0], LINEAR.r_goal, atol=1e-5)
    deceived = as_regrasp(replan(LINEAR, r_now, linear_setup()).course)
    missed = slide_freely(deceived, linear_finger(), true)[0] - LINEAR.r_goal
    assert 0.002 < np.linalg.norm(missed[:2]) < np.linalg.norm((r_now - LINEAR.r_goal)[:2])


def test_where_no_choice_is_safe_the_one_that_breaks_least_is_named() -> None:
    setup = linear_setup(limits=dataclasses.replace(LIMITS, workspace_radius_m=0.005))
    with pytest.raises(InfeasibleError, match=r"hand from the middle of the workspace: .*, beyond 0\.005 m") as refused:
        replan(LINEAR, left(LINEAR, 0.25), setup)
    assert len(refused.value.lines) == 1


def test_a_safe_correction_goes_before_a_quick_one() -> None:
    """Weak friction: equally long phases would need more than the safe share, longer sticking phases do not."""
    setup = linear_setup()
    chosen = as_regrasp(replan(LINEAR, left(LINEAR, -0.1), setup).course)
    quick = dataclasses.replace(chosen, T1=chosen.T23, T4=chosen.T23)
    assert stick_load(quick, setup) > SAFE_LOAD >= stick_load(chosen, setup)
    assert chosen.T1 > chosen.T23


def test_where_none_is_safe_the_gentlest_that_the_arm_can_do_is_chosen() -> None:
    gentle = replan(
        LINEAR, OVERTURNED, linear_setup(limits=dataclasses.replace(LIMITS, joint_speed_rad_s=np.full(7, 6.0)))
    )
    hasty = replan(LINEAR, OVERTURNED, linear_setup())
    loads = [stick_load(as_regrasp(chosen.course), linear_setup()) for chosen in (gentle, hasty)]
    assert SAFE_LOAD < loads[0] < loads[1] < 1.0


def test_nothing_to_correct_is_refused() -> None:
    with pytest.raises(InputError, match=r"nothing to slide"):
        replan(LINEAR, LINEAR.r_goal.copy(), linear_setup())


def test_the_distance_of_a_turn_is_measured_on_the_limit_surface() -> None:
    """Sliding by rho and turning by one radian are as far: each dissipates as much."""
    finger = rotational_finger()
    rho = finger.a * finger.c
    for step in (np.array([rho, 0.0, 0.0]), np.array([0.0, 0.0, 1.0]), np.array([0.003, -0.004, 0.7])):
        work = float(finger.friction(step) @ step)
        assert slide_distance(np.zeros(3), step, rho) == pytest.approx(work / (finger.mu * finger.f_N), rel=1e-12)


def test_a_phase_shorter_than_a_tick_is_no_piece_of_its_own() -> None:
    time_s = 0.002 * np.arange(11)
    poses = np.column_stack([time_s**2, time_s, 0.0 * time_s])
    hand = SampledHand(time_s, poses, np.array([0.0, 0.0101, 0.0103, 0.02]))
    told = hand.resampled(2)
    np.testing.assert_allclose(told[:, 0], np.linspace(0.0, 0.02, 21) ** 2, atol=1e-12)
