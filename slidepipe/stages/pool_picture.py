"""The picture of how well trials repeat, from what they told together."""

import numpy as np

from slidepipe.artifacts.experiment import Experiment
from slidepipe.artifacts.pooled import PooledDocument
from slidepipe.artifacts.values import UncertainPose
from slidepipe.figures.repeatability import RepeatabilityPicture
from slidepipe.series import FloatArray


def pool_picture(document: PooledDocument, experiment: Experiment) -> RepeatabilityPicture:
    """Make the picture of the trials that ended in the hand."""
    shown = [trial for trial in document.trials if trial.final_relative_pose is not None]
    missing = np.full(3, np.nan)
    return RepeatabilityPicture(
        start=np.array([trial.start_relative_pose.vector for trial in shown]),
        goal=np.array([trial.goal_relative_pose.vector for trial in shown]),
        initial=np.array([_vector(trial.initial_relative_pose, missing) for trial in shown]),
        final=np.array([_vector(trial.final_relative_pose, missing) for trial in shown]),
        outlying=np.array([trial.error_outlying or trial.kappa_outlying or trial.rho_outlying for trial in shown]),
        position_tolerance_m=experiment.goal.tolerance.position_m,
    )


def _vector(pose: UncertainPose | None, missing: FloatArray) -> FloatArray:
    return missing if pose is None else np.array(pose.vector)
