"""What a recording tells at once: whether the object was held, how many frames there are, how the arm followed."""

from dataclasses import dataclass

import numpy as np

from slidepipe.artifacts import topics
from slidepipe.artifacts.experiment import Experiment
from slidepipe.artifacts.recording_reader import Recording
from slidepipe.artifacts.trial import FrameCounts, Outcome
from slidepipe.series import IntArray, JointSeries, MocapSeries

TRIAL, RECORDING = "trial", "recording"
"""Roles of the files that every trial has."""
IMPORTED = "imported"
"""What a trial from elsewhere calls its lab."""


def outcome_of(mocap: MocapSeries, experiment: Experiment, *, rate_hz: float) -> Outcome:
    """Held, if the object was seen within its own reach of the hand in the last frames."""
    if not len(mocap.frames.frame):
        return "lost"
    last = int(mocap.frames.frame[-1]) - round(0.2 * rate_hz)
    hand = {int(frame): index for index, frame in enumerate(mocap.hand.sequence) if frame > last}
    seen = experiment.lab.cameras
    markers_m = np.linalg.norm(seen.hand_markers.position_m) + np.linalg.norm(seen.object_markers.position_m)
    reach_m = np.hypot(experiment.object.size_x_m, experiment.object.size_y_m) / 2 + markers_m
    near = [
        np.linalg.norm(mocap.object.position_m[index] - mocap.hand.position_m[hand[int(frame)]]) < reach_m
        for index, frame in enumerate(mocap.object.sequence)
        if int(frame) in hand
    ]
    return "held" if near and np.mean(near) > 0.5 else "lost"


def frame_counts(mocap: MocapSeries) -> FrameCounts:
    """How many frames there are, and in how many a body was not tracked."""
    seen = mocap.frames.hand_valid & mocap.frames.object_valid
    times_s = 1e-9 * mocap.frames.received_ns[seen]
    return FrameCounts(
        taken=len(mocap.frames.frame),
        hand_missing=int(np.sum(~mocap.frames.hand_valid)),
        object_missing=int(np.sum(~mocap.frames.object_valid)),
        longest_gap_s=float(np.max(np.diff(times_s), initial=0.0)),
    )


@dataclass(frozen=True, slots=True)
class Followed:
    """What the joints were told and what they did, in the ticks of which both are known."""

    commanded: JointSeries
    measured: JointSeries


def followed(recording: Recording) -> Followed:
    """Read how the arm followed; a recorder that was killed may have written one half of its last tick."""
    commanded, measured = recording.joints(topics.COMMANDED), recording.joints(topics.MEASURED)
    _, told, done = np.intersect1d(commanded.stamp_ns, measured.stamp_ns, return_indices=True)
    return Followed(_rows(commanded, told), _rows(measured, done))


def _rows(series: JointSeries, rows: IntArray) -> JointSeries:
    return JointSeries(
        series.stamp_ns[rows], series.position_rad[rows], series.velocity_rad_s[rows], series.effort_n_m[rows]
    )
