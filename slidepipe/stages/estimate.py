"""Estimate: what a recording tells of the slide, the final grip and the friction."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

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
from slidepipe.artifacts.values import UncertainPose
from slidepipe.errors import InputError
from slidepipe.estimation.estimate import Estimate, estimate
from slidepipe.estimation.request import EstimationRequest
from slidepipe.estimation.rest import RestPose
from slidepipe.estimation.smoothing import SmoothedSeries
from slidepipe.lab.loop import MOTION_ENDS, MOTION_STARTS
from slidepipe.stages.sound import around_motion, refuse_unsound
from slidepipe.stages.translate import block, motion_plane
from slidepipe.stages.trial_facts import RECORDING

STAGE, STAGE_VERSION = "estimate", 1
ESTIMATE, SMOOTHED = "estimate", "smoothed"
"""Roles of an estimate's files."""
SMOOTHED_FILE = "smoothed.mcap"
SMOOTHED_HAND, SMOOTHED_OBJECT, SMOOTHED_RELATIVE = "/smoothed/hand", "/smoothed/object", "/smoothed/relative"


@dataclass(frozen=True, slots=True)
class EstimateRequest:
    """Which trial to estimate: a run, or the path of a recording; ``force`` estimates it again."""

    trial: str
    store: Store
    force: bool = False
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
    source = _source(request)
    draft = request.store.draft(
        stage=STAGE,
        stage_version=STAGE_VERSION,
        experiment=source.experiment,
        parameters={},
        inputs=(source.input,),
        command=request.command,
    )
    known = None if request.force else request.store.find_recipe(draft.recipe)
    if known is not None:
        return EstimateResult(known, parse(EstimateDocument, load(known.file(ESTIMATE))), reused=True)
    with draft:
        found = estimate_recording(source.path)
        document = _document(found, source.trial)
        _write(draft, found, document)
    return EstimateResult(draft.run, document, reused=False)


def estimate_recording(path: Path) -> RecordedEstimate:
    """Estimate a recording, wherever it lies, from nothing but itself."""
    recording = read_recording(path)
    experiment = parse(Experiment, loads(_text(recording, "experiment.yaml"), f"{path}: experiment.yaml"))
    plan = parse(PlanDocument, loads(_text(recording, "plan.yaml"), f"{path}: plan.yaml"))
    refuse_unsound(recording)
    start_ns, stop_ns = (_stamp(recording, message) for message in (MOTION_STARTS, MOTION_ENDS))
    request = EstimationRequest(
        mocap=around_motion(recording.mocap(), start_ns, stop_ns),
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
    )
    return RecordedEstimate(estimate(request), experiment, plan, start_ns)


@dataclass(frozen=True, slots=True)
class _Source:
    """A recording: where it lies, which run made it, for which experiment."""

    path: Path
    trial: str
    experiment: str
    input: InputRef


def _source(request: EstimateRequest) -> _Source:
    path = Path(request.trial)
    if path.suffix == ".mcap":
        provenance = read_recording(path).metadata.get(PROVENANCE, {})
        if not {"run", "experiment"} <= provenance.keys():
            raise InputError(f"{path}: does not say which run recorded it for which experiment: not a recorded trial")
        return _Source(path, provenance["run"], provenance["experiment"], outside_input(RECORDING, path))
    run = request.store.get(request.trial)
    return _Source(run.file(RECORDING), run.id, run.manifest.experiment, run.input(RECORDING))


def _text(recording: Recording, name: str) -> str:
    try:
        return recording.attachment(name).decode("utf-8")
    except UnicodeDecodeError as error:
        raise InputError(f"{recording.path}: {name}: is not UTF-8 at byte {error.start}") from None


def _stamp(recording: Recording, message: str) -> int:
    for event in recording.events():
        if event.message == message:
            return event.stamp_ns
    raise InputError(f"{recording.path}: does not say when the {message}: the trial was not run to its end")


def _document(found: RecordedEstimate, trial: str) -> EstimateDocument:
    told = found.estimate
    slide = None
    if told.slide is not None:
        start_s, stop_s = (_since_start(found, time_s) for time_s in (told.slide.start_s, told.slide.stop_s))
        slide = records.SlideFound(start_s=start_s, stop_s=stop_s)
    return EstimateDocument(
        trial=trial,
        clock=records.ClockFit(
            offset_s=told.clock.offset_s, rate_ppm=told.clock.drift_ppm, residual_std_s=1e-9 * told.clock.residual_ns
        ),
        frames_used=int(np.sum(told.tracks.relative.valid)),
        initial_relative_pose=_uncertain(told.initial),
        final_relative_pose=_uncertain(told.final),
        lost=told.lost,
        slide=slide,
        friction=_friction(found),
        friction_missing_because=told.friction_reason,
        notes=told.notes,
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


def _friction(found: RecordedEstimate) -> records.FrictionEstimate | None:
    told, experiment = found.estimate.friction, found.experiment
    if told is None:
        return None
    kappa = told.kappa_m_s2
    return records.FrictionEstimate(
        kappa_m_s2=records.Measured(
            value=kappa,
            std=kappa * told.kappa_relative_sd,
            interval_95=(told.kappa_interval_m_s2.low, told.kappa_interval_m_s2.high),
        ),
        mu=records.Derived(value=told.mu, interval_95=(told.mu_interval.low, told.mu_interval.high)),
        assumed=records.Assumed(
            normal_force_n=experiment.grasp.normal_force_n,
            mass_kg=experiment.object.mass_kg,
            rho_m=experiment.grasp.rho_m,
        ),
    )


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


def _series(told: Estimate, smoothed: SmoothedSeries) -> PlanarSeries:
    return PlanarSeries(told.tracks.stamp_ns, smoothed.pose, smoothed.velocity, smoothed.pose_sd)
