"""A plan down to the joints: what it commands is the motion that was planned, tick by tick."""

import dataclasses

import mujoco
import numpy as np
import pytest
from paper_cases import LINEAR, linear_setup, rotational_setup
from planning_setups import as_regrasp

from slidepipe.arm.model import HAND, nominal_model
from slidepipe.errors import InfeasibleError, InputError
from slidepipe.mechanics.planar import MotionPlane
from slidepipe.planning.planner import Plan, Setup, plan, stick_load


@pytest.fixture(params=["linear", "rotational"])
def planned(request: pytest.FixtureRequest) -> tuple[Plan, Setup]:
    setup = linear_setup() if request.param == "linear" else rotational_setup()
    return request.getfixturevalue(f"{request.param}_plan"), setup


def test_a_reference_has_a_sample_for_every_tick(planned: tuple[Plan, Setup]) -> None:
    chosen, _ = planned
    count = round(chosen.course.boundaries[-1] / 0.002) + 1
    np.testing.assert_allclose(chosen.joints.time_s, np.arange(count) * 0.002, atol=1e-12)
    assert chosen.joints.position_rad.shape == chosen.load.feedforward_n_m.shape == (count, 7)
    for boundary in chosen.course.boundaries:
        assert np.any(chosen.motion.time_s == boundary)


def test_the_joints_put_the_hand_where_the_motion_has_it(planned: tuple[Plan, Setup]) -> None:
    chosen, setup = planned
    model = nominal_model(setup.tool)
    data = mujoco.MjData(model)
    position, matrix = setup.plane.lift(chosen.motion.q_f)
    jacobian, site = np.empty((6, 7)), model.site(HAND).id
    for index in range(0, len(position), 5):
        data.qpos[:] = chosen.joints.position_rad[index]
        mujoco.mj_forward(model, data)
        mujoco.mj_jacSite(model, data, jacobian[:3], jacobian[3:], site)
        np.testing.assert_allclose(data.site(HAND).xpos, position[index], atol=1e-7)
        np.testing.assert_allclose(data.site(HAND).xmat.reshape(3, 3), matrix[index], atol=1e-6)
        velocity = setup.plane.axes.T @ (jacobian @ chosen.joints.velocity_rad_s[index]).reshape(2, 3).T
        expected = chosen.motion.dq_f[index]
        np.testing.assert_allclose(velocity[:, 0], [expected[0], expected[1], 0.0], atol=1e-5)
        np.testing.assert_allclose(velocity[:, 1], [0.0, 0.0, expected[2]], atol=1e-5)


def test_a_plan_keeps_the_choice_that_it_made(planned: tuple[Plan, Setup]) -> None:
    chosen, _ = planned
    slide = np.argmax(chosen.motion.time_s >= chosen.course.slide_s)
    np.testing.assert_allclose(chosen.course.dq_o_slide, chosen.motion.dq_o[slide], atol=1e-12)
    np.testing.assert_allclose(chosen.course.q_o_slide, chosen.motion.q_o[slide], atol=1e-12)
    np.testing.assert_allclose(chosen.course.q_o_end, chosen.motion.q_o[-1], atol=1e-12)


def test_the_stick_load_is_the_larger_of_the_two_margins(planned: tuple[Plan, Setup]) -> None:
    chosen, setup = planned
    used = [check.value for check in chosen.margins if check.name.startswith("share of the friction")]
    assert stick_load(as_regrasp(chosen.course), setup) == pytest.approx(max(used), rel=1e-12)


@pytest.mark.parametrize("times", [{"T1": 0.301}, {"T23": 0.202}, {"T4": 1.0999}, {"T1": 0.301, "T4": 1.099}])
def test_phases_fall_on_ticks(times: dict[str, float]) -> None:
    """T23 = 0.202 s would change its sign between two ticks."""
    regrasp = dataclasses.replace(LINEAR, **times)
    with pytest.raises(InputError, match=r"^regrasp: its times must fall on the control loop's ticks of 2 ms, T23 on"):
        plan(regrasp, linear_setup())


def test_a_plane_out_of_reach_is_refused_with_the_time() -> None:
    setup = dataclasses.replace(linear_setup(), plane=MotionPlane(np.array([0.9, -0.4, 0.5]), np.pi / 2))
    with pytest.raises(InfeasibleError, match=r"the hand cannot reach its pose at t = 0\.\d{3} s within the joint"):
        plan(LINEAR, setup)
