"""A pooled document with numbers that a test can look for."""

from cli.samples import ESTIMATE, GOAL, START, TRIAL, uncertain
from slidepipe.artifacts.estimate import Assumed, Derived, Measured
from slidepipe.artifacts.pooled import PooledDocument, PooledTrial, PooledValue, Repeatability
from slidepipe.artifacts.values import Pose

POOLED = "20261124T093050Z-p00xedx1"
OTHER = "20261124T093016Z-m0x7c4te"


def pooled(*, friction: bool = True) -> PooledDocument:
    value = PooledValue(
        trials=1, value=23.1, std=1.2, interval_95=(20.6, 25.9), within_std=0.1, between_std=0.9,
        between_interval_95=(0.05, 4.1), predictive_std=1.7, predictive_interval_95=(19.5, 27.3), same_value_p=1.0,
    )  # fmt: skip
    return PooledDocument(
        experiment="regrasp",
        trials=(told(friction=friction), lost()),
        kappa_m_s2=value if friction else None,
        mu=Derived(value=0.42504, interval_95=(0.379, 0.4766)) if friction else None,
        assumed=Assumed(normal_force_n=1.25, mass_kg=0.023, rho_m=0.01044),
        between_scale=0.05,
        repeatability=Repeatability(trials=1, mean_error=Pose.of([-0.006, -0.0119, 0.001]), std_error=None),
        notes=("one trial tells little",),
        picture="repeatability.png",
    )


def told(*, friction: bool) -> PooledTrial:
    return PooledTrial(
        trial=TRIAL,
        estimate=ESTIMATE,
        start_relative_pose=START,
        goal_relative_pose=GOAL,
        initial_relative_pose=uncertain(-0.01, -0.02, 3.1416),
        final_relative_pose=uncertain(0.004, 0.0081, 3.1426),
        error=Pose.of([-0.006, -0.0119, 0.001]),
        error_outlying=True,
        kappa_m_s2=Measured(value=23.1, std=0.1, interval_95=(22.9, 23.3)) if friction else None,
        kappa_surprise_p=1.0 if friction else None,
        kappa_outlying=False,
        left_out_because=() if friction else ("the object did not slide",),
    )


def lost() -> PooledTrial:
    return PooledTrial(
        trial=OTHER,
        estimate=None,
        start_relative_pose=START,
        goal_relative_pose=GOAL,
        initial_relative_pose=None,
        final_relative_pose=None,
        error=None,
        error_outlying=False,
        kappa_m_s2=None,
        kappa_surprise_p=None,
        kappa_outlying=False,
        left_out_because=("poses: 3 frames with the bodies in them",),
    )
