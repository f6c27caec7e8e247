"""What hypothesis draws in the tests of grasps: one to five contacts, soft fingers and point contacts mixed."""

import numpy as np
from hypothesis import strategies as st
from mechanics_draws import OFFSETS

from slidepipe.mechanics.grasp import Contact, Grasp
from slidepipe.mechanics.limit_surface import PointContact, SoftFinger

SOFT = st.builds(
    SoftFinger, mu=st.floats(0.1, 1.0), f_N=st.floats(0.5, 20.0), a=st.floats(0.002, 0.05), c=st.floats(0.4, 0.7)
)
POINT = st.builds(PointContact, mu=st.floats(0.1, 1.0), f_N=st.floats(0.5, 20.0))
SOFT_GRASPS = st.builds(Grasp, st.lists(st.builds(Contact, SOFT, OFFSETS), min_size=1, max_size=5))
MIXED_GRASPS = st.builds(
    lambda first, rest: Grasp([first, *rest]),
    st.builds(Contact, SOFT, OFFSETS),
    st.lists(st.builds(Contact, SOFT | POINT, OFFSETS), max_size=4),
)
WRENCHES = st.builds(
    lambda x, y, t: np.array([x, y, t]), st.floats(-5, 5), st.floats(-5, 5), st.floats(-0.3, 0.3)
).filter(lambda w: np.linalg.norm(w) > 1e-3)
ACCELERATIONS = st.builds(
    lambda x, y, t: np.array([x, y, t]), st.floats(-50, 50), st.floats(-50, 50), st.floats(-500, 500)
)


def copies(finger: SoftFinger, r_f_b: np.ndarray, n: int) -> Grasp:
    """n coincident fingers that share one finger's normal force."""
    share = SoftFinger(finger.mu, finger.f_N / n, finger.a, finger.c)
    return Grasp([Contact(share, r_f_b)] * n)


def turned(grasp: Grasp, matrix: np.ndarray) -> Grasp:
    """The grasp with all its places turned."""
    return Grasp([Contact(contact.finger, matrix @ contact.r_f_b) for contact in grasp.contacts])
