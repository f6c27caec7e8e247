"""Execute: run a plan on a lab and record everything."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from slidepipe.arm.kinematics import hand_error
from slidepipe.arm.model import nominal_model
from slidepipe.artifacts import topics
from slidepipe.artifacts.draft import Draft
from slidepipe.artifacts.experiment import Experiment, load_experiment
from slidepipe.artifacts.manifest import RunState
from slidepipe.artifacts.plan import PlanDocument
from slidepipe.artifacts.recording_reader import Recording, read_recording
from slidepipe.artifacts.recording_series import Series, write_series
from slidepipe.artifacts.recording_writer import RecordingWriter
from slidepipe.artifacts.run import Run
from slidepipe.artifacts.schema import dump_model, parse
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.strict_yaml import load
from slidepipe.artifacts.trial import TrackingError, TrialDocument, TruthDocument
from slidepipe.artifacts.values import Pose
from slidepipe.errors import InputError
from slidepipe.lab.loop import Execution, execute
from slidepipe.lab.simulated import SimulatedLab, Truth
from slidepipe.series import FloatArray
from slidepipe.stages import trial_facts
from slidepipe.stages.plan_files import EXPERIMENT, PLAN, REFERENCE, REFERENCE_JOINTS
from slidepipe.stages.recorder import TrialRecorder
from slidepipe.stages.translate import cameras, setup, tracker, vector, world
from slidepipe.stages.trial_facts import frame_counts, outcome_of

STAGE, STAGE_VERSION = "execute", 1
TRIAL, RECORDING, TRUTH, TRUE_POSES = trial_facts.TRIAL, trial_facts.RECORDING, "truth", "true-poses"
"""Roles of a trial's files."""
TRUE_HAND, TRUE_OBJECT = "/truth/hand", "/truth/object"
SLIDES_ABOVE_M_S = 0.005
"""MuJoCo's soft contact creeps below this speed while it sticks."""


@dataclass(frozen=True, slots=True)
class ExecuteRequest:
    """Which plan to run; ``overrides`` may change the simulated lab alone (``lab.key=value``)."""

    plan: str
    store: Store
    overrides: tuple[str, ...] = ()
    command: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class ExecuteResult:
    """The trial's run and document; what was true, where the lab was simulated."""

    run: Run
    document: TrialDocument
    truth: TruthDocument | None


def run(request: ExecuteRequest) -> ExecuteResult:
    """Run a plan on the simulated lab; a trial that loses the block is kept, with the state ``lost``.

    Raises
    ------
    NotFoundError
        There is no such run, or it holds no plan.
    InputError
        An override does not concern the lab.
    """
    plan_run = request.store.get(request.plan)
    plan = parse(PlanDocument, load(plan_run.file(PLAN)))
    experiment = _experiment(plan_run.file(EXPERIMENT), request.overrides)
    draft = request.store.draft(
        stage=STAGE,
        stage_version=STAGE_VERSION,
        experiment=experiment.name,
        parameters=experiment.model_dump(mode="json"),
        inputs=tuple(plan_run.input(role) for role in (PLAN, REFERENCE, EXPERIMENT)),
        seed=experiment.lab.seed,
        command=request.command,
    )
    with draft:
        lab, execution = _record(draft, plan_run, plan, experiment, _true_start(plan, request.store))
        recording = read_recording(draft.path("trial.mcap"))
        document = _trial(recording, execution, plan_run.id, experiment)
        truth = _truth(lab.truth(), document, experiment)
        _write(draft, document, truth, lab.truth())
    return ExecuteResult(draft.run, document, truth)


def _experiment(path: Path, overrides: tuple[str, ...]) -> Experiment:
    for override in overrides:
        if not override.startswith("lab."):
            raise InputError(
                f"--set {override}: an execution can set the lab alone (lab.key=value): plan anew for the rest"
            )
    return load_experiment(path, overrides)


def _true_start(plan: PlanDocument, store: Store) -> FloatArray:
    """Where the block really is: where the trial before left it, else where the experiment puts it."""
    if plan.previous_estimate is None:
        return vector(plan.start_relative_pose)
    estimate = store.get(plan.previous_estimate)
    trial = next(one.run for one in estimate.manifest.inputs if one.role == RECORDING and one.run is not None)
    truth = parse(TruthDocument, load(store.get(trial).file(TRUTH)))
    return vector(truth.final_relative_pose)


def _record(
    draft: Draft, plan_run: Run, plan: PlanDocument, experiment: Experiment, start: FloatArray
) -> tuple[SimulatedLab, Execution]:
    reference = read_recording(plan_run.file(REFERENCE)).joints(REFERENCE_JOINTS)
    lab = SimulatedLab(
        world(experiment),
        tracker(experiment),
        cameras(experiment),
        reference.position_rad[0],
        start,
        random=np.random.default_rng([experiment.lab.seed, plan.trial]),
    )
    provenance = {
        "run": draft.run_id,
        "plan": plan_run.id,
        "experiment": experiment.name,
        "lab": "simulated",
        "clock": "virtual",
    }
    attachments = {"plan.yaml": plan_run.file(PLAN).read_bytes(), "experiment.yaml": dump_model(experiment).encode()}
    with RecordingWriter(draft.add(RECORDING, "trial.mcap"), provenance, attachments) as writer:
        return lab, execute(reference, lab, lab, TrialRecorder(writer, lab.ticks_per_s))


def _trial(recording: Recording, execution: Execution, plan_run: str, experiment: Experiment) -> TrialDocument:
    mocap = recording.mocap()
    return TrialDocument(
        plan=plan_run,
        lab="simulated",
        seed=experiment.lab.seed,
        outcome=outcome_of(mocap, experiment, rate_hz=experiment.lab.cameras.rate_hz),
        started_ns=execution.start_ns,
        finished_ns=execution.stop_ns,
        frames=frame_counts(mocap),
        tracking_error=_tracking(recording, execution, experiment),
        recording_file="trial.mcap",
    )


def _tracking(recording: Recording, execution: Execution, experiment: Experiment) -> TrackingError:
    commanded, measured = recording.joints(topics.COMMANDED), recording.joints(topics.MEASURED)
    moving = (commanded.stamp_ns >= execution.start_ns) & (commanded.stamp_ns <= execution.stop_ns)
    model = nominal_model(setup(experiment, experiment.friction).tool)
    error = hand_error(model, commanded.position_rad[moving], measured.position_rad[moving])
    return TrackingError(
        position_rms_m=float(np.sqrt(np.mean(error.position_m**2))),
        position_peak_m=float(np.max(error.position_m)),
        angle_rms_rad=float(np.sqrt(np.mean(error.angle_rad**2))),
        angle_peak_rad=float(np.max(error.angle_rad)),
    )


def _truth(truth: Truth, trial: TrialDocument, experiment: Experiment) -> TruthDocument:
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


def _write(draft: Draft, document: TrialDocument, truth: TruthDocument, poses: Truth) -> None:
    draft.add(TRIAL, "trial.yaml").write_text(dump_model(document), encoding="utf-8")
    draft.add(TRUTH, "truth.yaml").write_text(dump_model(truth), encoding="utf-8")
    with RecordingWriter(draft.add(TRUE_POSES, "truth.mcap"), {"run": draft.run_id}) as writer:
        write_series(writer, Series(poses={TRUE_HAND: poses.hand, TRUE_OBJECT: poses.object}))
    if document.tracking_error is not None:
        draft.report("tracking_error_rms", document.tracking_error.position_rms_m, unit="m")
    if document.outcome == "lost":
        draft.state = RunState.LOST
