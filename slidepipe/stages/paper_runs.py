"""The runs behind the paper's figures: what the store has is taken, what it lacks is run."""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from slidepipe.artifacts.estimate import EstimateDocument
from slidepipe.artifacts.experiment import Experiment, load_experiment
from slidepipe.artifacts.manifest import RunState
from slidepipe.artifacts.plan import PlanDocument
from slidepipe.artifacts.recording_reader import read_recording
from slidepipe.artifacts.run import Run
from slidepipe.artifacts.schema import parse
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.strict_yaml import load
from slidepipe.artifacts.trial import TrialDocument
from slidepipe.mechanics.dynamics import sliding_acceleration
from slidepipe.mechanics.planar import relative_pose
from slidepipe.series import FloatArray
from slidepipe.stages import estimate, execute, plan
from slidepipe.stages.pictures import TrialRuns, in_plane
from slidepipe.stages.plan_files import EXPERIMENT, PLAN, REFERENCE, REFERENCE_HAND, REFERENCE_OBJECT
from slidepipe.stages.translate import block, motion_plane, setup
from slidepipe.stages.trial_facts import TRIAL

LINEAR, ROTATIONAL = "paper_linear", "paper_rotational"
REPEATS, FRICTION_SD = 10, 0.03
"""Trials of one plan for Fig. 12, and the standard deviation of their friction as a share of the believed one."""
DRAW_SEED = 12
_ENDED = (RunState.COMPLETE, RunState.LOST)


@dataclass(frozen=True, slots=True)
class PlannedMotion:
    """A plan's reference in the plane: (T,) times in s, (T, 3) poses, and rates of the relative pose and the object."""

    time_s: FloatArray
    q_o: FloatArray
    q_f: FloatArray
    r_f_b: FloatArray
    dr_f_b: FloatArray
    ddq_o: FloatArray

    def during(self, start_s: float, stop_s: float) -> slice:
        """Samples from one time to another, both included."""
        low, high = np.searchsorted(self.time_s, [start_s - 1e-9, stop_s + 1e-9])
        return slice(int(low), int(high))


@dataclass(frozen=True)
class Planned:
    """A plan and what it was made for."""

    run: Run
    document: PlanDocument
    experiment: Experiment

    @cached_property
    def motion(self) -> PlannedMotion:
        """The reference, with friction's acceleration of the object while it slides (eq. 20)."""
        return planned_motion(self.run, self.document, self.experiment)


@dataclass(frozen=True, slots=True)
class Tried:
    """One trial with its three runs."""

    runs: TrialRuns
    trial: TrialDocument
    estimate: EstimateDocument
    experiment: Experiment


class PaperRuns:
    """Finds or makes the runs, each once.

    Parameters
    ----------
    experiments : Path
        Folder with the paper's two experiment files.
    store : Store
    report : callable
        Told of every run that had to be made.
    command : sequence of str
    """

    def __init__(
        self, experiments: Path, store: Store, report: Callable[[str], None], command: Sequence[str] = ()
    ) -> None:
        self._experiments, self._store, self._report = experiments, store, report
        self._command = tuple(command)

    def experiment(self, name: str) -> Experiment:
        """One of the paper's experiments."""
        return load_experiment(self._experiments / f"{name}.yaml")

    @cached_property
    def linear(self) -> Planned:
        """The plan of Section VIII-A."""
        return self._planned(LINEAR)

    @cached_property
    def rotational(self) -> Planned:
        """The plan of Section VIII-B."""
        return self._planned(ROTATIONAL)

    @cached_property
    def nominal(self) -> Tried:
        """The plan of Section VIII-A, tried in a world with the friction that it believes."""
        return self._tried(self.linear, ())

    @cached_property
    def repeats(self) -> tuple[Tried, ...]:
        """The plan of Section VIII-A, tried again and again in worlds of slightly different friction."""
        believed = self.linear.experiment.friction
        draws = np.random.default_rng(DRAW_SEED).normal(1.0, FRICTION_SD, REPEATS)
        return tuple(
            self._tried(self.linear, (f"lab.friction={believed * ratio:.4f}", f"lab.seed={seed}"))
            for seed, ratio in enumerate(draws, start=1)
        )

    def _planned(self, name: str) -> Planned:
        request = plan.PlanRequest(self._experiments / f"{name}.yaml", self._store, command=self._command)
        made = plan.run(request)
        if not made.reused:
            self._report(f"planned {made.run.id} {name}")
        experiment = parse(Experiment, load(made.run.file(EXPERIMENT)))
        return Planned(made.run, made.document, experiment)

    def _tried(self, planned: Planned, overrides: tuple[str, ...]) -> Tried:
        experiment = load_experiment(planned.run.file(EXPERIMENT), overrides)
        run = self._known_trial(planned.run, experiment)
        if run is None:
            request = execute.ExecuteRequest(planned.run.id, self._store, overrides, command=self._command)
            run = execute.run(request).run
            self._report(f"executed {run.id} {' '.join(overrides)}".rstrip())
        told = estimate.run(estimate.EstimateRequest(run.id, self._store, command=self._command))
        trial = parse(TrialDocument, load(run.file(TRIAL)))
        return Tried(TrialRuns(planned.run, run, told.run), trial, told.document, experiment)

    def _known_trial(self, plan_run: Run, experiment: Experiment) -> Run | None:
        """The latest trial of this plan in this very world; an execution has no recipe that is reused by itself."""
        wanted, source = _plain(experiment.model_dump()), plan_run.input(PLAN)
        for run in reversed(self._store.runs(experiment=experiment.name, stage=execute.STAGE)):
            told = run.manifest
            same = (
                _plain(told.parameters) == wanted
                and told.stage_version == execute.STAGE_VERSION
                and source in told.inputs
            )
            if same and told.state in _ENDED:
                return run
        return None


def _plain(parameters: Mapping[str, object]) -> str:
    """Parameters in one form, whether they come from a file or from a model."""
    return json.dumps(parameters, sort_keys=True)


def planned_motion(run: Run, document: PlanDocument, experiment: Experiment) -> PlannedMotion:
    """Read a plan's reference, and derive what it leaves unsaid."""
    reference, plane = read_recording(run.file(REFERENCE)), motion_plane(experiment)
    hand = reference.poses(REFERENCE_HAND)
    time_s = np.asarray(1e-9 * hand.stamp_ns, dtype=np.float64)
    q_f, q_o = in_plane(hand, plane), in_plane(reference.poses(REFERENCE_OBJECT), plane)
    q_f[:, 2], q_o[:, 2] = np.unwrap(q_f[:, 2]), np.unwrap(q_o[:, 2])
    r_f_b = relative_pose(q_o, q_f)
    dr_f_b = np.gradient(r_f_b, time_s, axis=0)
    ddq_o = np.gradient(np.gradient(q_o, time_s, axis=0), time_s, axis=0)
    sliding = (time_s > document.slide.start_s - 1e-9) & (time_s < document.slide.stop_s - 1e-9)
    finger = setup(experiment, document.believed.friction).finger
    ddq_o[sliding] = sliding_acceleration(block(experiment), finger, q_o[sliding, 2], r_f_b[sliding], dr_f_b[sliding])
    return PlannedMotion(time_s, q_o, q_f, r_f_b, dr_f_b, ddq_o)
