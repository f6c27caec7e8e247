"""The search against scipy's, and what it must not depend on."""

import numba
import numpy as np
import pytest
from paper_cases import LIMITS, LINEAR, linear_setup
from scipy.optimize import differential_evolution

from slidepipe.planning import assess_kernel as kernel
from slidepipe.planning.automatic import local_arm
from slidepipe.planning.search import Search, Task
from slidepipe.planning.wish import WEIGHTS, Objective, Wish

TASK = Task(LINEAR.q_o_start, LINEAR.r_start, LINEAR.r_goal, None)


@pytest.fixture(scope="module")
def search() -> Search:
    setup = linear_setup(limits=LIMITS)
    return Search(TASK, setup, Wish(WEIGHTS[Objective.FAST], turn_rad=1.0), local_arm(TASK, setup))


def test_it_ends_no_later_than_a_long_search_of_scipys(search: Search) -> None:
    low, high = search.bounds
    theirs = differential_evolution(
        lambda x: search.assess(x.T)[:, kernel.COST],
        list(zip(low, high + 1e-12, strict=True)),
        vectorized=True,
        updating="deferred",
        polish=False,
        maxiter=150,
        popsize=10,
        rng=3,
    )
    ours = search.rough()
    assert ours.feasible
    assert ours.figures[kernel.COST] <= theirs.fun + 1e-3


def test_it_does_not_depend_on_how_many_cores_there_are(search: Search) -> None:
    many = search.best()
    before = numba.get_num_threads()
    numba.set_num_threads(1)
    try:
        np.testing.assert_array_equal(search.best().choice, many.choice)
    finally:
        numba.set_num_threads(before)


@pytest.mark.parametrize("simulated", [False, True], ids=["formula", "simulated"])
def test_only_what_is_no_better_is_given_up(search: Search, simulated: bool) -> None:
    low, high = search.bounds
    near = search.rough().choice
    random = np.random.default_rng(5)
    choices = np.clip(near + 0.05 * (high - low) * random.normal(size=(60, len(low))), low, high)
    exact = search.assess(choices, simulated=simulated)[:, kernel.COST]
    assert np.any(exact < kernel.SURVIVES_TOO_LITTLE)
    assert np.any(exact > kernel.BREAKS_LIMITS)
    for beat in (np.median(exact), np.min(exact) + 1e-3, 0.5 * kernel.SURVIVES_TOO_LITTLE):
        told = search.assess(choices, simulated=simulated, beat=float(beat))[:, kernel.COST]
        np.testing.assert_array_equal(told[exact < beat], exact[exact < beat])
        assert np.all(told[exact >= beat] >= beat)


def test_a_search_from_where_another_ended_is_no_worse(search: Search) -> None:
    first = search.best()
    again = search.best(near=first.population)
    assert again.feasible
    assert again.figures[kernel.COST] <= first.figures[kernel.COST]
