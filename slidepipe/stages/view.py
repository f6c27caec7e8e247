"""View: a trial in three dimensions, from nothing but its recording."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from slidepipe.arm.kinematics import link_points
from slidepipe.arm.model import nominal_model
from slidepipe.artifacts import topics
from slidepipe.artifacts.durable import whole
from slidepipe.artifacts.experiment import Experiment
from slidepipe.artifacts.recording_reader import Recording, read_recording
from slidepipe.artifacts.scene_file import SceneSeries, write_scene
from slidepipe.artifacts.schema import parse
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.strict_yaml import loads
from slidepipe.errors import InputError
from slidepipe.figures.replay import Replay, open_replay, save_replay
from slidepipe.figures.traces import near
from slidepipe.lab.loop import MOTION_STARTS
from slidepipe.mechanics.planar import relative_pose
from slidepipe.stages.pictures import in_plane
from slidepipe.stages.translate import motion_plane, setup
from slidepipe.stages.trial_facts import RECORDING

ARM_EVERY = 5
"""Every so many ticks the arm is drawn: a hundred times a second."""


@dataclass(frozen=True, slots=True)
class ViewRequest:
    """Which trial, a run or the path of a recording, and the file to write; the viewer opens where there is none."""

    trial: str
    store: Store
    save: Path | None = None


@dataclass(frozen=True, slots=True)
class ViewResult:
    """What was shown: the trial's name, and how many poses and joint states are in it."""

    name: str
    poses: int
    joints: int


def run(request: ViewRequest) -> ViewResult:
    """Show a trial, or write what would be shown.

    Raises
    ------
    NotFoundError
        There is no such run or recording, or rerun is not installed.
    InputError
        The recording is damaged, or the file cannot be written.
    """
    outside = request.trial.endswith(".mcap")
    found = None if outside else request.store.get(request.trial)
    path = Path(request.trial) if found is None else found.file(RECORDING)
    replay = replay_of(read_recording(path), path.parent.name if found is None else found.id)
    if request.save is None:
        open_replay(replay)
    else:
        _save(replay, request.save)
    return ViewResult(replay.name, len(replay.hand.stamp_ns) + len(replay.block.stamp_ns), len(replay.joints.stamp_ns))


def replay_of(recording: Recording, name: str) -> Replay:
    """Make what is shown of a recording."""
    where = f"{recording.path}: experiment.yaml"
    experiment = parse(Experiment, loads(recording.attachment("experiment.yaml").decode(), where))
    joints, commanded = recording.joints(topics.MEASURED), recording.joints(topics.COMMANDED)
    hand, body = recording.poses(topics.HAND), recording.poses(topics.OBJECT)
    plane, thing = motion_plane(experiment), experiment.object
    _, first, second = np.intersect1d(hand.sequence, body.sequence, return_indices=True)
    relative = relative_pose(in_plane(body, plane)[second], in_plane(hand, plane)[first])
    relative = near(relative, np.array([experiment.start.relative_pose.vector]))
    model = nominal_model(setup(experiment, experiment.friction).tool)
    return Replay(
        name=name,
        start_ns=_started(recording),
        hand=hand,
        block=body,
        joints=joints,
        commanded=commanded,
        arm_stamp_ns=joints.stamp_ns[::ARM_EVERY],
        arm_m=link_points(model, joints.position_rad[::ARM_EVERY]),
        relative_stamp_ns=hand.stamp_ns[first],
        relative=relative * np.array([1e3, 1e3, np.degrees(1.0)]),
        block_size_m=np.array([thing.size_x_m, thing.size_y_m, thing.thickness_m]),
    )


def _started(recording: Recording) -> int:
    """When the motion began, or the recording where it never did."""
    for event in recording.events():
        if event.message == MOTION_STARTS:
            return event.stamp_ns
    return int(recording.joints(topics.MEASURED).stamp_ns[0])


def _save(replay: Replay, path: Path) -> None:
    if path.suffix not in {".rrd", ".mcap"}:
        raise InputError(f"--save {path}: must end in .rrd (for rerun) or .mcap (for Foxglove)")
    with whole(path) as draft:
        if path.suffix == ".rrd":
            save_replay(replay, draft)
        else:
            draft.unlink()
            write_scene(draft, _scene(replay), replay.name)


def _scene(replay: Replay) -> SceneSeries:
    return SceneSeries(replay.hand, replay.block, replay.block_size_m, replay.arm_stamp_ns, replay.arm_m)
