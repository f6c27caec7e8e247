"""Calibrate: where the cameras and the hand's markers are, from a recorded motion."""

from dataclasses import dataclass

from slidepipe.arm.kinematics import hand_poses
from slidepipe.arm.model import nominal_model
from slidepipe.artifacts import topics
from slidepipe.artifacts.calibration import CalibrationDocument, Placement, Tilt, Vector
from slidepipe.artifacts.experiment import Experiment
from slidepipe.artifacts.recording_reader import Recording, read_recording
from slidepipe.artifacts.run import Run
from slidepipe.artifacts.schema import dump_model, parse
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.strict_yaml import load
from slidepipe.estimation import calibration as estimation
from slidepipe.estimation.calibration import Calibration, CalibrationRequest
from slidepipe.series import FloatArray, PoseSeries
from slidepipe.stages.calibration_files import CALIBRATION
from slidepipe.stages.translate import motion_plane, tool
from slidepipe.stages.trial_source import purpose_of, trial_source

STAGE, STAGE_VERSION = "calibrate", 1


@dataclass(frozen=True, slots=True)
class CalibrateRequest:
    """From which trial to calibrate: a run, or the path of a recording; ``force`` does it again."""

    trial: str
    store: Store
    force: bool = False
    command: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class CalibrateResult:
    """The calibration's run and document; ``reused`` where an equal one was there already."""

    run: Run
    document: CalibrationDocument
    reused: bool


def run(request: CalibrateRequest) -> CalibrateResult:
    """Calibrate from a recorded motion.

    Raises
    ------
    NotFoundError
        There is no such run, or it holds no recording.
    InputError
        The recording is damaged, holds no joints, or contradicts itself.
    EstimationError
        The motion cannot tell.
    """
    source = trial_source(request.trial, request.store)
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
        return CalibrateResult(known, parse(CalibrationDocument, load(known.file(CALIBRATION))), reused=True)
    with draft:
        recording = read_recording(source.path)
        experiment = purpose_of(recording).experiment
        told = estimation.calibrate(
            CalibrationRequest(recording.mocap(), _finger(recording, experiment), motion_plane(experiment))
        )
        document = _document(told, source.trial, source.experiment)
        draft.add(CALIBRATION, "calibration.yaml").write_text(dump_model(document), encoding="utf-8")
        for name, axis in (("hand_markers_x", 0), ("hand_markers_y", 1)):
            place = told.hand_markers
            draft.report(name, place.position_m[axis], std=place.position_std_m[axis], unit="m")
    return CalibrateResult(draft.run, document, reused=False)


def _finger(recording: Recording, experiment: Experiment) -> PoseSeries:
    """{f} in the base frame by the measured joints."""
    return hand_poses(nominal_model(tool(experiment)), recording.joints(topics.MEASURED))


def _document(told: Calibration, trial: str, experiment: str) -> CalibrationDocument:
    tilt = None
    if told.object_tilt_rad is not None and told.object_tilt_std_rad is not None:
        tilt = Tilt(rotation_rad=_vector(told.object_tilt_rad), std_rad=_vector(told.object_tilt_std_rad))
    return CalibrationDocument(
        trial=trial,
        experiment=experiment,
        cameras_in_base=_record(told.cameras_in_base),
        hand_markers=_record(told.hand_markers),
        object_tilt=tilt,
        heading_rad=told.heading_rad,
        lean_rad=told.lean_rad,
        plane_std_rad=told.plane_std_rad,
        down_in_cameras=_vector(told.down_in_cameras),
        down_std_rad=told.down_std_rad,
        joints_late_s=told.delay_s,
        joints_late_std_s=told.delay_std_s,
        turn_rad=told.turn_rad,
        rms_m=told.rms_m,
        rms_rad=told.rms_rad,
        frames=told.frames,
        outliers=told.outliers,
        notes=_notes(told),
    )


def _notes(told: Calibration) -> tuple[str, ...]:
    across = float(told.hand_markers.position_std_m[2])
    notes = ["down is where the arm's base has it: the base is taken to stand level"]
    if across > estimation.LARGEST_PLACE_STD_M:
        notes.append(
            f"the motion stayed near a plane: how far out of it the hand's markers are is uncertain by "
            f"{1e3 * across:.2g} mm, which does not matter for motions in it"
        )
    if told.object_tilt_rad is None:
        notes.append("the object was not seen: its markers' tilt is not told")
    else:
        notes.append("where {b} is on the object's markers, a motion in the grip cannot tell: only their tilt")
    return tuple(notes)


def _record(placement: estimation.Placement) -> Placement:
    return Placement(
        position_m=_vector(placement.position_m),
        position_std_m=_vector(placement.position_std_m),
        rotation_rad=_vector(placement.rotation_rad),
        rotation_std_rad=_vector(placement.rotation_std_rad),
    )


def _vector(values: FloatArray) -> Vector:
    x, y, z = (float(value) for value in values)
    return x, y, z
