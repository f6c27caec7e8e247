"""Sections III-A to III-C: the paper's equations as printed, and scipy with stick and slip written here."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from one_dof_draws import ACCELERATIONS, EXAMPLE, GOALS, PROFILES
from scipy.integrate import solve_ivp

from slidepipe.errors import InputError
from slidepipe.mechanics.one_dof import (
    Accelerations,
    Profile,
    finger_accelerations,
    relative_acceleration,
)

FACTORS = st.one_of(st.floats(0.02, 3.0), st.floats(0.9, 1.1), st.floats(3.0, 50.0))
"""Actual over estimated friction: of every kind, from slipping all the time to not sliding at all."""


def simulated(profile: Profile, b: float) -> tuple[float, float, float]:
    """Slide at the end of the finger's motion, its velocity there, and the slide at rest: two bodies and a switch.

    The state is ``q_f, dq_f, q_o, dq_o``; friction is ``+-b`` on a sliding object, and what sticking asks of it else.
    """
    way = -np.sign(profile.d_goal)
    a_f, a = profile.accelerations.a_f, profile.accelerations.a
    state = np.zeros(4)
    for ddq_f, duration in (
        (way * a, profile.T1),
        (-way * a_f, profile.T2),
        (way * a, profile.T3 + profile.T4),
    ):
        state = phase(state, ddq_f, duration=duration, b=b)
    d_T, dd_T = state[0] - state[2], state[1] - state[3]
    state = phase(state, 0.0, duration=abs(dd_T) / b * 1.01 + 1e-6, b=b)
    return d_T, dd_T, state[0] - state[2]


def phase(state: np.ndarray, ddq_f: float, *, duration: float, b: float) -> np.ndarray:
    t = 0.0
    while t < duration:
        sliding = np.sign(state[1] - state[3])
        if sliding == 0.0:
            sliding = np.sign(ddq_f) if abs(ddq_f) > b else 0.0
        ddq_o = sliding * b if sliding else ddq_f

        def caught_up(_: float, y: np.ndarray) -> float:
            return float(y[1] - y[3])

        caught_up.terminal, caught_up.direction = True, -sliding
        solution = solve_ivp(
            lambda _, y, ddq_o=ddq_o: [y[1], ddq_f, y[3], ddq_o],
            (t, duration),
            state,
            events=[caught_up] if sliding else None,
            rtol=1e-10,
            atol=1e-13,
        )
        t, state = solution.t[-1], solution.y[:, -1].copy()
        if solution.status == 1:
            state[3] = state[1]
    return state


@given(st.floats(-50, 50), st.floats(0.1, 20))
def test_a_resting_object_sticks_up_to_a_o_and_slides_beyond(ddq_f: float, a_o: float) -> None:
    found = relative_acceleration(ddq_f, 0.0, a_o)
    expected = 0.0 if abs(ddq_f) <= a_o else ddq_f - np.sign(ddq_f) * a_o
    assert found == pytest.approx(expected, abs=1e-14)


@given(st.floats(-50, 50), st.floats(1e-9, 10), st.sampled_from([-1.0, 1.0]), st.floats(0.1, 20))
def test_friction_on_a_sliding_object_is_a_o_along_the_slide(
    ddq_f: float, speed: float, way: float, a_o: float
) -> None:
    ddq_o = ddq_f - relative_acceleration(ddq_f, way * speed, a_o)
    assert ddq_o == pytest.approx(way * a_o, abs=1e-13)
    assert ddq_o * way * speed > 0.0, "friction takes power from the slide"


@given(st.floats(-50, 50), st.sampled_from([-0.3, 0.0, 0.2]), st.floats(0.1, 20))
def test_inverse_dynamics_undo_forward_dynamics(ddd_c: float, dd_c: float, a_o: float) -> None:
    for ddq_f in finger_accelerations(ddd_c, dd_c, a_o):
        assert relative_acceleration(ddq_f, dd_c, a_o) == pytest.approx(ddd_c, abs=1e-13)


def test_any_acceleration_within_a_o_keeps_an_object_sticking() -> None:
    lowest, highest = finger_accelerations(0.0, 0.0, 5.0)
    assert (lowest, highest) == (-5.0, 5.0)
    np.testing.assert_array_equal(relative_acceleration(np.linspace(lowest, highest, 11), 0.0, 5.0), 0.0)


@given(PROFILES)
def test_the_durations_are_those_of_the_paper(profile: Profile) -> None:
    """Eq. (4) as printed, and that it solves (1), (2) and (3)."""
    a_f, a_o, a = profile.accelerations.a_f, profile.accelerations.a_o, profile.accelerations.a
    T1, T2, T3, T4 = profile.T1, profile.T2, profile.T3, profile.T4
    d_goal = -abs(profile.d_goal)
    assert pytest.approx(a_f / a * np.sqrt(-d_goal * (a + a_o) / (2 * (a + a_f) * (a_f - a_o)))) == T1
    assert pytest.approx(np.sqrt(-2 * d_goal * (a + a_o) / ((a + a_f) * (a_f - a_o)))) == T2
    assert pytest.approx(np.sqrt(-2 * d_goal * (a_f - a_o) / ((a + a_f) * (a + a_o)))) == T3
    assert 2 * a * T1 == pytest.approx(a_f * T2, rel=1e-12)
    assert a_o * (T2 + T3) == pytest.approx(a * (2 * T1 - T3), rel=1e-9)
    assert d_goal == pytest.approx(-0.5 * (a_f - a_o) * (T2**2 + T2 * T3), rel=1e-12)
    assert T4 > 0.0
    assert pytest.approx(T1 + T2 + T3 + T4, rel=1e-14) == profile.T


@given(PROFILES)
def test_the_finger_ends_at_rest_where_it_began(profile: Profile) -> None:
    finger, T = profile.finger, profile.T
    highest = 0.5 * profile.accelerations.a * profile.T1**2
    assert finger.at(T) == pytest.approx(0.0, abs=1e-12 * highest)
    assert finger.at(T * (1 - 1e-12), 1) == pytest.approx(0.0, abs=1e-9 * profile.accelerations.a_f * T)
    assert finger.at(profile.T1, 1) == pytest.approx(-finger.at(profile.T1 + profile.T2, 1), rel=1e-12)
    assert finger.at(2 * T) == finger.at(T)
    assert finger.at([-1.0, T, 2 * T], 1).tolist() == finger.at([-1.0, T, 2 * T], 2).tolist() == [0.0, 0.0, 0.0]


@given(PROFILES)
def test_the_finger_accelerates_as_the_paper_says(profile: Profile) -> None:
    way = -np.sign(profile.d_goal)
    middles = profile.T1 * 0.5, profile.T1 + profile.T2 * 0.5, profile.T - profile.T4 * 0.5
    a_f, a = profile.accelerations.a_f, profile.accelerations.a
    np.testing.assert_allclose(profile.finger.at(middles, 2), way * np.array([a, -a_f, a]))


def test_a_line_motion_is_continuous_and_its_derivatives_are_its_own() -> None:
    motion = Profile(EXAMPLE, -0.1).slide(3.0).motion
    for low, high in pairwise(motion.breaks):
        t, h = 0.5 * (low + high), 1e-4 * (high - low)
        centred = (motion.at(t + h) - motion.at(t - h)) / (2 * h)
        assert motion.at(t, 1) == pytest.approx(centred, abs=1e-10)
        assert motion.at(t, 2) == pytest.approx((motion.at(t + h, 1) - motion.at(t - h, 1)) / (2 * h), abs=1e-8)
        for derivative in (0, 1):
            assert motion.at(low - 1e-13, derivative) == pytest.approx(motion.at(low, derivative), abs=1e-11)


@given(PROFILES)
def test_with_the_estimated_friction_it_slides_to_the_goal(profile: Profile) -> None:
    slide = profile.slide(profile.accelerations.a_o)
    assert slide.d == pytest.approx(profile.d_goal, rel=1e-11)
    assert slide.d_T == slide.d
    assert slide.slides
    assert slide.rests_at_T
    assert not slide.slips_in_T1
    assert slide.motion.at(profile.T1 + profile.T2 + profile.T3) == pytest.approx(profile.d_goal, rel=1e-11)
    assert slide.motion.at(profile.T1) == 0.0


@settings(deadline=None, max_examples=150)
@given(PROFILES, FACTORS)
@example(Profile(EXAMPLE, -0.1), 1.0)
@example(Profile(EXAMPLE, -0.1), 0.8)
@example(Profile(EXAMPLE, 0.1), 4.0)
@example(Profile(EXAMPLE, 0.1), 0.05)
def test_the_slide_is_that_of_an_integrated_motion_for_any_friction(profile: Profile, factor: float) -> None:
    b = factor * profile.accelerations.a_o
    slide = profile.slide(b)
    d_T, dd_T, d = simulated(profile, b)
    assert slide.d_T == pytest.approx(d_T, abs=1e-8)
    assert slide.d == pytest.approx(d, abs=1e-8)
    assert slide.dd_T == pytest.approx(dd_T, abs=1e-8)


@given(PROFILES, FACTORS)
def test_the_result_says_what_did_not_go_as_planned(profile: Profile, factor: float) -> None:
    a_f, a = profile.accelerations.a_f, profile.accelerations.a
    b = factor * profile.accelerations.a_o
    slide = profile.slide(b)
    assert slide.slides == (b < a_f)
    assert slide.slips_in_T1 == (b < a)
    assert slide.slips_in_T1 == (slide.motion.at(profile.T1) * profile.d_goal < 0.0)
    assert slide.rests_at_T == (b >= a)
    if not slide.slides:
        assert slide.d == 0.0
        np.testing.assert_array_equal(slide.motion.coefficients, 0.0)


@settings(deadline=None, max_examples=60)
@given(PROFILES, st.floats(0.01, 0.99))
@example(Profile(EXAMPLE, -0.1), 0.025)
def test_a_slippery_object_always_stops_before_the_finger_and_then_slips_back(profile: Profile, share: float) -> None:
    slide = profile.slide(share * profile.accelerations.a)
    assert slide.dd_T * profile.d_goal < 0.0
    assert (slide.d - slide.d_T) * profile.d_goal < 0.0
    _, dd_T, _ = simulated(profile, share * profile.accelerations.a)
    assert slide.dd_T == pytest.approx(dd_T, abs=1e-8)
    middle = profile.T1 + profile.T2
    assert slide.motion.at(middle, 1) * profile.d_goal > 0.0, "it did slide towards the goal"


@given(PROFILES, st.floats(0.0, 1.0))
def test_between_a_and_a_f_it_always_stops_before_the_finger_does(profile: Profile, share: float) -> None:
    a_f, a = profile.accelerations.a_f, profile.accelerations.a
    slide = profile.slide(min(a + share * (a_f - a), a_f))
    assert slide.rests_at_T
    assert slide.d * profile.d_goal >= 0.0


@given(PROFILES, FACTORS)
def test_friction_gives_no_more_than_it_can_and_only_burns(profile: Profile, factor: float) -> None:
    """Both begin and end at rest: what the finger puts in is what the slide burns. The midpoint rule is exact here."""
    b = factor * profile.accelerations.a_o
    slide, finger = profile.slide(b), profile.finger
    breaks = np.union1d(finger.breaks, slide.motion.breaks)
    breaks = breaks[np.append(True, np.diff(breaks) > 1e-12 * breaks[-1])]
    t, dt = 0.5 * (breaks[1:] + breaks[:-1]), np.diff(breaks)
    ddq_o = finger.at(t, 2) - slide.motion.at(t, 2)
    dd_c = slide.motion.at(t, 1)
    assert np.all(np.abs(ddq_o) <= b * (1 + 1e-9))
    sliding = dd_c != 0.0
    np.testing.assert_allclose((ddq_o * dd_c)[sliding], b * np.abs(dd_c)[sliding], rtol=1e-9)
    work, burnt = (ddq_o * finger.at(t, 1)) @ dt, b * np.abs(dd_c) @ dt
    assert work == pytest.approx(burnt, rel=1e-6, abs=1e-9 * (profile.accelerations.a_f * profile.T) ** 2)


@given(ACCELERATIONS, GOALS, FACTORS)
def test_a_goal_on_the_other_side_mirrors_the_motion(s: Accelerations, d_goal: float, factor: float) -> None:
    one, other = (Profile(s, sign * d_goal).slide(factor * s.a_o) for sign in (1, -1))
    assert one.d == -other.d
    assert one.dd_T == -other.dd_T
    np.testing.assert_array_equal(one.motion.coefficients, -other.motion.coefficients)


@given(PROFILES, FACTORS, st.floats(0.01, 100), st.floats(0.01, 100))
def test_other_units_of_length_and_time_tell_the_same(
    profile: Profile, factor: float, length: float, time: float
) -> None:
    s, unit = profile.accelerations, length / time**2
    there = Profile(Accelerations(s.a_f * unit, s.a_o * unit, s.a * unit), profile.d_goal * length)
    assert pytest.approx(profile.T1 * time, rel=1e-9) == there.T1
    here, scaled = profile.slide(factor * s.a_o), there.slide(factor * s.a_o * unit)
    size = np.max(np.abs(here.motion.coefficients[:, 0])) + abs(here.d) + abs(profile.d_goal)
    assert scaled.d / length == pytest.approx(here.d, abs=1e-9 * size)


@given(ACCELERATIONS, GOALS, st.floats(0.01, 1.0), FACTORS)
def test_the_slide_is_proportional_to_the_goal(s: Accelerations, d_goal: float, share: float, factor: float) -> None:
    whole, part = (Profile(s, goal).slide(factor * s.a_o) for goal in (d_goal, share * d_goal))
    size = np.max(np.abs(whole.motion.coefficients[:, 0])) + abs(whole.d)
    assert part.d / share == pytest.approx(whole.d, abs=1e-9 * size)


@pytest.mark.parametrize("name", ["a_f", "a_o", "a"])
@pytest.mark.parametrize("value", [0.0, -1.0, np.nan, np.inf])
def test_accelerations_are_positive_numbers(name: str, value: float) -> None:
    with pytest.raises(InputError, match=rf"^one DOF: {name} must be a positive number in m/s\^2, got {value!r}$"):
        Accelerations(**({"a_f": 20.0, "a_o": 5.0, "a": 4.0} | {name: value}))


def test_accelerations_are_in_the_papers_order() -> None:
    with pytest.raises(InputError, match=r"^one DOF: a must be below a_o = 5\.0 m/s\^2 so that it sticks, got 5\.0$"):
        Accelerations(a_f=20.0, a_o=5.0, a=5.0)
    with pytest.raises(InputError, match=r"^one DOF: a_f must be above a_o = 5\.0 m/s\^2 so that it slides, got 4\.5$"):
        Accelerations(a_f=4.5, a_o=5.0, a=4.0)


@pytest.mark.parametrize("d_goal", [0.0, np.nan, -np.inf])
def test_a_goal_is_a_length(d_goal: float) -> None:
    with pytest.raises(InputError, match=r"^one DOF: d_goal must be a finite length other than zero, got "):
        Profile(EXAMPLE, d_goal)


@pytest.mark.parametrize("b", [0.0, -2.0, np.nan, np.inf])
def test_an_actual_friction_is_positive(b: float) -> None:
    for refused in (
        lambda: Profile(EXAMPLE, -0.1).slide(b),
        lambda: relative_acceleration(1.0, 0.0, b),
        lambda: finger_accelerations(1.0, 0.0, b),
    ):
        with pytest.raises(InputError, match=r"^one DOF: a_o must be a positive number in m/s\^2, got "):
            refused()


def test_what_is_not_a_number_is_named() -> None:
    with pytest.raises(InputError, match=r"^one DOF: ddq_f must be finite, got nan$"):
        relative_acceleration(np.nan, 0.0, 5.0)
    with pytest.raises(InputError, match=r"^one DOF: dd_c must be finite, got inf$"):
        finger_accelerations(0.0, np.inf, 5.0)
    with pytest.raises(InputError, match=r"^line motion: times must be numbers, got nan$"):
        Profile(EXAMPLE, -0.1).finger.at(np.nan)
    with pytest.raises(InputError, match=r"^line motion: derivative must be 0, 1 or 2, got 3$"):
        Profile(EXAMPLE, -0.1).finger.at(0.0, 3)
