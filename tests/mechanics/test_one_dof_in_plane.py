"""Section III by the planar simulation and by MuJoCo, neither of which knows the closed forms."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from one_dof_draws import PROFILES

from slidepipe.lab.grip_model import ContactSettings
from slidepipe.lab.planar_rig import planar_rig, run_rig
from slidepipe.mechanics.dynamics import Block
from slidepipe.mechanics.limit_surface import SoftFinger
from slidepipe.mechanics.one_dof import Accelerations, Profile
from slidepipe.mechanics.one_dof_in_plane import falling_hand, simulated_slide, stopping_time
from slidepipe.mechanics.stepping import PlacedFinger


@given(PROFILES, st.floats(0.05, 25.0))
def test_planar_simulation_slides_as_far_as_the_closed_form(profile: Profile, wrong: float) -> None:
    """Also where friction is so low that the object slips all the time and its slide turns round."""
    s, actual = profile.accelerations, wrong * profile.accelerations.a_o
    assume(abs(actual - s.a) > 1e-6 * s.a)
    assume(abs(actual - s.a_f) > 1e-6 * s.a_f)
    slid = simulated_slide(profile, mu=actual / 10.0, f_N=10.0, m=1.0)
    assert slid == pytest.approx(profile.slide(actual).d, rel=1e-8, abs=1e-9 * abs(profile.d_goal))


def test_mass_and_force_count_by_their_ratio() -> None:
    profile = Profile(Accelerations(a_f=20.0, a_o=5.0, a=4.0), d_goal=-0.1)
    heavy = simulated_slide(profile, mu=0.3, f_N=60.0, m=3.0)
    assert heavy == pytest.approx(simulated_slide(profile, mu=0.6, f_N=10.0, m=1.0), abs=1e-12)


@pytest.mark.parametrize("wrong", [0.8, 1.0, 1.2])
def test_mujoco_slides_as_far(wrong: float) -> None:
    profile = Profile(Accelerations(a_f=60.0, a_o=20.0, a=10.0), d_goal=-0.02)
    actual = wrong * 20.0
    hand = falling_hand(profile, stopping_time(profile, actual))
    finger = SoftFinger(actual * 0.02 / 1.0, 1.0, 0.02, 0.6)
    rig = planar_rig(Block(0.1, 0.06, 0.02), (PlacedFinger(finger, np.zeros(2)),), ContactSettings(5e-5, 2e-4, 1000.0))
    motion = run_rig(rig, hand, np.zeros(3))
    at_rest = motion.r_f_b[np.searchsorted(motion.time_s, hand.breaks[-1]) - 2]
    assert at_rest[0] == pytest.approx(profile.slide(actual).d, abs=2e-4)
    assert abs(at_rest[1]) < 1e-4
