"""What hypothesis draws in the tests of the mechanics: numbers of the size that a pinch grasp has."""

import numpy as np
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from slidepipe.mechanics.dynamics import Block
from slidepipe.mechanics.limit_surface import SoftFinger

ANGLES = st.floats(-10.0, 10.0)
POSES = st.builds(lambda x, y, t: np.array([x, y, t]), st.floats(-2, 2), st.floats(-2, 2), ANGLES)
OFFSETS = st.builds(lambda x, y, t: np.array([x, y, t]), st.floats(-0.1, 0.1), st.floats(-0.1, 0.1), ANGLES)
SLIDES = arrays(float, 3, elements=st.floats(-5, 5)).filter(lambda dv: np.linalg.norm(dv) > 1e-3)
FINGERS = st.builds(
    SoftFinger, mu=st.floats(0.05, 2.0), f_N=st.floats(0.1, 50.0), a=st.floats(0.001, 0.1), c=st.floats(0.3, 0.7)
)
BLOCKS = st.builds(Block, length=st.floats(0.01, 0.5), width=st.floats(0.01, 0.5), m=st.floats(0.005, 2.0))
