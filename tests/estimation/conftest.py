import pytest
from synthetic import CASE_A, CASE_B, Cameras, request, simulate

from slidepipe.estimation.estimate import estimate


@pytest.fixture(scope="session")
def trial_a():
    world = simulate(CASE_A, 0.38, 1)
    asked = request(world, Cameras(seed=1))
    return world, asked, estimate(asked)


@pytest.fixture(scope="session")
def trial_b():
    world = simulate(CASE_B, 0.38, 2)
    asked = request(world, Cameras(seed=2))
    return world, asked, estimate(asked)
