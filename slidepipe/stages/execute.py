"""Execute: run a plan on a lab and record everything."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from slidepipe.artifacts.draft import Draft
from slidepipe.artifacts.experiment import Experiment, load_experiment
from slidepipe.artifacts.plan import PlanDocument
from slidepipe.artifacts.recording_reader import read_recording
from slidepipe.artifacts.recording_writer import RecordingWriter
from slidepipe.artifacts.run import Run
from slidepipe.artifacts.schema import dump_model, parse
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.strict_yaml import load
from slidepipe.artifacts.trial import TrialDocument, TruthDocument
from slidepipe.errors import InputError
from slidepipe.lab.course import rest_move_rest
from slidepipe.lab.loop import Execution, execute
from slidepipe.lab.simulated import SimulatedLab
from slidepipe.series import FloatArray
from slidepipe.stages.on_lab import RealLab, Subject, stream_plan
from slidepipe.stages.plan_files import EXPERIMENT, PLAN, REFERENCE, REFERENCE_JOINTS
from slidepipe.stages.recorder import TrialRecorder
from slidepipe.stages.translate import cameras, scattered, tracker, vector, world
from slidepipe.stages.trial_facts import RECORDING
from slidepipe.stages.trial_files import (
    RECORDING_FILE,
    SIMULATED,
    TRUTH,
    Executed,
    trial_document,
    truth_document,
    write_trial,
    write_truth,
)

STAGE, STAGE_VERSION = "execute", 1
REPETITION = "repetition"
"""Parameter of a trial that repeats a plan."""


@dataclass(frozen=True, slots=True)
class ExecuteRequest:
    """Which plan to run, and where.

    Attributes
    ----------
    plan : str
    store : Store
    overrides : tuple of str
        May change the simulated lab alone (``lab.key=value``).
    repetition : int
        Counts trials of the same plan that are to be compared, from 1; 0 is a trial of a campaign.
    lab : RealLab, optional
        A lab over the network; the simulated one in virtual time unless given.
    """

    plan: str
    store: Store
    overrides: tuple[str, ...] = ()
    repetition: int = 0
    command: tuple[str, ...] = ()
    lab: RealLab | None = None


@dataclass(frozen=True, slots=True)
class _WorldNow:
    """World as it is in one trial: its friction and forces, where the finger really is, and its seeds."""

    experiment: Experiment
    r_start: FloatArray
    seeds: list[int]


@dataclass(frozen=True, slots=True)
class ExecuteResult:
    """The trial's run and document; what was true, where the lab was simulated."""

    run: Run
    document: TrialDocument
    truth: TruthDocument | None


def run(request: ExecuteRequest) -> ExecuteResult:
    """Run a plan; a trial that loses the block or is stopped is kept, with the state ``lost`` or ``stopped``.

    Raises
    ------
    NotFoundError
        There is no such run, or it holds no plan; or there is no such lab.
    InputError
        An override does not concern the lab, or the lab file is wrong.
    InfeasibleError
        The plan breaks a limit of the lab: nothing has moved.
    LabError
        The arm or the cameras do not answer, or failed.
    """
    plan_run = request.store.get(request.plan)
    plan = parse(PlanDocument, load(plan_run.file(PLAN)))
    experiment = _experiment(plan_run.file(EXPERIMENT), request.overrides)
    real = request.lab
    subject = None if real is None else Subject(plan_run, experiment, real.document(), real)
    draft = request.store.draft(
        stage=STAGE,
        stage_version=STAGE_VERSION,
        experiment=experiment.name,
        parameters=experiment.model_dump(mode="json")
        | ({REPETITION: request.repetition} if request.repetition else {}),
        inputs=tuple(plan_run.whole_input(role) for role in (PLAN, REFERENCE, EXPERIMENT)),
        seed=experiment.lab.seed if request.lab is None else None,
        command=request.command,
    )
    with draft:
        if subject is not None:
            document, truth = stream_plan(draft, subject), None
        else:
            document, truth = _simulate(draft, plan_run, _world_now(plan, experiment, request))
    return ExecuteResult(draft.run, document, truth)


def _experiment(path: Path, overrides: tuple[str, ...]) -> Experiment:
    for override in overrides:
        if not override.startswith("lab."):
            raise InputError(
                f"--set {override}: an execution can set the lab alone (lab.key=value): plan anew for the rest"
            )
    return load_experiment(path, overrides)


def _world_now(plan: PlanDocument, experiment: Experiment, request: ExecuteRequest) -> _WorldNow:
    actual = scattered(experiment, plan.trial, request.repetition)
    seeds = [experiment.lab.seed, plan.trial, *([request.repetition] if request.repetition else [])]
    return _WorldNow(actual, _true_start(plan, actual, request.store), seeds)


def _true_start(plan: PlanDocument, actual: Experiment, store: Store) -> FloatArray:
    """Where the block really is: where the trial before left it, if that is known, else where it was put down."""
    if plan.previous_estimate is not None:
        estimate = store.get(plan.previous_estimate)
        trial = store.get(
            next(one.run for one in estimate.manifest.inputs if one.role == RECORDING and one.run is not None)
        )
        if TRUTH not in {output.role for output in trial.manifest.outputs}:
            return vector(plan.start_relative_pose)
        truth = parse(TruthDocument, load(trial.file(TRUTH)))
        if truth.outcome == "held":
            return vector(truth.final_relative_pose)
    error = actual.lab.grasp_error
    return np.asarray(vector(plan.start_relative_pose) + np.array([error.x_m, error.y_m, error.theta_rad]))


def _simulate(draft: Draft, plan_run: Run, world_now: _WorldNow) -> tuple[TrialDocument, TruthDocument]:
    experiment = world_now.experiment
    lab, execution = _record(draft, plan_run, world_now)
    recording = read_recording(draft.path(RECORDING_FILE))
    executed = Executed(execution, plan_run.id, SIMULATED, experiment.lab.seed, experiment.lab.cameras.rate_hz)
    document = trial_document(recording, executed, experiment)
    truth = truth_document(lab.truth(), document, experiment)
    write_trial(draft, document)
    write_truth(draft, truth, lab.truth())
    return document, truth


def _record(draft: Draft, plan_run: Run, world_now: _WorldNow) -> tuple[SimulatedLab, Execution]:
    experiment = world_now.experiment
    reference = read_recording(plan_run.file(REFERENCE)).joints(REFERENCE_JOINTS)
    lab = SimulatedLab(
        world(experiment),
        tracker(experiment),
        cameras(experiment),
        reference.position_rad[0],
        world_now.r_start,
        random=np.random.default_rng(world_now.seeds),
    )
    provenance = {
        "run": draft.run_id,
        "plan": plan_run.id,
        "experiment": experiment.name,
        "lab": SIMULATED,
        "clock": "virtual",
    }
    attachments = {"plan.yaml": plan_run.file(PLAN).read_bytes(), "experiment.yaml": dump_model(experiment).encode()}
    with RecordingWriter(draft.add(RECORDING, RECORDING_FILE), provenance, attachments) as writer:
        return lab, execute(rest_move_rest(reference), lab, lab, TrialRecorder(writer, lab.ticks_per_s))
