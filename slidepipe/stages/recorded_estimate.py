"""What a recording alone tells, wherever it lies."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from slidepipe.arm.kinematics import hand_poses
from slidepipe.arm.model import nominal_model
from slidepipe.artifacts.experiment import Experiment
from slidepipe.artifacts.plan import PlanDocument
from slidepipe.artifacts.recording_reader import Recording, read_recording
from slidepipe.artifacts.recording_writer import PROVENANCE
from slidepipe.artifacts.topics import MEASURED
from slidepipe.errors import InputError
from slidepipe.estimation.calibration import Calibration, calibrated
from slidepipe.estimation.estimate import Estimate, estimate
from slidepipe.estimation.laws import Laws
from slidepipe.estimation.request import EstimationRequest
from slidepipe.lab.loop import MOTION_ENDS, MOTION_STARTS
from slidepipe.series import FloatArray, JointSeries
from slidepipe.stages.sound import around_motion, refuse_unsound
from slidepipe.stages.translate import block, motion_plane, tool, vector
from slidepipe.stages.trial_facts import IMPORTED
from slidepipe.stages.trial_source import purpose_of


@dataclass(frozen=True, slots=True)
class RecordedEstimate:
    """What a recording alone tells, and what it says it was recorded for."""

    estimate: Estimate
    experiment: Experiment
    plan: PlanDocument
    start_ns: int


def estimate_recording(
    path: Path, calibration: Calibration | None = None, overrides: tuple[str, ...] = ()
) -> RecordedEstimate:
    """Estimate a recording, wherever it lies, from nothing but itself and, if there is one, a calibration."""
    recording = read_recording(path)
    purpose = purpose_of(recording, overrides)
    experiment, plan = purpose.experiment, purpose.plan
    refuse_unsound(recording)
    start_ns, stop_ns = (_stamp(recording, message) for message in (MOTION_STARTS, MOTION_ENDS))
    mocap = around_motion(recording.mocap(), start_ns, stop_ns)
    if calibration is not None:
        mocap = calibrated(mocap, calibration)
    joints = _joints_of(recording)
    request = EstimationRequest(
        mocap=mocap,
        plane=motion_plane(experiment),
        block=block(experiment),
        normal_force_n=experiment.grasp.normal_force_n,
        rho_m=experiment.grasp.rho_m,
        believed_kappa=plan.believed.kappa_m_s2,
        relative_angle_rad=plan.start_relative_pose.theta_rad,
        slide_start_ns=start_ns + round(1e9 * plan.slide.start_s),
        slide_stop_ns=start_ns + round(1e9 * plan.slide.stop_s),
        motion_start_ns=start_ns,
        motion_stop_ns=stop_ns,
        joint_hand=None if joints is None else hand_poses(nominal_model(tool(experiment)), joints),
        start_relative_pose=vector(plan.start_relative_pose),
        hand_place_sd=None if calibration is None else _place_sd(calibration),
        laws=_laws(experiment),
    )
    return RecordedEstimate(estimate(request), experiment, plan, start_ns)


def _joints_of(recording: Recording) -> JointSeries | None:
    """What the arm measured; None in an imported trial, of which the cameras' side alone is known."""
    if recording.metadata.get(PROVENANCE, {}).get("lab") == IMPORTED:
        return None
    joints = recording.joints(MEASURED)
    bad = np.flatnonzero(~np.isfinite(joints.position_rad).all(axis=1))
    if len(bad):
        raise InputError(f"{recording.path}: {MEASURED}: an angle of state {bad[0]} is not finite")
    return joints


def _stamp(recording: Recording, message: str) -> int:
    for event in recording.events():
        if event.message == message:
            return event.stamp_ns
    raise InputError(f"{recording.path}: does not say when the {message}: the trial was not run to its end")


def _place_sd(calibration: Calibration) -> FloatArray:
    """How well it is known where {f} is on the hand: along its x and y, and about the motion plane's normal, its z."""
    markers = calibration.hand_markers
    return np.array([*markers.position_std_m[:2], markers.rotation_std_rad[2]])


def _laws(experiment: Experiment) -> Laws:
    asked = experiment.estimation
    return Laws(growth_sd_s_m=asked.growth_std_s_m, sticking=asked.sticking, surface=asked.surface)
