"""The three-phase motion: published numbers, Newton's laws on dense samples, and a block that is simulated freely."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from paper_cases import BLOCK, FRICTION, LINEAR, ROTATIONAL, linear_finger, rotational_finger
from planning_setups import CASES, dense, slide_freely

from slidepipe.errors import InputError
from slidepipe.mechanics.limit_surface import SoftFinger
from slidepipe.planning.course import Motion
from slidepipe.planning.three_phase import Regrasp, ThreePhaseMotion

both = pytest.mark.parametrize("case", CASES)


def planned(case: str) -> tuple[Regrasp, SoftFinger, ThreePhaseMotion]:
    regrasp, finger = CASES[case]
    return regrasp, finger(), ThreePhaseMotion(regrasp, BLOCK, finger())


def contact_wrench(q_o: np.ndarray, ddq_o: np.ndarray, q_f: np.ndarray) -> np.ndarray:
    """(T, 3) what the finger does to the block, in {b} about the contact: Newton and Euler in complex numbers."""
    into_body = np.exp(-1j * q_o[:, 2])
    force = into_body * BLOCK.m * (ddq_o[:, 0] + 1j * (ddq_o[:, 1] + 9.81))
    arm = into_body * (q_f[:, 0] - q_o[:, 0] + 1j * (q_f[:, 1] - q_o[:, 1]))
    inertia = BLOCK.m * (0.06**2 + 0.1**2) / 12
    moment = inertia * ddq_o[:, 2] - (np.conj(arm) * force).imag
    return np.column_stack([force.real, force.imag, moment])


@pytest.mark.parametrize(("regrasp", "published"), [(LINEAR, (2, 4, 0)), (ROTATIONAL, (2, 0, 25 * np.pi))])
def test_the_relative_acceleration_is_the_papers(regrasp: Regrasp, published: tuple[float, float, float]) -> None:
    np.testing.assert_allclose(regrasp.ddr, published, atol=1e-12)


@pytest.mark.parametrize(("normal_force_n", "start", "peak"), [(1.25, (-1.33, -1.25), 1.8), (2.5, (-2.67, -3.92), 4.7)])
def test_both_readings_of_the_linear_example_move_as_published(
    normal_force_n: float, start: tuple[float, float], peak: float
) -> None:
    """Start of sliding, and the peak speed of the hand."""
    motion = ThreePhaseMotion(LINEAR, BLOCK, linear_finger(normal_force_n=normal_force_n))
    np.testing.assert_allclose(motion.dq_o_slide, [*start, 0.0], atol=0.006)
    speed = np.linalg.norm(motion.sample(dense(LINEAR.boundaries)).dq_f[:, :2], axis=1)
    assert speed.max() == pytest.approx(peak, abs=0.05)


@pytest.mark.parametrize(("normal_force_n", "spin"), [(2.5, 11.0), (5.0, 22.0)])
def test_both_readings_of_the_rotational_example_spin_as_published(normal_force_n: float, spin: float) -> None:
    motion = ThreePhaseMotion(ROTATIONAL, BLOCK, rotational_finger(normal_force_n=normal_force_n))
    assert motion.dq_o_slide[2] == pytest.approx(spin, abs=0.1)


@both
def test_everything_begins_and_ends_at_rest_where_it_was_asked(case: str) -> None:
    regrasp, _, motion = planned(case)
    at = motion.sample(regrasp.boundaries[[0, -1]])
    np.testing.assert_allclose(at.q_o[0], regrasp.q_o_start, atol=1e-15)
    np.testing.assert_allclose(at.q_f[1], regrasp.q_f_end, atol=1e-9)
    np.testing.assert_allclose(at.r_b, [regrasp.r_start, regrasp.r_goal], atol=1e-15)
    np.testing.assert_array_equal(np.concatenate([at.dq_o, at.dq_f, at.dr_b]), 0.0)
    np.testing.assert_array_equal(at.ddq_f[1], 0.0)


@both
def test_no_velocity_jumps_at_a_boundary(case: str) -> None:
    regrasp, _, motion = planned(case)
    gap = 1e-8
    before, after = (motion.sample(regrasp.boundaries[1:] + side) for side in (-gap, gap))
    for name in ("q_o", "q_f", "r_b", "dq_o", "dq_f", "dr_b"):
        np.testing.assert_allclose(getattr(after, name), getattr(before, name), atol=5e-6, err_msg=name)
    jumps = np.linalg.norm(after.ddq_f - before.ddq_f, axis=1)
    assert np.all(jumps > 0.5), "the accelerations do jump there"


@both
def test_velocities_and_accelerations_are_the_derivatives_of_the_poses(case: str) -> None:
    regrasp, _, motion = planned(case)
    h = 2e-4
    middles = np.concatenate([np.linspace(a + 2 * h, b - 2 * h, 9) for a, b in zip(*boundaries(regrasp), strict=True)])
    before, at, after = (motion.sample(middles + shift) for shift in (-h, 0.0, h))
    for pose, speed, acceleration in (("q_o", "dq_o", "ddq_o"), ("q_f", "dq_f", "ddq_f")):
        first, last = getattr(before, pose), getattr(after, pose)
        np.testing.assert_allclose(getattr(at, speed), (last - first) / (2 * h), atol=5e-5)
        second = (last + first - 2 * getattr(at, pose)) / h**2
        np.testing.assert_allclose(getattr(at, acceleration), second, atol=5e-3)
    np.testing.assert_allclose(at.dr_b, (after.r_b - before.r_b) / (2 * h), atol=1e-9)


def boundaries(regrasp: Regrasp) -> tuple[np.ndarray, np.ndarray]:
    return regrasp.boundaries[:-1], regrasp.boundaries[1:]


def phases(motion: Motion, regrasp: Regrasp) -> tuple[np.ndarray, np.ndarray]:
    """Masks of sticking and of sliding, each without its boundaries."""
    (_, t1, _, t3, t4), t = regrasp.boundaries, motion.time_s
    return ((t < t1 - 1e-9) | (t > t3 + 1e-9)) & (t < t4 - 1e-9), (t > t1 + 1e-9) & (t < t3 - 1e-9)


@both
def test_the_slide_uses_all_of_the_friction_the_way_it_slides(case: str) -> None:
    regrasp, finger, motion = planned(case)
    sampled = motion.sample(dense(regrasp.boundaries))
    sliding = phases(sampled, regrasp)[1]
    wrench = contact_wrench(sampled.q_o, sampled.ddq_o, sampled.q_f)[sliding] / finger.semi_axes
    np.testing.assert_allclose(np.linalg.norm(wrench, axis=1), 1.0, rtol=1e-9)
    np.testing.assert_allclose(sampled.load[sliding], 1.0, rtol=1e-9)
    normal = sampled.dr_b[sliding] * finger.semi_axes
    np.testing.assert_allclose(wrench, normal / np.linalg.norm(normal, axis=1)[:, None], atol=1e-8)


@both
def test_sticking_stays_within_the_friction_and_the_load_says_how_far(case: str) -> None:
    regrasp, finger, motion = planned(case)
    sampled = motion.sample(dense(regrasp.boundaries))
    sticking = phases(sampled, regrasp)[0]
    wrench = contact_wrench(sampled.q_o, sampled.ddq_o, sampled.q_f)[sticking]
    np.testing.assert_allclose(
        sampled.load[sticking], np.sqrt(np.sum((wrench / finger.semi_axes) ** 2, axis=1)), rtol=1e-9
    )
    assert sampled.load[sticking].max() < 0.8
    np.testing.assert_array_equal(sampled.dr_b[sticking], 0.0)
    np.testing.assert_allclose(
        sampled.ddq_o[sampled.time_s < 0.29], np.tile(motion.ddq_o_stick, (290, 1)), rtol=1e-13, atol=1e-13
    )


@both
def test_a_free_block_ends_at_the_goal(case: str) -> None:
    regrasp, finger = CASES[case]
    r_end, block = slide_freely(regrasp, finger(), finger())
    np.testing.assert_allclose(r_end, regrasp.r_goal, atol=1e-5)
    assert block.slides[0][0] == pytest.approx(regrasp.boundaries[1], abs=1e-9)
    assert block.slides[-1][1] == pytest.approx(regrasp.boundaries[3], abs=1e-5)


@pytest.mark.parametrize("share", [1.05, 1.1, 1.15, 1.2])
def test_more_friction_shortens_the_linear_slide_as_the_triangle_of_section_iii(share: float) -> None:
    """One degree of freedom: a speed that rises at a_1 for T23 / 2 and then falls at a_3."""
    friction, relative = FRICTION * 1.25 / BLOCK.m, np.hypot(2.0, 4.0)
    a_1 = relative - (share - 1) * friction
    a_3 = (share - 1) * friction + relative
    r_end, _ = slide_freely(LINEAR, linear_finger(), linear_finger(share * FRICTION))
    slid = r_end - LINEAR.r_start
    assert np.linalg.norm(slid[:2]) == pytest.approx(0.5 * a_1 * 0.1**2 * (1 + a_1 / a_3), rel=1e-4)
    assert slid[2] == pytest.approx(0.0, abs=1e-6)
    assert np.linalg.norm((r_end - LINEAR.r_goal)[:2]) < np.hypot(0.02, 0.04)


def test_22_percent_more_friction_and_the_linear_slide_does_not_begin() -> None:
    r_end, block = slide_freely(LINEAR, linear_finger(), linear_finger(1.22 * FRICTION))
    np.testing.assert_array_equal(r_end, LINEAR.r_start)
    assert block.slides == []


def test_21_percent_less_friction_and_the_linear_slide_throws_the_block() -> None:
    """It leaves the face long before; how far it would go is published as 0.17 m."""
    r_end, _ = slide_freely(LINEAR, linear_finger(), linear_finger(0.79 * FRICTION), end_s=0.9)
    assert np.linalg.norm((r_end - LINEAR.r_start)[:2]) == pytest.approx(0.17, rel=0.15)
    assert np.abs(r_end[1]) > 0.05


TICKS = st.integers(5, 200)
SHIFTS = st.tuples(st.floats(-0.02, 0.02), st.floats(-0.03, 0.03), st.floats(-1.0, 1.0)).map(np.array)
REGRASPS = st.builds(
    lambda start, step, theta, ticks, half_slide: Regrasp(
        q_o_start=np.array([0.1, -0.2, theta]),
        r_start=start,
        r_goal=start + step + [0.001, 0.0, 0.0],
        q_f_end=np.array([0.05, 0.1, theta + start[2] + 0.4]),
        T1=0.002 * ticks[0],
        T23=0.004 * half_slide,
        T4=0.002 * ticks[1],
    ),
    SHIFTS,
    SHIFTS.filter(lambda step: step[0] != -0.001),
    st.floats(-3, 3),
    st.tuples(TICKS, TICKS),
    st.integers(10, 60),
)


@settings(max_examples=25)
@given(REGRASPS)
def test_any_regrasp_ends_where_it_was_asked(regrasp: Regrasp) -> None:
    motion = ThreePhaseMotion(regrasp, BLOCK, rotational_finger())
    end = motion.sample(regrasp.boundaries[-1:])
    np.testing.assert_allclose(end.q_f[0], regrasp.q_f_end, atol=1e-8)
    np.testing.assert_allclose(end.r_b[0], regrasp.r_goal, atol=1e-12)
    shortly_before = motion.sample(regrasp.boundaries[-1:] - 1e-7)
    reach = 1e-6 * max(1.0, float(np.abs(motion.ddq_o_settle).max()))
    np.testing.assert_allclose(shortly_before.dq_f[0], 0.0, atol=reach)


@settings(max_examples=50)
@given(TICKS, st.integers(5, 100), TICKS)
def test_at_a_tick_on_a_boundary_the_phase_that_begins_there_counts(first: int, half_slide: int, last: int) -> None:
    regrasp = dataclasses.replace(LINEAR, T1=0.002 * first, T23=0.004 * half_slide, T4=0.002 * last)
    motion = ThreePhaseMotion(regrasp, BLOCK, linear_finger())
    ticks = np.cumsum([0, first, half_slide, half_slide, last])
    at = motion.sample(np.arange(ticks[-1] + 1) * 0.002)
    after = motion.sample(ticks[:-1] * 0.002 + 1e-7)
    np.testing.assert_allclose(at.ddq_o[ticks[:-1]], after.ddq_o, rtol=1e-3, atol=1e-3)
    np.testing.assert_allclose(at.ddq_f[ticks[:-1]], after.ddq_f, rtol=1e-3, atol=1e-2)
    np.testing.assert_array_equal([at.dq_o[-1], at.ddq_o[-1], at.ddq_f[-1]], 0.0)


@pytest.mark.parametrize("name", ["T1", "T23", "T4"])
@pytest.mark.parametrize("value", [0.0, -0.1, np.nan, np.inf])
def test_phases_take_time(name: str, value: float) -> None:
    with pytest.raises(InputError, match=rf"^regrasp: {name} must be a positive time in s, got {value!r}$"):
        dataclasses.replace(LINEAR, **{name: value})


def test_a_goal_that_is_reached_already_is_refused() -> None:
    with pytest.raises(InputError, match=r"^regrasp: the goal is where the finger already is: nothing to slide$"):
        dataclasses.replace(LINEAR, r_goal=LINEAR.r_start.copy())
