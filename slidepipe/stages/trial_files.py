"""A trial as files: what was recorded and, from a simulated lab, what was true."""

from dataclasses import dataclass

import numpy as np

from slidepipe.arm.kinematics import hand_error
from slidepipe.arm.model import nominal_model
from slidepipe.artifacts import topics
from slidepipe.artifacts.draft import Draft
from slidepipe.artifacts.experiment import Experiment
from slidepipe.artifacts.manifest import RunState
from slidepipe.artifacts.recording_reader import Recording
from slidepipe.artifacts.recording_series import Series, write_series
from slidepipe.artifacts.recording_writer import RecordingWriter
from slidepipe.artifacts.schema import dump_model
from slidepipe.artifacts.trial import FrameCounts, Outcome, StreamReport, TrackingError, TrialDocument, TruthDocument
from slidepipe.artifacts.values import Pose
from slidepipe.lab.loop import Execution
from slidepipe.lab.safety import StopCause
from slidepipe.lab.simulated import Truth
from slidepipe.series import MocapSeries
from slidepipe.stages.translate import setup

TRIAL, RECORDING, TRUTH, TRUE_POSES = "trial", "recording", "truth", "true-poses"
"""Roles of a trial's files."""
RECORDING_FILE = "trial.mcap"
SIMULATED = "simulated"
"""What a trial calls the simulated lab in virtual time."""
TRUE_HAND, TRUE_OBJECT = "/truth/hand", "/truth/object"
SLIDES_ABOVE_M_S = 0.005
"""MuJoCo's soft contact creeps below this speed while it sticks."""
LAST_S = 0.2
"""Of the frames: in these the object is there, or it is lost."""


@dataclass(frozen=True, slots=True)
class Executed:
    """What the loop did, by which plan, in which lab; ``stream`` and ``invalid`` where that was in real time."""

    execution: Execution
    plan: str
    lab: str
    seed: int | None
    stream: StreamReport | None = None
    invalid: str | None = None


def trial_document(recording: Recording, executed: Executed, experiment: Experiment) -> TrialDocument:
    """Say what happened, from the recording."""
    mocap, execution = recording.mocap(), executed.execution
    return TrialDocument(
        plan=executed.plan,
        lab=executed.lab,
        seed=executed.seed,
        outcome=_outcome(mocap, experiment),
        started_ns=execution.start_ns,
        finished_ns=execution.stop_ns,
        frames=_frames(mocap),
        tracking_error=_tracking(recording, execution, experiment),
        recording_file=RECORDING_FILE,
        stopped=None if execution.stop is None else str(execution.stop),
        invalid=executed.invalid,
        stream=executed.stream,
    )


def truth_document(truth: Truth, trial: TrialDocument, experiment: Experiment) -> TruthDocument:
    """Say what was true in a simulated world."""
    time_s = 1e-9 * (truth.hand.stamp_ns - trial.started_ns)
    rate = np.diff(truth.r_f_b, axis=0) / np.diff(time_s)[:, None]
    speed = np.hypot(np.hypot(rate[:, 0], rate[:, 1]), rate[:, 2] * experiment.grasp.rho_m)
    sliding = np.flatnonzero(speed > SLIDES_ABOVE_M_S)
    return TruthDocument(
        friction=experiment.lab.friction,
        normal_force_per_finger_n=experiment.lab.normal_force_per_finger_n,
        kappa_m_s2=experiment.true_kappa_m_s2,
        rho_m=experiment.grasp.rho_m,
        initial_relative_pose=Pose.of(truth.r_f_b[0]),
        final_relative_pose=Pose.of(truth.r_f_b[-1]),
        slide_start_s=float(time_s[sliding[0]]) if len(sliding) else None,
        slide_stop_s=float(time_s[sliding[-1] + 1]) if len(sliding) else None,
        outcome=trial.outcome,
    )


def write_trial(draft: Draft, document: TrialDocument, cause: StopCause | None = None) -> None:
    """Write the document; the run's state says how it ended."""
    draft.add(TRIAL, "trial.yaml").write_text(dump_model(document), encoding="utf-8")
    if document.tracking_error is not None:
        draft.report("tracking_error_rms", document.tracking_error.position_rms_m, unit="m")
    if document.outcome == "lost" or cause is StopCause.OBJECT:
        draft.state = RunState.LOST
    elif cause is StopCause.OPERATOR:
        draft.state = RunState.INTERRUPTED
    elif cause is not None:
        draft.state = RunState.STOPPED


def write_truth(draft: Draft, document: TruthDocument, poses: Truth) -> None:
    """Write what was true beside the trial, where no estimate looks."""
    draft.add(TRUTH, "truth.yaml").write_text(dump_model(document), encoding="utf-8")
    with RecordingWriter(draft.add(TRUE_POSES, "truth.mcap"), {"run": draft.run_id}) as writer:
        write_series(writer, Series(poses={TRUE_HAND: poses.hand, TRUE_OBJECT: poses.object}))


def _outcome(mocap: MocapSeries, experiment: Experiment) -> Outcome:
    """Held, if the object was seen within its own reach of the hand in the last frames."""
    if not len(mocap.frames.frame):
        return "lost"
    last = int(mocap.frames.frame[-1]) - round(LAST_S * experiment.lab.cameras.rate_hz)
    hand = {int(frame): index for index, frame in enumerate(mocap.hand.sequence) if frame > last}
    reach_m = np.hypot(experiment.object.size_x_m, experiment.object.size_y_m) / 2
    near = [
        np.linalg.norm(mocap.object.position_m[index] - mocap.hand.position_m[hand[int(frame)]]) < reach_m
        for index, frame in enumerate(mocap.object.sequence)
        if int(frame) in hand
    ]
    return "held" if near and np.mean(near) > 0.5 else "lost"


def _frames(mocap: MocapSeries) -> FrameCounts:
    seen = mocap.frames.hand_valid & mocap.frames.object_valid
    times_s = 1e-9 * mocap.frames.received_ns[seen]
    return FrameCounts(
        taken=len(mocap.frames.frame),
        hand_missing=int(np.sum(~mocap.frames.hand_valid)),
        object_missing=int(np.sum(~mocap.frames.object_valid)),
        longest_gap_s=float(np.max(np.diff(times_s), initial=0.0)),
    )


def _tracking(recording: Recording, execution: Execution, experiment: Experiment) -> TrackingError | None:
    commanded, measured = recording.joints(topics.COMMANDED), recording.joints(topics.MEASURED)
    moving = (commanded.stamp_ns >= execution.start_ns) & (commanded.stamp_ns <= execution.stop_ns)
    if not execution.start_ns or not moving.any():
        return None
    model = nominal_model(setup(experiment, experiment.friction).tool)
    error = hand_error(model, commanded.position_rad[moving], measured.position_rad[moving])
    return TrackingError(
        position_rms_m=float(np.sqrt(np.mean(error.position_m**2))),
        position_peak_m=float(np.max(error.position_m)),
        angle_rms_rad=float(np.sqrt(np.mean(error.angle_rad**2))),
        angle_peak_rad=float(np.max(error.angle_rad)),
    )
