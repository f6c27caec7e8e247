"""Estimate: what a recording tells of the slide, the final grip and the friction."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from slidepipe.arm.kinematics import hand_poses
from slidepipe.arm.model import nominal_model
from slidepipe.artifacts import estimate as records
from slidepipe.artifacts.draft import Draft
from slidepipe.artifacts.estimate import EstimateDocument
from slidepipe.artifacts.experiment import Experiment
from slidepipe.artifacts.manifest import InputRef, RunState
from slidepipe.artifacts.plan import PlanDocument
from slidepipe.artifacts.recording_reader import PlanarSeries, Recording, read_recording
from slidepipe.artifacts.recording_series import Series, write_series
from slidepipe.artifacts.recording_writer import PROVENANCE, RecordingWriter
from slidepipe.artifacts.run import Run, outside_input
from slidepipe.artifacts.schema import dump_model, parse
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.strict_yaml import load, loads
from slidepipe.artifacts.topics import MEASURED
from slidepipe.artifacts.values import UncertainPose
from slidepipe.errors import InputError
from slidepipe.estimation.calibration import Calibration, calibrated
from slidepipe.estimation.estimate import Estimate, estimate
from slidepipe.estimation.friction import FrictionEstimate
from slidepipe.estimation.hand_clock import JointClock
from slidepipe.estimation.request import EstimationRequest
from slidepipe.estimation.rest import RestPose
from slidepipe.estimation.smoothing import SmoothedSeries
from slidepipe.lab.loop import MOTION_ENDS, MOTION_STARTS
from slidepipe.series import FloatArray, JointSeries
from slidepipe.stages.calibration_files import CALIBRATION, read_calibration
from slidepipe.stages.sound import around_motion, refuse_unsound
from slidepipe.stages.translate import block, motion_plane, tool, vector
from slidepipe.stages.trial_facts import IMPORTED, RECORDING

STAGE, STAGE_VERSION = "estimate", 2
Z95 = 1.959964
ESTIMATE, SMOOTHED, FIGURE = "estimate", "smoothed", "figure"
"""Roles of an estimate's files."""
SMOOTHED_FILE, FIGURE_FILE = "smoothed.mcap", "estimate.png"
SMOOTHED_HAND, SMOOTHED_OBJECT, SMOOTHED_RELATIVE = "/smoothed/hand", "/smoothed/object", "/smoothed/relative"


@dataclass(frozen=True, slots=True)
class EstimateRequest:
    """Which trial to estimate: a run, or the path of a recording; ``force`` estimates it again, ``figure`` draws it.

    ``calibration`` is the run that says where cameras and markers are; without it, they are where they should be.
    """

    trial: str
    store: Store
    force: bool = False
    figure: bool = False
    calibration: str | None = None
    command: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class EstimateResult:
    """The estimate's run and document; ``reused`` where an equal estimate was there already."""

    run: Run
    document: EstimateDocument
    reused: bool


@dataclass(frozen=True, slots=True)
class RecordedEstimate:
    """What a recording alone tells, and what it says it was recorded for."""

    estimate: Estimate
    experiment: Experiment
    plan: PlanDocument
    start_ns: int


def run(request: EstimateRequest) -> EstimateResult:
    """Estimate a trial from its recording.

    Raises
    ------
    NotFoundError
        There is no such run, or it holds no recording.
    InputError
        The recording is damaged or contradicts itself.
    EstimationError
        It is too short or too empty for anything. A lost object is no error: the document says so.
    """
    source = trial_source(request.trial, request.store)
    calibration = None if request.calibration is None else request.store.get(request.calibration)
    draft = request.store.draft(
        stage=STAGE,
        stage_version=STAGE_VERSION,
        experiment=source.experiment,
        parameters={"figure": True} if request.figure else {},
        inputs=(source.input, *((calibration.input(CALIBRATION),) if calibration else ())),
        command=request.command,
    )
    known = None if request.force else request.store.find_recipe(draft.recipe)
    if known is not None:
        return EstimateResult(known, parse(EstimateDocument, load(known.file(ESTIMATE))), reused=True)
    # Before anything is made: a recording that tells nothing leaves nothing.
    found = estimate_recording(source.path, read_calibration(calibration) if calibration else None)
    document = _document(found, source.trial, calibration.id if calibration else None)
    with draft:
        _write(draft, found, document)
        if request.figure:
            _draw(draft, found, source.trial)
    return EstimateResult(draft.run, document, reused=False)


def estimate_recording(path: Path, calibration: Calibration | None = None) -> RecordedEstimate:
    """Estimate a recording, wherever it lies, from nothing but itself and, if there is one, a calibration."""
    recording = read_recording(path)
    purpose = purpose_of(recording)
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
    )
    return RecordedEstimate(estimate(request), experiment, plan, start_ns)


@dataclass(frozen=True, slots=True)
class TrialSource:
    """A recording: where it lies, which run made it, for which experiment."""

    path: Path
    trial: str
    experiment: str
    input: InputRef


def trial_source(trial: str, store: Store) -> TrialSource:
    """Find the recording of a trial, which is a run or the path of a recording.

    Raises
    ------
    NotFoundError
        There is no such run or file, or the run holds no recording.
    InputError
        The recording is damaged, or none of a trial.
    """
    path = Path(trial)
    if path.suffix == ".mcap":
        provenance = read_recording(path).metadata.get(PROVENANCE, {})
        if not {"run", "experiment"} <= provenance.keys():
            raise InputError(f"{path}: does not say which run recorded it for which experiment: not a recorded trial")
        return TrialSource(path, provenance["run"], provenance["experiment"], outside_input(RECORDING, path))
    run = store.get(trial)
    return TrialSource(run.file(RECORDING), run.id, run.manifest.experiment, run.input(RECORDING))


@dataclass(frozen=True, slots=True)
class Purpose:
    """What a recording says that it was recorded for."""

    experiment: Experiment
    plan: PlanDocument


def purpose_of(recording: Recording) -> Purpose:
    """Read the plan and the experiment that a recording begins with."""
    path = recording.path
    return Purpose(
        parse(Experiment, loads(_text(recording, "experiment.yaml"), f"{path}: experiment.yaml")),
        parse(PlanDocument, loads(_text(recording, "plan.yaml"), f"{path}: plan.yaml")),
    )


def _text(recording: Recording, name: str) -> str:
    try:
        return recording.attachment(name).decode("utf-8")
    except UnicodeDecodeError as error:
        raise InputError(f"{recording.path}: {name}: is not UTF-8 at byte {error.start}") from None


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


def _document(found: RecordedEstimate, trial: str, calibration: str | None) -> EstimateDocument:
    told = found.estimate
    placed = (
        f"cameras and markers are where calibration {calibration} found them; its uncertainty is in no interval here"
    )
    slide = None
    if told.slide is not None:
        start_s, stop_s = (_since_start(found, time_s) for time_s in (told.slide.start_s, told.slide.stop_s))
        slide = records.SlideFound(start_s=start_s, stop_s=stop_s)
    return EstimateDocument(
        trial=trial,
        clock=records.ClockFit(
            offset_s=told.clock.offset_s, rate_ppm=told.clock.drift_ppm, residual_std_s=1e-9 * told.clock.residual_ns
        ),
        joints=_joints(told.joints),
        frames_used=int(np.sum(told.tracks.relative.valid)),
        outliers=told.tracks.spikes,
        smoothing=records.Smoothing(
            hand_nis=_triple(told.hand.consistency),
            object_nis=_triple(told.object.consistency),
            relative_nis=_triple(told.relative.consistency),
        ),
        initial_relative_pose=_uncertain(told.initial),
        final_relative_pose=_uncertain(told.final),
        lost=told.lost,
        slide=slide,
        friction=_friction(found),
        friction_missing_because=told.friction_reason,
        not_told=told.not_told,
        notes=told.notes if calibration is None else (*told.notes, placed),
        series_file=SMOOTHED_FILE,
    )


def _since_start(found: RecordedEstimate, time_s: float) -> float:
    return 1e-9 * (found.estimate.host_ns(time_s) - found.start_ns)


def _uncertain(rest: RestPose | None) -> UncertainPose | None:
    if rest is None:
        return None
    x, y, theta = (float(value) for value in rest.pose)
    x_std, y_std, theta_std = (float(value) for value in rest.sd)
    return UncertainPose(x_m=x, y_m=y, theta_rad=theta, x_std_m=x_std, y_std_m=y_std, theta_std_rad=theta_std)


def _joints(found: JointClock | None) -> records.JointClock | None:
    if found is None:
        return None
    return records.JointClock(
        offset_s=found.offset_s,
        offset_std_s=found.sd_s,
        gravity_angle_rad=found.tilt_rad,
        gravity_angle_std_rad=found.tilt_sd_rad,
    )


def _triple(values: FloatArray) -> tuple[float, float, float]:
    x, y, theta = (float(value) for value in values)
    return x, y, theta


def _friction(found: RecordedEstimate) -> records.FrictionEstimate | None:
    told, experiment = found.estimate.friction, found.experiment
    if told is None:
        return None
    interval = told.kappa_interval_m_s2
    force, mass = records.NORMAL_FORCE_RELATIVE_STD, records.MASS_RELATIVE_STD
    return records.FrictionEstimate(
        kappa_m_s2=_measured(told.kappa_m_s2, told.kappa_relative_sd, (interval.low, interval.high)),
        rho_m=_rho(told),
        mu=records.Derived(value=told.mu, interval_95=(told.mu_interval.low, told.mu_interval.high)),
        assumed=records.Assumed(
            normal_force_n=experiment.grasp.normal_force_n,
            mass_kg=experiment.object.mass_kg,
            rho_m=experiment.grasp.rho_m,
        ),
        mu_budget=records.Budget(
            kappa_relative_std=told.kappa_relative_sd,
            normal_force_relative_std=force,
            mass_relative_std=mass,
            mu_relative_std=float(np.sqrt(told.kappa_relative_sd**2 + force**2 + mass**2)),
        ),
        fit=records.Fit(
            chi_square=told.chi_square,
            outlier_share=told.outlier_share,
            frames=told.frames,
            start_s=_since_start(found, told.window_start_s),
            stop_s=_since_start(found, told.window_stop_s),
            sticking_agrees=told.sticks_alike,
            kappa_change_per_growth_s_m=told.per_growth,
            kappa_change_per_gravity_rad=told.per_gravity,
        ),
    )


def _measured(value: float, relative_std: float, interval: tuple[float, float]) -> records.Measured:
    return records.Measured(value=value, std=value * relative_std, interval_95=interval)


def _rho(told: FrictionEstimate) -> records.Measured | None:
    """Rho where the slide turned enough to tell it."""
    if not told.rho_told:
        return None
    spread = np.exp(Z95 * told.rho_relative_sd)
    return _measured(told.rho_m, told.rho_relative_sd, (float(told.rho_m / spread), float(told.rho_m * spread)))


def _write(draft: Draft, found: RecordedEstimate, document: EstimateDocument) -> None:
    draft.add(ESTIMATE, "estimate.yaml").write_text(dump_model(document), encoding="utf-8")
    told = found.estimate
    topics = {SMOOTHED_HAND: told.hand, SMOOTHED_OBJECT: told.object, SMOOTHED_RELATIVE: told.relative}
    with RecordingWriter(draft.add(SMOOTHED, SMOOTHED_FILE), {"run": draft.run_id, "trial": document.trial}) as writer:
        write_series(writer, Series(planar={topic: _series(told, series) for topic, series in topics.items()}))
    if document.friction is not None:
        kappa = document.friction.kappa_m_s2
        draft.report("kappa", kappa.value, std=kappa.std, unit="m/s^2")
    if document.lost is not None:
        draft.state = RunState.LOST


def _draw(draft: Draft, found: RecordedEstimate, trial: str) -> None:
    # Only those who ask for a picture wait for matplotlib.
    from slidepipe.figures.estimated import draw_estimate  # noqa: PLC0415
    from slidepipe.stages.estimate_picture import estimate_picture  # noqa: PLC0415

    picture = estimate_picture(
        found.estimate,
        f"Estimate of trial {trial}: {found.experiment.name}",
        start_ns=found.start_ns,
        stop_s=found.plan.phases[-1].stop_s,
        believed=found.plan.believed.kappa_m_s2,
    )
    draw_estimate(picture, draft.add(FIGURE, FIGURE_FILE))


def _series(told: Estimate, smoothed: SmoothedSeries) -> PlanarSeries:
    return PlanarSeries(told.tracks.stamp_ns, smoothed.pose, smoothed.velocity, smoothed.pose_sd)
