"""One world of a sweep, tried out by the exact mechanics or by the whole loop in the simulated lab."""

import tempfile
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from slidepipe.artifacts.campaign import CampaignDocument
from slidepipe.artifacts.experiment import Experiment
from slidepipe.artifacts.overrides import apply_overrides
from slidepipe.artifacts.schema import parse
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.strict_yaml import YamlDocument, loads
from slidepipe.artifacts.sweep import SweepTrialDocument, SweepTry, WorldKind
from slidepipe.artifacts.values import Pose
from slidepipe.errors import RefusedError
from slidepipe.mechanics.hand_motion import HandMotion
from slidepipe.mechanics.limit_surface import SoftFinger
from slidepipe.mechanics.rounded_hand import rounded
from slidepipe.mechanics.simulate import Ended, simulate
from slidepipe.planning.course import CourseMotion
from slidepipe.stages import campaign
from slidepipe.stages.goal import error_of, within_tolerance
from slidepipe.stages.motions import first_plan
from slidepipe.stages.translate import block, scattered, vector


@dataclass(frozen=True, slots=True)
class World:
    """One world: its number, the number of its setting, and what is set over the experiment."""

    index: int
    setting: int
    overrides: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class SweepTask:
    """Worlds that one worker tries out: the experiment as text, so that a worker needs no file of ours."""

    text: str
    name: str
    kind: WorldKind
    worlds: tuple[World, ...]


def work_on(task: SweepTask) -> tuple[SweepTrialDocument, ...]:
    """Try out the worlds of a task, one after the other."""
    document = loads(task.text, task.name)
    attempt = _in_mechanics if task.kind == "mechanics" else _in_lab
    return tuple(attempt(task, document, world) for world in task.worlds)


def experiment_of(document: YamlDocument, world: World) -> Experiment:
    """Experiment of one world.

    Raises
    ------
    InputError
        What is set is wrong.
    """
    return parse(Experiment, apply_overrides(document, world.overrides))


def _in_mechanics(task: SweepTask, document: YamlDocument, world: World) -> SweepTrialDocument:
    """First motion by the exact simulation, with a hand that follows it exactly."""
    experiment = experiment_of(document, world)
    actual = scattered(experiment, 1)
    try:
        hand = _hand(_PlanKey.of(experiment))
    except RefusedError as refusal:
        return _document(task, world, experiment, outcome="no plan", why_ended="; ".join(refusal.lines))
    lab, grasp = actual.lab, experiment.grasp
    force_n = grasp.finger_count * lab.normal_force_per_finger_n
    finger = SoftFinger(lab.friction, force_n, grasp.contact_radius_m, grasp.torsion_constant)
    error = lab.grasp_error
    start = vector(experiment.start.relative_pose) + np.array([error.x_m, error.y_m, error.theta_rad])
    outcome = simulate(hand, block(experiment), finger, start)
    if outcome.ended is not Ended.STUCK:
        return _document(task, world, experiment, SweepTry(error=None), outcome="lost")
    reached = Pose.of(outcome.r_f_b)
    near = within_tolerance(reached, experiment)
    tried = SweepTry(error=error_of(reached, experiment))
    return _document(task, world, experiment, tried, outcome="converged" if near else "out of trials")


def _in_lab(task: SweepTask, document: YamlDocument, world: World) -> SweepTrialDocument:
    """Whole loop in the simulated lab; what it records is thrown away."""
    experiment = experiment_of(document, world)
    with tempfile.TemporaryDirectory(prefix="slidepipe-sweep-") as place:
        path = Path(place) / "experiment.yaml"
        path.write_text(task.text, encoding="utf-8")
        request = campaign.CampaignRequest(path, Store(Path(place) / "data"), _silent, world.overrides)
        try:
            table = campaign.play(request)
        except RefusedError as refusal:
            return _document(task, world, experiment, outcome="no plan", why_ended="; ".join(refusal.lines))
    tries = tries_of(table, experiment)
    return _document(task, world, experiment, *tries, outcome=table.outcome, why_ended=table.stopped_because)


def tries_of(table: CampaignDocument, experiment: Experiment) -> list[SweepTry]:
    """What each trial of a campaign truly left."""
    return [
        SweepTry(
            error=None if row.outcome == "lost" or true is None else error_of(true, experiment), said_worse=row.worse
        )
        for row in table.rows
        for true in (row.true_relative_pose,)
    ]


def _silent(_: str) -> None:
    """Say nothing."""


def _document(
    task: SweepTask, world: World, experiment: Experiment, *tries: SweepTry, outcome: str, why_ended: str | None = None
) -> SweepTrialDocument:
    return SweepTrialDocument.model_validate(
        {
            "experiment": experiment.name,
            "index": world.index,
            "setting": world.setting,
            "world": task.kind,
            "overrides": world.overrides,
            "outcome": outcome,
            "why_ended": why_ended,
            "trials": tries,
        }
    )


@dataclass(frozen=True, slots=True)
class _PlanKey:
    """Experiment without its world, on which the plan does not depend."""

    text: str
    experiment: Experiment

    @classmethod
    def of(cls, experiment: Experiment) -> "_PlanKey":
        return cls(experiment.model_dump_json(exclude={"lab"}), experiment)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _PlanKey) and self.text == other.text

    def __hash__(self) -> int:
        return hash(self.text)


@lru_cache(maxsize=16)
def _hand(key: _PlanKey) -> HandMotion:
    """Hand's motion of the experiment's first plan."""
    chosen = first_plan(key.experiment)
    return rounded(CourseMotion(chosen.course, chosen.setup.block, chosen.setup.fingers).hand_motion())
