"""When a campaign stops: each way has its name, its reason and what to do."""

from pathlib import Path

import pytest

from slidepipe.artifacts.estimate import EstimateDocument
from slidepipe.artifacts.experiment import Experiment, load_experiment
from slidepipe.stages.past import past_trials
from slidepipe.stages.stopping import stop_after


@pytest.fixture
def experiment(experiments: Path) -> Experiment:
    return load_experiment(experiments / "regrasp.yaml", ["iteration.patience=2"])


@pytest.fixture
def ended(regrasp, experiment: Experiment):
    """Estimate of a trial that ended so many mm and mrad from the goal; None for a lost object."""
    result, store, _ = regrasp
    template = past_trials(store, result.document.rows[0].runs.estimate)[0].estimate
    goal = experiment.goal.relative_pose

    def make(off_mm: float | None, off_mrad: float = 0.0) -> EstimateDocument:
        if off_mm is None:
            return template.model_copy(update={"final_relative_pose": None, "lost": "it fell"})
        moved = {"x_m": goal.x_m + 1e-3 * off_mm, "y_m": goal.y_m, "theta_rad": goal.theta_rad + 1e-3 * off_mrad}
        return template.model_copy(
            update={"final_relative_pose": template.final_relative_pose.model_copy(update=moved)}
        )

    return make


@pytest.mark.parametrize(
    ("trials", "outcome"),
    [
        ([(20.0,)], None),
        ([(20.0,), (0.5,)], "converged"),
        ([(20.0,), (0.5, 9.0)], None),
        ([(20.0,), (0.9, 0.0)], None),
        ([(None,)], "lost"),
        ([(2.0,), (3.0,)], None),
        ([(2.0,), (3.0,), (2.5,)], "no progress"),
        ([(5.0,), (3.0,), (4.0,), (2.0,)], None),
        ([(9.0,), (8.0,), (7.0,), (6.0,), (5.0,)], "out of trials"),
        ([(9.0,), (8.0,), (7.0,), (6.0,), (0.1,)], "converged"),
    ],
)
def test_outcomes(ended, experiment: Experiment, trials, outcome: str | None) -> None:
    stop = stop_after([ended(*one) for one in trials], experiment, 5)
    assert (stop.outcome if stop else None) == outcome


def test_tolerances_are_for_each_coordinate(ended, experiment: Experiment) -> None:
    assert stop_after([ended(0.79, 7.9)], experiment, 5).outcome == "converged"
    assert stop_after([ended(0.81, 0.0)], experiment, 5) is None
    assert stop_after([ended(0.0, 8.1)], experiment, 5) is None


def test_a_lost_object_has_to_be_put_back_where_it_was(ended, experiment: Experiment) -> None:
    stop = stop_after([ended(None)], experiment, 5)
    assert stop.because == "it fell"
    assert "x -10.0 mm, y -20.0 mm, theta 3142 mrad" in stop.what_to_do
    assert "--resume" in stop.what_to_do
