"""The two pictures of a campaign, in the manner of the paper's Figs. 10 and 11: its first and its last trial."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from slidepipe.artifacts.experiment import Experiment
from slidepipe.artifacts.plan import PlanDocument
from slidepipe.artifacts.recording_reader import read_recording
from slidepipe.artifacts.run import Run
from slidepipe.artifacts.schema import parse
from slidepipe.artifacts.strict_yaml import load
from slidepipe.artifacts.trial import TrialDocument
from slidepipe.figures.sliding import SlidingPanel, draw_sliding
from slidepipe.figures.tracking import TrackingPanel, draw_tracking
from slidepipe.mechanics.planar import MotionPlane, relative_pose
from slidepipe.series import BoolArray, FloatArray, IntArray, PoseSeries
from slidepipe.stages.estimate import SMOOTHED, SMOOTHED_HAND, SMOOTHED_RELATIVE
from slidepipe.stages.plan_files import PLAN, REFERENCE, REFERENCE_HAND, REFERENCE_OBJECT
from slidepipe.stages.translate import motion_plane, vector
from slidepipe.stages.trial_facts import RECORDING, TRIAL
from slidepipe.stages.trial_files import SIMULATED, TRUE_HAND, TRUE_OBJECT, TRUE_POSES

MARGIN_S = 0.1
"""How much of the rests before and after a motion is shown."""


@dataclass(frozen=True, slots=True)
class TrialRuns:
    """The three runs of one trial."""

    plan: Run
    execute: Run
    estimate: Run


def draw_pictures(trials: Sequence[TrialRuns], experiment: Experiment, tracking: Path, sliding: Path) -> None:
    """Draw how the arm followed (Fig. 10) and how the object slid (Fig. 11), one column for each trial."""
    views = [TrialView(runs, experiment) for runs in trials]
    draw_tracking([view.tracking() for view in views], tracking)
    draw_sliding([view.sliding() for view in views], sliding)


class TrialView:
    """What is to be drawn of one trial, on the time that starts with its motion."""

    def __init__(self, runs: TrialRuns, experiment: Experiment) -> None:
        self._runs, self._experiment = runs, experiment
        self._plane = motion_plane(experiment)
        self._plan = parse(PlanDocument, load(runs.plan.file(PLAN)))
        self._trial = parse(TrialDocument, load(runs.execute.file(TRIAL)))
        reference = read_recording(runs.plan.file(REFERENCE))
        self._time_s = _seconds(reference.poses(REFERENCE_HAND).stamp_ns)
        self._hand = in_plane(reference.poses(REFERENCE_HAND), self._plane)
        self._object = in_plane(reference.poses(REFERENCE_OBJECT), self._plane)

    @property
    def _title(self) -> str:
        return f"trial {self._plan.trial}"

    @property
    def _slide_s(self) -> tuple[float, float]:
        return self._plan.slide.start_s, self._plan.slide.stop_s

    def tracking(self) -> TrackingPanel:
        """How the hand followed its reference."""
        smoothed = read_recording(self._runs.estimate.file(SMOOTHED)).planar(SMOOTHED_HAND)
        time_s, shown = self._shown(smoothed.stamp_ns)
        return TrackingPanel(
            title=self._title,
            time_s=self._time_s,
            reference=self._hand,
            measured_time_s=time_s[shown],
            measured=smoothed.pose[shown],
            slide_s=self._slide_s,
        )

    def sliding(self) -> SlidingPanel:
        """How the finger slid on the object."""
        smoothed = read_recording(self._runs.estimate.file(SMOOTHED)).planar(SMOOTHED_RELATIVE)
        time_s, shown = self._shown(smoothed.stamp_ns)
        raw_ns, raw = self._raw()
        raw_time_s, raw_shown = self._shown(raw_ns)
        tolerance = self._experiment.goal.tolerance
        panel = SlidingPanel(
            title=self._title,
            time_s=self._time_s,
            planned=self._planned(),
            raw_time_s=raw_time_s[raw_shown],
            raw=raw[raw_shown],
            smoothed_time_s=time_s[shown],
            smoothed=smoothed.pose[shown],
            slide_s=self._slide_s,
            goal=vector(self._experiment.goal.relative_pose),
            truth=None,
            position_tolerance_m=tolerance.position_m,
            angle_tolerance_rad=tolerance.angle_rad,
        )
        return panel if self._trial.lab != SIMULATED else self._with_truth(panel)

    def _with_truth(self, panel: SlidingPanel) -> SlidingPanel:
        stamp_ns, truth = self._truth()
        time_s, shown = self._shown(stamp_ns)
        return replace(panel, truth=truth[shown], truth_time_s=time_s[shown])

    def _planned(self) -> FloatArray:
        """Planned relative pose, its angle counted so that it ends at the goal's."""
        planned = relative_pose(self._object, self._hand)
        planned[:, 2] = np.unwrap(planned[:, 2])
        turns = np.round((self._experiment.goal.relative_pose.theta_rad - planned[-1, 2]) / (2 * np.pi))
        return np.asarray(planned + np.array([0.0, 0.0, 2 * np.pi * turns]))

    def _raw(self) -> tuple[IntArray, FloatArray]:
        """Relative poses of the frames in which both bodies were seen."""
        mocap = read_recording(self._runs.execute.file(RECORDING)).mocap()
        _, hand, body = np.intersect1d(mocap.hand.sequence, mocap.object.sequence, return_indices=True)
        q_f, q_o = in_plane(mocap.hand, self._plane)[hand], in_plane(mocap.object, self._plane)[body]
        return mocap.hand.stamp_ns[hand], relative_pose(q_o, q_f)

    def _truth(self) -> tuple[IntArray, FloatArray]:
        poses = read_recording(self._runs.execute.file(TRUE_POSES))
        hand, body = poses.poses(TRUE_HAND), poses.poses(TRUE_OBJECT)
        return hand.stamp_ns, relative_pose(in_plane(body, self._plane), in_plane(hand, self._plane))

    def _shown(self, stamp_ns: IntArray) -> tuple[FloatArray, BoolArray]:
        """Time since the motion began, and which of it is shown."""
        time_s = _seconds(stamp_ns - self._trial.started_ns)
        return time_s, np.asarray((time_s > -MARGIN_S) & (time_s < self._time_s[-1] + MARGIN_S))


def _seconds(stamp_ns: IntArray) -> FloatArray:
    return np.asarray(stamp_ns * 1e-9, dtype=np.float64)


def in_plane(poses: PoseSeries, plane: MotionPlane) -> FloatArray:
    """Planar poses (T, 3) of a body that is recorded in the base frame."""
    projected: FloatArray = plane.project(poses.position_m, Rotation.from_quat(poses.quaternion_xyzw).as_matrix())
    return projected
