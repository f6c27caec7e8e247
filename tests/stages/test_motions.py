"""Later plans of a campaign whose motion the planner finds."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from slidepipe.artifacts.experiment import Experiment, load_experiment
from slidepipe.errors import InfeasibleError
from slidepipe.planning.automatic import local_arm, plan_automatically
from slidepipe.planning.planner import Plan
from slidepipe.planning.replan import FrictionInterval
from slidepipe.planning.search import Search
from slidepipe.stages.belief import FrictionBelief
from slidepipe.stages.explain import explain
from slidepipe.stages.motions import next_plan, task, wish
from slidepipe.stages.past import past_trials
from slidepipe.stages.translate import setup, vector

BELIEF = FrictionBelief(0.38, 0.01, (0.36, 0.40), "1 trial")


@pytest.fixture(scope="module")
def cramped(experiments: Path) -> Experiment:
    """No motion carries the block all the way: the hand may not leave so small a workspace."""
    return load_experiment(experiments / "robust.yaml", ["workspace.radius_m=0.03"])


@pytest.fixture(scope="module")
def part_way(cramped: Experiment) -> Plan:
    return next_plan(cramped, vector(cramped.start.relative_pose), BELIEF.friction, FrictionInterval(*BELIEF.interval))


def test_where_no_motion_goes_all_the_way_one_goes_part_of_it(cramped: Experiment, part_way: Plan) -> None:
    start, goal = vector(cramped.start.relative_pose), vector(cramped.goal.relative_pose)
    with pytest.raises(InfeasibleError, match="nearest goal on the way"):
        plan_automatically(task(cramped), setup(cramped, BELIEF.friction), wish(cramped))
    went = (part_way.course.r_goal - start)[:2] / (goal - start)[:2]
    assert went[0] == pytest.approx(went[1])
    assert 0.3 < went[0] < 0.8
    assert np.max(np.linalg.norm(part_way.motion.q_f[:, :2], axis=1)) <= 0.03


def test_part_of_the_way_is_said(cramped: Experiment, part_way: Plan, regrasp) -> None:
    result, store, _ = regrasp
    past = past_trials(store, result.document.rows[0].runs.estimate)
    told = explain(part_way, BELIEF, past, cramped, way="posterior", correction=None)
    left = 1e3 * np.linalg.norm((part_way.course.r_goal - vector(cramped.goal.relative_pose))[:2])
    assert any("part of the way" in line and f"{left:.2f} mm" in line for line in told.changed)


@pytest.mark.parametrize(
    ("r_now", "friction"),
    [((0.01408598, 0.01738661, 3.00275382), 0.3648563), ((0.00658741, 0.02109519, 3.23947459), 0.3711567)],
    ids=["turned back", "turned on"],
)
def test_a_short_slide_across_the_lever_is_found(experiments: Path, r_now: tuple[float, ...], friction: float) -> None:
    """It takes a hand that is turned far from the start, where the arm is another, and a search that begins anew."""
    experiment = load_experiment(experiments / "robust.yaml")
    chosen = next_plan(experiment, np.array(r_now), friction, FrictionInterval(0.92 * friction, 1.08 * friction))
    np.testing.assert_allclose(chosen.course.r_goal, vector(experiment.goal.relative_pose))
    assert chosen.survival.friction_error > 0.08


def test_a_search_that_found_nothing_begins_elsewhere(experiments: Path) -> None:
    experiment = load_experiment(experiments / "robust.yaml")
    from_here = replace(task(experiment), r_start=np.array([0.01408598, 0.01738661, 3.00275382]))
    believed = setup(experiment, 0.3648563)
    eased = replace(wish(experiment), friction_error=0.0, angle_free=True)
    search = Search(from_here, believed, eased, local_arm(from_here, believed))
    assert not search.best(starts=1).feasible
    assert search.best().feasible
