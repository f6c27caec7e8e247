"""How far a trial ended from where it should."""

from dataclasses import dataclass

import numpy as np

from slidepipe.artifacts.experiment import Experiment
from slidepipe.artifacts.values import Pose, UncertainPose
from slidepipe.stages.translate import vector


@dataclass(frozen=True, slots=True)
class Miss:
    """Distance and angle from the goal's relative pose."""

    position_m: float
    angle_rad: float

    def in_tolerances(self, experiment: Experiment) -> float:
        """The larger of the two in units of what is allowed: at most one where the goal is reached."""
        tolerance = experiment.goal.tolerance
        return max(self.position_m / tolerance.position_m, self.angle_rad / tolerance.angle_rad)


def error_of(reached: UncertainPose | Pose, experiment: Experiment) -> Pose:
    """Error of a relative pose along each coordinate, the angle within half a turn."""
    error = np.array(reached.vector) - vector(experiment.goal.relative_pose)
    error[2] = (error[2] + np.pi) % (2 * np.pi) - np.pi
    return Pose.of(error)


def miss(reached: UncertainPose | Pose, experiment: Experiment) -> Miss:
    """How far a relative pose is from the experiment's goal."""
    error = error_of(reached, experiment)
    return Miss(float(np.hypot(error.x_m, error.y_m)), abs(error.theta_rad))


def within_tolerance(reached: UncertainPose | Pose, experiment: Experiment) -> bool:
    """Whether the goal is reached."""
    return miss(reached, experiment).in_tolerances(experiment) <= 1.0
