"""Execution on a lab over the network: checked before anything moves, streamed, and told as a trial."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from slidepipe.artifacts.draft import Draft
from slidepipe.artifacts.experiment import Experiment
from slidepipe.artifacts.lab import LabDocument, find_lab, load_lab
from slidepipe.artifacts.lab_names import EXPERIMENTS
from slidepipe.artifacts.manifest import RunState
from slidepipe.artifacts.recording_reader import Recording, read_recording
from slidepipe.artifacts.run import Run
from slidepipe.artifacts.schema import dump_model
from slidepipe.artifacts.trial import StreamReport, TrialDocument
from slidepipe.errors import InputError, LabError, NotFoundError
from slidepipe.lab.desk import Progress
from slidepipe.planning.limits import Check
from slidepipe.stages.labs import lab_settings
from slidepipe.stages.plan_files import PLAN, REFERENCE, REFERENCE_JOINTS
from slidepipe.stages.preflight import preflight
from slidepipe.stages.streamer import Readiness, StreamJob, StreamOutcome
from slidepipe.stages.trial_facts import RECORDING
from slidepipe.stages.trial_files import RECORDING_FILE, Executed, trial_document, write_trial
from slidepipe.stages.watch import Watch, stream

LATE_S = 0.001


@dataclass(frozen=True, slots=True)
class Question:
    """What a person is asked before the arm moves.

    Attributes
    ----------
    lab : LabDocument
    checks : tuple of Check
        The plan beside the lab's limits, the nearest first.
    found : Readiness
        Where the arm is, and how long everything takes.
    """

    lab: LabDocument
    checks: tuple[Check, ...]
    found: Readiness


@dataclass(frozen=True, slots=True)
class RealLab:
    """A lab over the network, and who is asked and told.

    Attributes
    ----------
    name : str
        Path of a lab file, or a name in ``labs`` beside the experiments.
    confirm : Callable
        Whether the arm may move.
    linked : Callable, optional
        Returns when a person has linked the arm, where its program does not tell; without one, the lab file's
        ``link_wait_s`` has to do.
    progress : Callable
        Told ten times a second.
    beside : Path
        Directory of the experiments.
    """

    name: str
    confirm: Callable[[Question], bool]
    linked: Callable[[Readiness], None] | None
    progress: Callable[[Progress], None]
    beside: Path = EXPERIMENTS

    def document(self) -> LabDocument:
        """Read the lab's file.

        Raises
        ------
        NotFoundError
            There is none.
        InputError
            It is wrong.
        """
        return load_lab(find_lab(self.name, self.beside))


@dataclass(frozen=True, slots=True)
class Subject:
    """What is streamed where: a plan's run, its experiment, the lab's file, and who is asked and told."""

    plan_run: Run
    experiment: Experiment
    lab: LabDocument
    real: RealLab


def stream_plan(draft: Draft, subject: Subject) -> TrialDocument:
    """Stream a plan to a lab and write the trial.

    Raises
    ------
    InfeasibleError
        The plan breaks a limit of the lab.
    LabError
        The arm or the cameras do not answer, or failed.
    """
    plan_run, experiment, lab, real = subject.plan_run, subject.experiment, subject.lab, subject.real
    reference = read_recording(plan_run.file(REFERENCE)).joints(REFERENCE_JOINTS)
    checks = preflight(reference, lab, experiment)
    provenance = {
        "run": draft.run_id,
        "plan": plan_run.id,
        "experiment": experiment.name,
        "lab": lab.name,
        "clock": "host",
    }
    attachments = {
        "plan.yaml": plan_run.file(PLAN).read_bytes(),
        "experiment.yaml": dump_model(experiment).encode(),
        "lab.yaml": dump_model(lab).encode(),
    }
    path = draft.add(RECORDING, RECORDING_FILE)
    settings = lab_settings(lab, experiment)
    if real.linked is not None:
        settings = replace(settings, link_wait_s=0.0)
    job = StreamJob(settings, reference, path, provenance, attachments)
    watch = Watch(lambda found: real.confirm(Question(lab, checks, found)), real.linked, real.progress)
    outcome = stream(job, watch)
    fault, stop = outcome.recording.fault, outcome.execution.stop
    executed = Executed(
        outcome.execution, plan_run.id, lab.name, None, lab.cameras.rate_hz, _report(outcome), fault or outcome.invalid
    )
    document = trial_document(_recorded(path, fault), executed, experiment)
    write_trial(draft, document, None if stop is None else stop.cause)
    if fault is not None:
        draft.state = RunState.INTERRUPTED
    return document


def _recorded(path: Path, fault: str | None) -> Recording:
    """Read what the recorder wrote, and what was saved where it had a fault."""
    try:
        return read_recording(path)
    except (InputError, NotFoundError) as error:
        if fault is None:
            raise
        raise LabError(f"recorder: {fault}; nothing that it wrote can be read: {error}") from None


def _report(outcome: StreamOutcome) -> StreamReport:
    late_s = 1e-9 * outcome.late_ns
    p50, p99 = (float(value) for value in np.percentile(late_s, [50, 99]))
    return StreamReport(
        ticks=len(late_s),
        late_p50_s=p50,
        late_p99_s=p99,
        late_max_s=float(late_s.max()),
        late_share=float(np.mean(late_s > LATE_S)),
        longest_gap_s=outcome.execution.longest_gap_s,
        commands=outcome.arm.sent,
        states=outcome.arm.received,
        states_lost=outcome.arm.lost,
        frames_missing=outcome.cameras.frames.missing,
        records_lost=sum(outcome.recording.lost.values()),
        not_permitted=outcome.refused,
    )
