import pytest
from synthetic import CASE_A, CASE_B, Cameras, joint_hand, request, simulate

from slidepipe.errors import EstimationError
from slidepipe.estimation.estimate import estimate


@pytest.mark.parametrize(("case", "late_s"), [(CASE_A, 0.04), (CASE_B, -0.06)])
def test_a_late_joint_log_is_found_to_a_twentieth_of_a_millisecond(case, late_s):
    world = simulate(case, 0.38, 21)
    found = estimate(request(world, Cameras(seed=21, joints_late_s=late_s)))
    assert found.joints.sd_s < 1e-4
    assert found.joints.offset_s == pytest.approx(late_s, abs=max(4 * found.joints.sd_s, 5e-5))
    start = found.host_ns(found.slide.start_s) * 1e-9 + late_s - 1.1
    assert start == pytest.approx(world.slide[0], abs=0.015)
    assert found.friction.kappa_m_s2 == pytest.approx(world.kappa, rel=0.01)


@pytest.mark.parametrize(("case", "tilt_rad"), [(CASE_A, 0.03), (CASE_B, -0.02)])
def test_tilted_cameras_do_not_bend_the_friction(case, tilt_rad):
    world = simulate(case, 0.38, 22)
    found = estimate(request(world, Cameras(seed=22, tilt_rad=tilt_rad)))
    assert found.joints.tilt_rad == pytest.approx(tilt_rad, abs=4 * found.joints.tilt_sd_rad)
    assert found.friction.kappa_m_s2 == pytest.approx(world.kappa, rel=0.008)


def test_a_joint_log_of_another_time_is_told():
    world = simulate(CASE_A, 0.38, 23)
    with pytest.raises(EstimationError, match="0 camera frames lie within the joint log"):
        estimate(request(world, Cameras(seed=23), joint_hand=joint_hand(world, 500.0)))
