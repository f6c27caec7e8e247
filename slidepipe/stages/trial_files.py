"""A trial as files: what was recorded and, from a simulated lab, what was true."""

from dataclasses import dataclass

import numpy as np

from slidepipe.arm.kinematics import hand_error
from slidepipe.arm.model import nominal_model
from slidepipe.artifacts.draft import Draft
from slidepipe.artifacts.experiment import Experiment
from slidepipe.artifacts.manifest import RunState
from slidepipe.artifacts.recording_reader import Recording
from slidepipe.artifacts.recording_series import Series, write_series
from slidepipe.artifacts.recording_writer import RecordingWriter
from slidepipe.artifacts.schema import dump_model
from slidepipe.artifacts.trial import StreamReport, TrackingError, TrialDocument, TruthDocument
from slidepipe.artifacts.values import Pose
from slidepipe.lab.loop import Execution
from slidepipe.lab.safety import StopCause
from slidepipe.lab.simulated import Truth
from slidepipe.stages.translate import setup
from slidepipe.stages.trial_facts import TRIAL, followed, frame_counts, outcome_of

TRUTH, TRUE_POSES = "truth", "true-poses"
"""Roles of the files that a simulated trial has beside those that every one has."""
RECORDING_FILE = "trial.mcap"
SIMULATED = "simulated"
"""What a trial calls the simulated lab in virtual time."""
TRUE_HAND, TRUE_OBJECT = "/truth/hand", "/truth/object"
SLIDES_ABOVE_M_S = 0.005
"""MuJoCo's soft contact creeps below this speed while it sticks."""


@dataclass(frozen=True, slots=True)
class Executed:
    """What the loop did, by which plan, in which lab; ``stream`` and ``invalid`` where that was in real time.

    ``rate_hz`` is that of the cameras.
    """

    execution: Execution
    plan: str
    lab: str
    seed: int | None
    rate_hz: float
    stream: StreamReport | None = None
    invalid: str | None = None


def trial_document(recording: Recording, executed: Executed, experiment: Experiment) -> TrialDocument:
    """Say what happened, from the recording."""
    mocap, execution = recording.mocap(), executed.execution
    return TrialDocument(
        plan=executed.plan,
        lab=executed.lab,
        seed=executed.seed,
        outcome=outcome_of(mocap, experiment, rate_hz=executed.rate_hz),
        started_ns=execution.start_ns or execution.stop_ns,
        finished_ns=execution.stop_ns,
        frames=frame_counts(mocap),
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


def _tracking(recording: Recording, execution: Execution, experiment: Experiment) -> TrackingError | None:
    arm = followed(recording)
    commanded, measured = arm.commanded, arm.measured
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
