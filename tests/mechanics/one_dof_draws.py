"""What hypothesis draws in the tests of Section III."""

from hypothesis import strategies as st

from slidepipe.mechanics.one_dof import Accelerations, Profile

ACCELERATIONS = st.builds(
    lambda a_o, above, below: Accelerations(a_f=a_o * above, a_o=a_o, a=a_o * below),
    st.floats(0.5, 50.0),
    st.floats(1.02, 20.0),
    st.floats(0.02, 0.98),
)
GOALS = st.builds(lambda size, sign: sign * size, st.floats(1e-4, 1.0), st.sampled_from([-1.0, 1.0]))
PROFILES = st.builds(Profile, ACCELERATIONS, GOALS)
EXAMPLE = Accelerations(a_f=20.0, a_o=5.0, a=4.0)
