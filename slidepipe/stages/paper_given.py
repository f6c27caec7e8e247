"""What the paper gives of its objects, grasps and laboratory, beside what our runs had."""

from collections.abc import Sequence

import numpy as np

from slidepipe.arm import wam
from slidepipe.artifacts.experiment import Experiment
from slidepipe.artifacts.values import Pose
from slidepipe.stages.paper_claim import Claim, less
from slidepipe.stages.paper_repeats import repeat_error
from slidepipe.stages.paper_runs import PaperRuns

FILE = "as the experiment file says"
LINEAR_M = (-0.01, -0.02, np.pi), (0.01, 0.02, np.pi), 0.0174
ROTATIONAL_M = (-0.01, 0.04, 0.75 * np.pi), (0.01, 0.04, np.pi), 0.05
"""Sections VIII-A and VIII-B: start and goal of the finger in {b} (m, m, rad), and the radius of the patch, m."""


def given(runs: PaperRuns) -> tuple[Claim, ...]:
    """The object and the two grasps of Section VIII."""
    linear, rotational = runs.linear.experiment, runs.rotational.experiment
    thing = linear.object
    return (
        _number("VIII", "object, length", 0.1, thing.size_y_m, unit="m"),
        _number("VIII", "object, width", 0.06, thing.size_x_m, unit="m"),
        _number("VIII", "object, mass", 0.023, thing.mass_kg, unit="kg"),
        _number("VIII", "friction coefficient", 0.38, linear.friction),
        *_grasp("VIII-A", linear, LINEAR_M),
        *_grasp("VIII-B", rotational, ROTATIONAL_M),
    )


def followed(runs: PaperRuns) -> tuple[Claim, ...]:
    """The arm and the gripper of Section IX, how well the arm followed, and how often it was tried."""
    error, told = runs.nominal.trial.tracking_error, repeat_error(runs)
    tracked = "not known" if error is None else f"{1e3 * error.position_rms_m:.2f} mm rms"
    cause = "the paper draws it (Fig. 10) and names it as a cause of its misses; by the encoders, Section VIII-A's plan"
    return (
        _number("IX", "joints of the arm", 7, wam.JOINT_COUNT, reason="the vendor's table of the WAM"),
        _number(
            "IX",
            "gripper with the object",
            0.105,
            wam.GRIPPER_MASS_KG,
            unit="kg",
            reason="the simulated gripper's mass",
        ),
        Claim("IX", "tracking error of the hand", "no number", tracked, "-", cause),
        Claim(
            "IX", "trials of one plan", "multiple", f"{len(runs.repeats)}", "-", "the dots of Fig. 12 are not counted"
        ),
        Claim(
            "IX",
            "trials that lost the object",
            "none told",
            f"{told.lost}",
            "-",
            "the errors are over those that held it",
        ),
    )


def _grasp(where: str, experiment: Experiment, printed: tuple[Sequence[float], Sequence[float], float]) -> list[Claim]:
    start, goal, radius_m = printed
    return [
        _pose(where, "start of the finger in {b}", start, experiment.start.relative_pose),
        _pose(where, "goal of the finger in {b}", goal, experiment.goal.relative_pose),
        _number(where, "radius of the contact patch", radius_m, experiment.grasp.contact_radius_m, unit="m"),
    ]


def _pose(where: str, what: str, paper: Sequence[float], ours: Pose) -> Claim:
    away = float(np.max(np.abs(np.subtract(ours.vector, paper))))
    return Claim(where, what, _told(paper), _told(ours.vector), less(away), FILE)


def _told(pose: Sequence[float]) -> str:
    x, y, theta = pose
    return f"{x:g} m, {y:g} m, {theta / np.pi:g} π"


def _number(where: str, what: str, paper: float, ours: float, *, unit: str = "", reason: str = FILE) -> Claim:
    return Claim(
        where, what, f"{paper:g} {unit}".rstrip(), f"{ours:g} {unit}".rstrip(), less(ours - paper, unit), reason
    )
