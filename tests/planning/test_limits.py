"""Every kind of limit names itself: what was reached, what is allowed, and when."""

import dataclasses
import re

import numpy as np
import pytest
from paper_cases import LIMITS, LINEAR, ROTATIONAL, linear_finger, linear_setup, rotational_finger, rotational_setup

from slidepipe.arm.dynamics import ArmLoad
from slidepipe.arm.inverse_kinematics import JointPath
from slidepipe.errors import InfeasibleError, InputError
from slidepipe.planning.limits import Check, Limits, check_arm
from slidepipe.planning.planner import Plan, Setup, plan
from slidepipe.planning.three_phase import Regrasp

LINE = re.compile(r"^(.+): (\S+) (.+) at t = (\d\.\d{3}) s, beyond (\S+) (.+)$")
STILL = np.zeros((3, 7))


def tight(**changes: object) -> Limits:
    return dataclasses.replace(LIMITS, **changes)


def refusal(regrasp: Regrasp, setup: Setup) -> dict[str, tuple[float, str, float, float]]:
    """Value, unit, time and bound of every limit that a plan breaks, by name."""
    with pytest.raises(InfeasibleError) as refused:
        plan(regrasp, setup)
    found = [LINE.match(line) for line in refused.value.lines]
    assert all(found), refused.value.lines
    assert all(line[3] == line[6] for line in found if line)
    return {line[1]: (float(line[2]), line[3], float(line[4]), float(line[5])) for line in found if line}


def test_two_newtons_and_a_half_in_all_are_beyond_the_arm_in_the_linear_example() -> None:
    broken = refusal(LINEAR, linear_setup(linear_finger(normal_force_n=2.5)))
    assert broken["hand speed"] == (pytest.approx(4.7, abs=0.05), "m/s", 0.3, 3.0)
    assert broken["hand from the middle of the workspace"][0] > 1.0


def test_five_newtons_in_all_are_beyond_the_arm_in_the_rotational_example() -> None:
    broken = refusal(ROTATIONAL, rotational_setup(rotational_finger(normal_force_n=5.0)))
    assert broken["hand speed"] == (pytest.approx(6.6, abs=0.05), "m/s", 0.3, 3.0)


def test_a_workspace_that_is_too_small(linear_plan: Plan) -> None:
    far = np.linalg.norm(linear_plan.motion.q_f[:, :2], axis=1)
    broken = refusal(LINEAR, linear_setup(limits=tight(workspace_radius_m=0.3)))
    worst = (pytest.approx(far.max(), rel=1e-3), "m", pytest.approx(far.argmax() * 0.002), 0.3)
    assert broken == {"hand from the middle of the workspace": worst}


def test_a_workspace_whose_middle_is_elsewhere() -> None:
    broken = refusal(LINEAR, linear_setup(limits=tight(workspace_centre_m=np.array([0.3, 0.3]))))
    assert list(broken) == ["hand from the middle of the workspace"]


def test_a_hand_that_is_too_fast() -> None:
    broken = refusal(LINEAR, linear_setup(limits=tight(tip_speed_m_s=1.5)))
    assert broken == {"hand speed": (pytest.approx(1.83, abs=0.01), "m/s", 0.3, 1.5)}


def test_a_grip_that_is_to_be_used_less() -> None:
    broken = refusal(LINEAR, linear_setup(limits=tight(stick_load=0.7)))
    assert list(broken) == ["share of the friction used while sticking before the slide"]
    value, unit, time_s, bound = broken["share of the friction used while sticking before the slide"]
    assert (value, unit, time_s, bound) == (pytest.approx(0.76, abs=0.01), "of 1", 0.0, 0.7)


def test_a_grip_that_cannot_hold_the_block() -> None:
    """Half the friction: the block slips before the slide and after it."""
    broken = refusal(LINEAR, linear_setup(linear_finger(friction=0.19)))
    used = "share of the friction used while sticking"
    assert set(broken) == {f"{used} before the slide", f"{used} after the slide"}
    assert all(value > 1.0 for value, *_ in broken.values())
    assert broken[f"{used} after the slide"][2] >= 0.5


def test_a_contact_beside_the_face() -> None:
    beyond = dataclasses.replace(LINEAR, r_goal=np.array([0.01, 0.055, np.pi]))
    broken = refusal(beyond, linear_setup())
    value, unit, time_s, bound = broken["contact point from the middle of the face to its edge"]
    assert (value, unit, bound) == (pytest.approx(0.055 / 0.05), "of 1", 1.0)
    assert time_s == pytest.approx(0.5)


def test_joints_that_are_too_fast(linear_plan: Plan) -> None:
    speeds = np.abs(linear_plan.joints.velocity_rad_s)
    broken = refusal(LINEAR, linear_setup(limits=tight(joint_speed_rad_s=np.full(7, 2.0))))
    worst = {f"joint {joint + 1} speed": speeds[:, joint] for joint in range(7) if speeds[:, joint].max() > 2.0}
    assert len(worst) >= 2
    assert broken == {
        name: (pytest.approx(values.max(), rel=1e-3), "rad/s", pytest.approx(values.argmax() * 0.002), 2.0)
        for name, values in worst.items()
    }


def test_joints_that_are_too_weak(linear_plan: Plan) -> None:
    weak = np.array([77.3, 50.0, 95.6, 29.4, 11.6, 11.6, 2.7])
    broken = refusal(LINEAR, linear_setup(limits=tight(joint_torque_n_m=weak)))
    worst = np.abs(linear_plan.load.torque_n_m[:, 1]).max()
    assert list(broken) == ["joint 2 torque"]
    assert broken["joint 2 torque"][0] == pytest.approx(worst, rel=1e-3)
    assert broken["joint 2 torque"][1::2] == ("N m", 50.0)


def test_an_elbow_that_is_too_fast(linear_plan: Plan) -> None:
    broken = refusal(LINEAR, linear_setup(limits=tight(elbow_speed_m_s=1.5)))
    assert broken["elbow speed"][0] == pytest.approx(linear_plan.load.elbow_speed_m_s.max(), rel=1e-3)
    assert list(broken) == ["elbow speed"]


def test_a_joint_beyond_its_range_on_either_side() -> None:
    """Joint 5 turns from -4.76 to 1.24 rad."""
    time_s = np.arange(3) * 0.002
    for angle, satisfied in ((-4.7, True), (1.2, True), (-4.8, False), (1.3, False)):
        path = JointPath(time_s, np.array([[0.0] * 4 + [a, 0.0, 0.0] for a in (0.0, angle, 0.0)]), STILL, STILL)
        checks = check_arm(path, ArmLoad(STILL, STILL, np.zeros(3)), LIMITS)
        fifth = next(check for check in checks if check.name == "joint 5 angle from the middle of its range")
        assert (fifth.satisfied, fifth.bound, fifth.time_s) == (satisfied, pytest.approx(3.0), 0.002)
        assert fifth.value == pytest.approx(abs(angle + 1.76))


def test_a_plan_says_how_near_it_comes_to_every_limit(linear_plan: Plan) -> None:
    names = [check.name for check in (*linear_plan.margins, *linear_plan.limits)]
    kinds = ("angle from the middle of its range", "speed", "torque")
    assert {f"joint {joint} {kind}" for joint in range(1, 8) for kind in kinds} <= set(names)
    assert {"hand speed", "elbow speed", "hand from the middle of the workspace"} <= set(names)
    assert {"hand speed at rest", "jump in the hand's pose", "jump in the hand's velocity"} <= set(names)
    assert len(names) == len(set(names)) == 30
    assert all(check.satisfied for check in (*linear_plan.margins, *linear_plan.limits))


def test_a_check_in_words() -> None:
    met = Check("hand speed", 1.8289, 3.0, "m/s", 0.3)
    assert str(met) == "hand speed: 1.829 m/s at t = 0.300 s, within 3 m/s"
    assert str(dataclasses.replace(met, bound=1.5)) == "hand speed: 1.829 m/s at t = 0.300 s, beyond 1.5 m/s"
    assert dataclasses.replace(met, bound=1.8289).satisfied
    barely = dataclasses.replace(met, value=0.9500004, bound=0.95)
    assert str(barely) == "hand speed: 0.9500004 m/s at t = 0.300 s, beyond 0.95 m/s"


@pytest.mark.parametrize("name", ["joint_speed_rad_s", "joint_torque_n_m"])
def test_limits_are_for_seven_joints(name: str) -> None:
    with pytest.raises(InputError, match=rf"^limits: {name} must be 7 numbers, got "):
        tight(**{name: np.ones(6)})
