"""Runs and recordings as pandas DataFrames."""

from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy.spatial.transform import Rotation

from slidepipe.artifacts import topics
from slidepipe.artifacts.entry import Entry
from slidepipe.artifacts.experiment import Experiment
from slidepipe.artifacts.query import Query
from slidepipe.artifacts.recording_reader import Recording, read_recording
from slidepipe.artifacts.run import Run
from slidepipe.artifacts.schema import parse
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.strict_yaml import load, loads
from slidepipe.artifacts.trial import TrialDocument, TruthDocument
from slidepipe.mechanics.planar import MotionPlane, relative_pose
from slidepipe.series import FloatArray, IntArray, JointSeries, PoseSeries
from slidepipe.stages.translate import motion_plane
from slidepipe.stages.trial_facts import RECORDING, TRIAL
from slidepipe.stages.trial_files import TRUTH

PLANAR = ("x_m", "y_m", "theta_rad")


@dataclass(frozen=True, slots=True)
class Trial:
    """One trial as it was recorded, on a time that starts with the motion.

    Attributes
    ----------
    run : Run
    document : TrialDocument
    experiment : Experiment
        As the recording holds it.
    hand, object : DataFrame
        Poses in the plane {w}, ``x_m``, ``y_m`` and ``theta_rad`` by ``time_s``: of the finger, and of the object.
    relative_pose : DataFrame
        The finger in the object's frame {b}, of the frames in which the cameras saw both.
    commanded, measured : DataFrame
        Joints of the arm by ``time_s``, ``position_1_rad`` to ``position_7_rad``, ``velocity_1_rad_s`` ... and
        ``effort_1_n_m`` ...
    truth : TruthDocument or None
        What was true, where the lab was simulated.
    """

    run: Run
    document: TrialDocument
    experiment: Experiment
    hand: pd.DataFrame
    object: pd.DataFrame
    relative_pose: pd.DataFrame
    commanded: pd.DataFrame
    measured: pd.DataFrame
    truth: TruthDocument | None


def runs_frame(store: Store, query: Query) -> pd.DataFrame:
    """Runs by id, the earliest finished first: stage, experiment, state, times, seed, recipe, and each result.

    A result has the column ``NAME``, and ``NAME_std`` where it has a standard deviation; units stand in
    ``frame.attrs["units"]``. ``frame.attrs["damaged"]`` names the runs that cannot be read.
    """
    page = store.find(query)
    frame = pd.DataFrame([_row(one) for one in page.entries], columns=_columns(page.entries))
    for name in ("started", "finished"):
        frame[name] = pd.to_datetime(frame[name], utc=True, format="%Y-%m-%dT%H:%M:%S.%fZ")
    frame["seed"] = frame["seed"].astype("Int64")
    frame.attrs["units"] = {told["name"]: told["unit"] for one in page.entries for told in one.results}
    frame.attrs["damaged"] = [one.run for one in page.damaged]
    return frame.set_index("run")


def trial_frames(run: Run) -> Trial:
    """Read a trial's recording.

    Raises
    ------
    NotFoundError
        The run holds no recording.
    InputError
        The recording is damaged.
    """
    recording = read_recording(run.file(RECORDING))
    document = parse(TrialDocument, load(run.file(TRIAL)))
    text = recording.attachment("experiment.yaml").decode("utf-8")
    experiment = parse(Experiment, loads(text, f"{recording.path}: experiment.yaml"))
    plane, start_ns = motion_plane(experiment), document.started_ns
    has_truth = any(output.role == TRUTH for output in run.manifest.outputs)
    mocap = recording.mocap()
    return Trial(
        run=run,
        document=document,
        experiment=experiment,
        hand=_poses(mocap.hand, plane, start_ns),
        object=_poses(mocap.object, plane, start_ns),
        relative_pose=_relative(mocap.hand, mocap.object, plane, start_ns),
        commanded=_joints(recording, topics.COMMANDED, start_ns),
        measured=_joints(recording, topics.MEASURED, start_ns),
        truth=parse(TruthDocument, load(run.file(TRUTH))) if has_truth else None,
    )


def _columns(entries: tuple[Entry, ...]) -> list[str]:
    fixed = ["run", "stage", "experiment", "state", "started", "finished", "seed", "recipe", "inputs", "directory"]
    return list(dict.fromkeys([*fixed, *(name for one in entries for name in _results(one))]))


def _row(one: Entry) -> dict[str, object]:
    return {
        "run": one.run,
        "stage": one.stage,
        "experiment": one.experiment,
        "state": one.state,
        "started": one.started,
        "finished": one.finished,
        "seed": one.seed,
        "recipe": one.recipe,
        "inputs": one.inputs,
        "directory": str(one.directory),
        **_results(one),
    }


def _results(one: Entry) -> dict[str, float]:
    values = {told["name"]: told["value"] for told in one.results}
    return values | {f"{told['name']}_std": told["std"] for told in one.results if told["std"] is not None}


def _poses(series: PoseSeries, plane: MotionPlane, start_ns: int) -> pd.DataFrame:
    return _planar(series.stamp_ns, _projected(series, plane), start_ns)


def _relative(hand: PoseSeries, body: PoseSeries, plane: MotionPlane, start_ns: int) -> pd.DataFrame:
    _, of_hand, of_body = np.intersect1d(hand.sequence, body.sequence, return_indices=True)
    poses = relative_pose(_projected(body, plane)[of_body], _projected(hand, plane)[of_hand])
    poses[:, 2] = np.unwrap(poses[:, 2])
    return _planar(hand.stamp_ns[of_hand], poses, start_ns)


def _projected(series: PoseSeries, plane: MotionPlane) -> FloatArray:
    return np.array(plane.project(series.position_m, Rotation.from_quat(series.quaternion_xyzw).as_matrix()))


def _planar(stamp_ns: IntArray, poses: FloatArray, start_ns: int) -> pd.DataFrame:
    return pd.DataFrame(poses, columns=list(PLANAR), index=_time(stamp_ns, start_ns))


def _joints(recording: Recording, topic: str, start_ns: int) -> pd.DataFrame:
    joints: JointSeries = recording.joints(topic)
    values = {
        f"{name}_{joint + 1}_{unit}": column[:, joint]
        for name, unit, column in (
            ("position", "rad", joints.position_rad),
            ("velocity", "rad_s", joints.velocity_rad_s),
            ("effort", "n_m", joints.effort_n_m),
        )
        for joint in range(column.shape[1])
    }
    return pd.DataFrame(values, index=_time(joints.stamp_ns, start_ns))


def _time(stamp_ns: IntArray, start_ns: int) -> pd.Index:
    return pd.Index(1e-9 * (stamp_ns - start_ns), name="time_s")
