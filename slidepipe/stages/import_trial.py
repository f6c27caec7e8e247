"""Import: poses that another tool recorded become a trial, which an estimate reads as it reads our own.

Such a trial has no joints, so that nobody knows how well the arm followed; and its time is the cameras' own, so that
there is no offset to a host's clock. Grips, slide and friction are told by the poses alone.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from slidepipe.artifacts.draft import Draft
from slidepipe.artifacts.experiment import Experiment, load_experiment
from slidepipe.artifacts.foreign_poses import Sighting
from slidepipe.artifacts.manifest import RunState
from slidepipe.artifacts.recording_reader import Event
from slidepipe.artifacts.recording_series import Series, write_series
from slidepipe.artifacts.recording_writer import RecordingWriter
from slidepipe.artifacts.run import Run, outside_input
from slidepipe.artifacts.schema import dump_model
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.trial import TrialDocument
from slidepipe.errors import InputError
from slidepipe.lab.camera_frame import CameraFrame, RigidPose, UpAxis
from slidepipe.lab.loop import MOTION_ENDS, MOTION_STARTS
from slidepipe.series import BoolArray, ClockSync, FloatArray, FrameSeries, MocapSeries, PoseSeries
from slidepipe.stages.motion_times import MotionTimes, find_motion
from slidepipe.stages.plan_files import EXPERIMENT, PLAN
from slidepipe.stages.trial_facts import IMPORTED, RECORDING, TRIAL, frame_counts, outcome_of

STAGE, STAGE_VERSION = "import", 1
SOURCE = "source"
"""Role of the file that was imported, where it is one."""
TICKS_PER_S = 1e9
START_NS = 1_000_000_000
"""Where the imported time begins, as the simulated lab's does: no stamp is ever before its zero."""
CSV = ".csv"
EXCHANGES = 50
"""Echoes of the cameras with themselves, spread over the trial: they state that there is one clock."""


@dataclass(frozen=True, slots=True)
class ImportRequest:
    """What to import.

    Attributes
    ----------
    source : Path
        Motive's CSV export, or a ROS 2 bag.
    plan : str
        Run that holds the plan which the trial followed, as far as is known: the estimate takes from it where to look.
    hand, object : str
        Rigid bodies of the export, or topics of the bag.
    frame : CameraFrame
        Where the cameras' frame is.
    hand_offset, object_offset : RigidPose
        Poses of {f} and {b} in the bodies as the cameras know them.
    motion_s : MotionTimes, optional
        When the motion began and ended, from the first frame, s; found from the hand where it is not given.
    """

    source: Path
    plan: str
    hand: str
    object: str
    store: Store
    frame: CameraFrame = field(default_factory=CameraFrame)
    hand_offset: RigidPose = field(default_factory=RigidPose)
    object_offset: RigidPose = field(default_factory=RigidPose)
    motion_s: MotionTimes | None = None
    command: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class ImportResult:
    """The trial's run and document, and when the motion began and ended, s from the first frame."""

    run: Run
    document: TrialDocument
    motion_s: MotionTimes


def pose(name: str, numbers: Sequence[float] | None) -> RigidPose:
    """Pose of seven numbers, position and quaternion x y z w; where there are none, the pose that changes nothing.

    Raises
    ------
    InputError
        The quaternion is not of unit length.
    """
    if numbers is None:
        return RigidPose()
    x, y, z, qx, qy, qz, qw = numbers
    length = math.hypot(qx, qy, qz, qw)
    if not abs(length - 1.0) < 0.01:
        raise InputError(f"{name}: the quaternion must be of length 1, got {length:.3g}")
    return RigidPose((x, y, z), (qx / length, qy / length, qz / length, qw / length))


def camera_frame(source: Path, up: str | None, in_base: Sequence[float] | None) -> CameraFrame:
    """Where the frame of an import is; y points up in Motive, and z in ROS, unless told otherwise."""
    usual = UpAxis.Y if source.suffix.lower() == CSV else UpAxis.Z
    return CameraFrame(usual if up is None else UpAxis(up), pose("--cameras-in-base", in_base))


def run(request: ImportRequest) -> ImportResult:
    """Import a trial.

    Raises
    ------
    NotFoundError
        There is no such file or run, or the run holds no plan.
    InputError
        The file is wrong, lacks a body, or does not show when the motion begins and ends.
    """
    plan_run = request.store.get(request.plan)
    experiment = load_experiment(plan_run.file(EXPERIMENT), ())
    sighting = _read(request)
    mocap = _mocap(sighting, request)
    motion_s = request.motion_s or find_motion(mocap.hand, str(request.source))
    inputs = [plan_run.input(role) for role in (PLAN, EXPERIMENT)]
    if request.source.is_file():
        inputs.append(outside_input(SOURCE, request.source))
    draft = request.store.draft(
        stage=STAGE,
        stage_version=STAGE_VERSION,
        experiment=experiment.name,
        parameters=_parameters(request, motion_s),
        inputs=inputs,
        command=request.command,
    )
    with draft:
        _record(draft, mocap, plan_run, experiment, motion_s)
        document = _document(mocap, plan_run.id, experiment, motion_s)
        draft.add(TRIAL, "trial.yaml").write_text(dump_model(document), encoding="utf-8")
        if document.outcome == "lost":
            draft.state = RunState.LOST
    return ImportResult(draft.run, document, motion_s)


def _read(request: ImportRequest) -> Sighting:
    if request.source.suffix.lower() == CSV:
        from slidepipe.artifacts.motive_csv import read_motive_csv  # noqa: PLC0415  # one of the two is needed

        return read_motive_csv(request.source, request.hand, request.object)
    from slidepipe.artifacts.ros2_bag import read_bag  # noqa: PLC0415  # as above

    return read_bag(request.source, request.hand, request.object)


def _parameters(request: ImportRequest, motion_s: MotionTimes) -> dict[str, object]:
    frame = request.frame
    return {
        "source": str(request.source),
        "hand": request.hand,
        "object": request.object,
        "up": frame.up.value,
        "cameras_in_base": _numbers(frame.in_base),
        "hand_offset": _numbers(request.hand_offset),
        "object_offset": _numbers(request.object_offset),
        "motion_starts_s": motion_s.start_s,
        "motion_ends_s": motion_s.stop_s,
    }


def _numbers(pose: RigidPose) -> list[float]:
    return [*pose.position_m, *pose.quaternion_xyzw]


def _mocap(sighting: Sighting, request: ImportRequest) -> MocapSeries:
    stamps = sighting.stamp_ns - sighting.stamp_ns[0] + START_NS
    hand_seen, object_seen = (_seen(poses) for poses in (sighting.hand, sighting.object))
    frames = FrameSeries(sighting.frame, stamps, stamps, hand_seen, object_seen)
    echoes = np.unique(np.linspace(stamps[0], stamps[-1], EXCHANGES).astype(np.int64))

    def body(poses: FloatArray, valid: BoolArray, offset: RigidPose) -> PoseSeries:
        placed = [_placed(row, request.frame, offset) for row in poses[valid].tolist()]
        return PoseSeries(
            stamp_ns=stamps[valid],
            position_m=np.array([pose.position_m for pose in placed], dtype=float).reshape(-1, 3),
            quaternion_xyzw=_unit(np.array([pose.quaternion_xyzw for pose in placed], dtype=float).reshape(-1, 4)),
            sequence=sighting.frame[valid],
        )

    return MocapSeries(
        frames=frames,
        hand=body(sighting.hand, hand_seen, request.hand_offset),
        object=body(sighting.object, object_seen, request.object_offset),
        clock=ClockSync(echoes, echoes, echoes, TICKS_PER_S),
    )


def _seen(poses: FloatArray) -> BoolArray:
    return np.asarray(np.isfinite(poses).all(axis=1))


def _placed(row: list[float], frame: CameraFrame, offset: RigidPose) -> RigidPose:
    x, y, z, qx, qy, qz, qw = row
    return frame.to_base(RigidPose((x, y, z), (qx, qy, qz, qw))).then(offset)


def _unit(quaternions: FloatArray) -> FloatArray:
    lengths = np.linalg.norm(quaternions, axis=1, keepdims=True)
    worst = float(lengths.flat[np.argmax(np.abs(lengths - 1.0))]) if len(lengths) else 1.0
    if abs(worst - 1.0) > 0.1:
        raise InputError(f"rotations: must be unit quaternions, got one of length {worst:.3g}")
    return np.asarray(quaternions / lengths)


def _record(draft: Draft, mocap: MocapSeries, plan_run: Run, experiment: Experiment, motion_s: MotionTimes) -> None:
    provenance = {
        "run": draft.run_id,
        "plan": plan_run.id,
        "experiment": experiment.name,
        "lab": IMPORTED,
        "clock": "the cameras' own",
    } | {key: str(value) for key, value in draft.request.parameters.items()}
    attachments = {"plan.yaml": plan_run.file(PLAN).read_bytes(), "experiment.yaml": dump_model(experiment).encode()}
    first_ns = int(mocap.frames.received_ns[0])
    events = [
        Event(first_ns + round(1e9 * time_s), "info", "import", message)
        for time_s, message in ((motion_s.start_s, MOTION_STARTS), (motion_s.stop_s, MOTION_ENDS))
    ]
    with RecordingWriter(draft.add(RECORDING, "trial.mcap"), provenance, attachments) as writer:
        write_series(writer, Series(mocap=mocap, events=events))


def _document(mocap: MocapSeries, plan_run: str, experiment: Experiment, motion_s: MotionTimes) -> TrialDocument:
    first_ns = int(mocap.frames.received_ns[0])
    period_ns = float(np.median(np.diff(mocap.frames.received_ns)))
    return TrialDocument(
        plan=plan_run,
        lab="imported",
        seed=None,
        outcome=outcome_of(mocap, experiment, rate_hz=1e9 / period_ns),
        started_ns=first_ns + round(1e9 * motion_s.start_s),
        finished_ns=first_ns + round(1e9 * motion_s.stop_s),
        frames=frame_counts(mocap),
        tracking_error=None,
        recording_file="trial.mcap",
    )
