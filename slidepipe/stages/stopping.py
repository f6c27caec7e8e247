"""When a campaign stops, and what a person is told then."""

from collections.abc import Sequence
from dataclasses import dataclass

from slidepipe.artifacts.campaign import CampaignOutcome
from slidepipe.artifacts.estimate import EstimateDocument
from slidepipe.artifacts.experiment import Experiment
from slidepipe.stages.goal import miss, within_tolerance


@dataclass(frozen=True, slots=True)
class Stop:
    """How a campaign ended, why, and what to do next; the latter two are None where there is nothing to say."""

    outcome: CampaignOutcome
    because: str | None = None
    what_to_do: str | None = None


def stop_after(estimates: Sequence[EstimateDocument], experiment: Experiment, max_trials: int) -> Stop | None:
    """Decide after the last of some trials whether to stop; None to go on."""
    last = estimates[-1]
    if last.final_relative_pose is None:
        start = experiment.start.relative_pose
        return Stop(
            "lost",
            last.lost,
            f"put the object back into the grip with the finger at x {1e3 * start.x_m:.1f} mm, "
            f"y {1e3 * start.y_m:.1f} mm, theta {1e3 * start.theta_rad:.0f} mrad in the body frame, then run it again "
            "with --resume: what was learned of the friction is kept",
        )
    if within_tolerance(last.final_relative_pose, experiment):
        return Stop("converged")
    if len(estimates) >= max_trials:
        return Stop("out of trials", what_to_do=f"go on with --resume --trials {max_trials + 3}")
    if _idle(estimates, experiment) >= experiment.iteration.patience:
        return Stop(
            "no progress",
            f"the last {experiment.iteration.patience} trials came no nearer than the best before them",
            "look at the pictures: what is left may be the arm's tracking or the cameras' noise; "
            "iteration.way: learned corrects the arm, a wider goal.tolerance accepts what there is",
        )
    return None


def _idle(estimates: Sequence[EstimateDocument], experiment: Experiment) -> int:
    """How many trials ago the nearest to the goal was; a trial that lost the object came from the start again."""
    best, idle = float("inf"), 0
    for one in estimates:
        if one.final_relative_pose is None:
            continue
        left = miss(one.final_relative_pose, experiment).in_tolerances(experiment)
        best, idle = (left, 0) if left < best else (best, idle + 1)
    return idle


def no_plan(because: str) -> Stop:
    """Stop where no motion within the limits corrects what is left."""
    return Stop(
        "no plan",
        because,
        "put the finger back to start.relative_pose and run it anew, or widen the limit that is named",
    )
