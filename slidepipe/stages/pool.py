"""Pool: what several trials of one experiment tell together."""

from dataclasses import dataclass, replace

import numpy as np

from slidepipe.artifacts.draft import Draft
from slidepipe.artifacts.estimate import Assumed, Derived, EstimateDocument, Measured
from slidepipe.artifacts.experiment import Experiment
from slidepipe.artifacts.manifest import InputRef
from slidepipe.artifacts.plan import PlanDocument
from slidepipe.artifacts.pooled import PooledDocument, PooledTrial, PooledValue, Repeatability
from slidepipe.artifacts.recording_reader import read_recording
from slidepipe.artifacts.run import Run
from slidepipe.artifacts.schema import dump_model, parse
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.strict_yaml import load
from slidepipe.artifacts.values import Pose
from slidepipe.errors import EstimationError, InputError
from slidepipe.estimation.pooled import BETWEEN_SCALE, Pooled, pool, standing_out
from slidepipe.figures.repeatability import draw_repeatability
from slidepipe.series import FloatArray
from slidepipe.stages import estimate
from slidepipe.stages.pool_picture import pool_picture
from slidepipe.stages.translate import vector
from slidepipe.stages.trial_source import TrialSource, purpose_of, trial_source

STAGE, STAGE_VERSION = "pool", 2
POOLED, PICTURE = "pooled", "repeatability"
"""Roles of its files."""
PICTURE_FILE = "repeatability.png"


@dataclass(frozen=True, slots=True)
class PoolRequest:
    """Which trials to pool, each a run or a recording.

    ``force`` estimates and pools them again, ``figure`` draws each estimate; the rest is for all of them.
    """

    trials: tuple[str, ...]
    store: Store
    force: bool = False
    figure: bool = False
    calibration: str | None = None
    overrides: tuple[str, ...] = ()
    command: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class PoolResult:
    """The pooled run and document, and each trial's estimate: None where its recording did not tell."""

    run: Run
    document: PooledDocument
    estimates: tuple[estimate.EstimateResult | None, ...]
    reused: bool


def run(request: PoolRequest) -> PoolResult:
    """Estimate every trial, and pool what they tell.

    Raises
    ------
    NotFoundError
        There is no such trial.
    InputError
        A recording is damaged, a trial is named twice, or the trials are of more than one experiment.
    EstimationError
        No trial tells anything.
    """
    recorded = [_recorded(source, request.overrides) for source in _distinct(request)]
    experiment = _one_experiment(recorded)
    trials = [_estimated(one, request) for one in recorded]
    draft = request.store.draft(
        stage=STAGE,
        stage_version=STAGE_VERSION,
        experiment=experiment.name,
        parameters={"between_scale": BETWEEN_SCALE},
        inputs=_inputs(trials),
        command=request.command,
    )
    results = tuple(trial.result for trial in trials)
    known = None if request.force else request.store.find_recipe(draft.recipe)
    if known is not None:
        return PoolResult(known, parse(PooledDocument, load(known.file(POOLED))), results, reused=True)
    if not any(results):
        raise EstimationError(*(f"{trial.source.trial}: {trial.reason}" for trial in trials))
    with draft:
        document = _document(trials, experiment)
        _write(draft, document, experiment)
    return PoolResult(draft.run, document, results, reused=False)


@dataclass(frozen=True, slots=True)
class _Trial:
    """A trial, what it was recorded for, and its estimate or why there is none."""

    source: TrialSource
    experiment: Experiment
    plan: PlanDocument
    result: estimate.EstimateResult | None
    reason: str | None

    @property
    def told(self) -> EstimateDocument | None:
        return None if self.result is None else self.result.document

    @property
    def kappa(self) -> Measured | None:
        return self.told.friction.kappa_m_s2 if self.told and self.told.friction else None

    @property
    def rho(self) -> Measured | None:
        return self.told.friction.rho_m if self.told and self.told.friction else None

    @property
    def error(self) -> FloatArray | None:
        """Final minus planned relative pose, the turn within pi."""
        if self.told is None or self.told.final_relative_pose is None:
            return None
        away = np.array(self.told.final_relative_pose.vector) - vector(self.plan.goal_relative_pose)
        away[2] = np.arctan2(np.sin(away[2]), np.cos(away[2]))
        return np.asarray(away)


def _distinct(request: PoolRequest) -> list[TrialSource]:
    sources = [trial_source(trial, request.store) for trial in request.trials]
    for index, source in enumerate(sources):
        if source.input.sha256 in {other.input.sha256 for other in sources[:index]}:
            raise InputError(f"{request.trials[index]}: trial {source.trial} is named twice, each counts once")
    return sources


def _recorded(source: TrialSource, overrides: tuple[str, ...]) -> _Trial:
    purpose = purpose_of(read_recording(source.path), overrides)
    return _Trial(source, purpose.experiment, purpose.plan, None, None)


def _one_experiment(trials: list[_Trial]) -> Experiment:
    """Return the experiment of all trials: of one name, object and grasp, or their values would not be of one thing."""
    first = trials[0].experiment
    for trial in trials[1:]:
        for name in ("name", "object", "grasp"):
            if getattr(trial.experiment, name) != getattr(first, name):
                raise InputError(
                    f"{trial.source.trial}: is a trial of another experiment than {trials[0].source.trial}, "
                    f"its {name} differs: only trials of one experiment can be pooled"
                )
    return first


def _estimated(trial: _Trial, request: PoolRequest) -> _Trial:
    name = str(trial.source.path) if trial.source.input.run is None else trial.source.trial
    asked = estimate.EstimateRequest(
        name,
        request.store,
        force=request.force,
        figure=request.figure,
        calibration=request.calibration,
        overrides=request.overrides,
        command=request.command,
    )
    try:
        return replace(trial, result=estimate.run(asked))
    except EstimationError as refusal:
        return replace(trial, reason="; ".join(refusal.lines))


def _inputs(trials: list[_Trial]) -> tuple[InputRef, ...]:
    recordings = [trial.source.input for trial in trials]
    estimates = [trial.result.run.input(estimate.ESTIMATE) for trial in trials if trial.result is not None]
    return tuple(recordings + estimates)


def _document(trials: list[_Trial], experiment: Experiment) -> PooledDocument:
    kappa = _together({trial.source.trial: trial.kappa for trial in trials})
    rho = _together({trial.source.trial: trial.rho for trial in trials})
    pooled, count = kappa.pooled, len(kappa.trials)
    ended = [trial for trial in trials if trial.error is not None]
    errors = np.array([trial.error for trial in ended]).reshape(-1, 3)
    astray = {trial.source.trial for trial, out in zip(ended, standing_out(errors), strict=True) if out}
    per_kappa = experiment.object.mass_kg / experiment.grasp.normal_force_n
    return PooledDocument(
        experiment=experiment.name,
        trials=tuple(_row(trial, kappa, rho, astray) for trial in trials),
        kappa_m_s2=None if pooled is None else _value(pooled, count),
        mu=None
        if pooled is None
        else Derived(
            value=pooled.mean * per_kappa,
            interval_95=(pooled.interval_95[0] * per_kappa, pooled.interval_95[1] * per_kappa),
        ),
        assumed=Assumed(
            normal_force_n=experiment.grasp.normal_force_n,
            mass_kg=experiment.object.mass_kg,
            rho_m=experiment.grasp.rho_m,
        ),
        between_scale=BETWEEN_SCALE,
        repeatability=_repeatability(errors),
        notes=_notes(trials, count),
        picture=PICTURE_FILE if len(errors) else None,
        rho_m=None if rho.pooled is None else _value(rho.pooled, len(rho.trials)),
    )


@dataclass(frozen=True, slots=True)
class _Together:
    """One quantity of the trials that tell it, pooled; None where none does."""

    trials: tuple[str, ...]
    pooled: Pooled | None

    def surprise_p(self, trial: str) -> float | None:
        if self.pooled is None or trial not in self.trials:
            return None
        return float(self.pooled.surprise_p[self.trials.index(trial)])

    def outlying(self, trial: str) -> bool:
        return self.pooled is not None and trial in self.trials and bool(self.pooled.outlying[self.trials.index(trial)])


def _together(measured: dict[str, Measured | None]) -> _Together:
    told = {trial: one for trial, one in measured.items() if one is not None}
    values, stds = (np.array([getattr(one, name) for one in told.values()]) for name in ("value", "std"))
    return _Together(tuple(told), pool(values, stds) if told else None)


def _row(trial: _Trial, kappa: _Together, rho: _Together, astray: set[str]) -> PooledTrial:
    told, name = trial.told, trial.source.trial
    return PooledTrial(
        trial=name,
        estimate=None if trial.result is None else trial.result.run.id,
        start_relative_pose=trial.plan.start_relative_pose,
        goal_relative_pose=trial.plan.goal_relative_pose,
        initial_relative_pose=told.initial_relative_pose if told else None,
        final_relative_pose=told.final_relative_pose if told else None,
        error=None if trial.error is None else Pose.of(trial.error),
        error_outlying=name in astray,
        kappa_m_s2=trial.kappa,
        kappa_surprise_p=kappa.surprise_p(name),
        kappa_outlying=kappa.outlying(name),
        left_out_because=_left_out(trial),
        rho_m=trial.rho,
        rho_surprise_p=rho.surprise_p(name),
        rho_outlying=rho.outlying(name),
    )


def _left_out(trial: _Trial) -> tuple[str, ...]:
    told = trial.told
    if told is None:
        return (trial.reason or "not estimated",)
    return tuple(reason for reason in (told.lost, told.friction_missing_because) if reason is not None)


def _value(pooled: Pooled, count: int) -> PooledValue:
    names = [name for name in PooledValue.model_fields if name not in {"trials", "value"}]
    return PooledValue(trials=count, value=pooled.mean, **{name: getattr(pooled, name) for name in names})


def _repeatability(errors: FloatArray) -> Repeatability | None:
    if not len(errors):
        return None
    std = Pose.of(errors.std(axis=0, ddof=1)) if len(errors) > 1 else None
    return Repeatability(trials=len(errors), mean_error=Pose.of(errors.mean(axis=0)), std_error=std)


def _notes(trials: list[_Trial], told: int) -> tuple[str, ...]:
    notes = []
    plans = {(trial.plan.start_relative_pose, trial.plan.goal_relative_pose) for trial in trials}
    if len(plans) > 1:
        notes.append(
            f"the trials followed {len(plans)} different plans: their final errors are each from its own goal, and "
            "their spread is not that of one motion repeated"
        )
    if told in {1, 2}:
        notes.append(
            f"{'one trial tells' if told == 1 else 'two trials tell'} little of the spread between trials: "
            f"its interval rests on the assumption that they usually lie about {100 * BETWEEN_SCALE:g} % apart"
        )
    return tuple(notes)


def _write(draft: Draft, document: PooledDocument, experiment: Experiment) -> None:
    draft.add(POOLED, "pooled.yaml").write_text(dump_model(document), encoding="utf-8")
    if document.picture is not None:
        draw_repeatability(pool_picture(document, experiment), draft.add(PICTURE, document.picture))
    draft.report("trials", len(document.trials), unit="1")
    if document.kappa_m_s2 is not None:
        draft.report("kappa", document.kappa_m_s2.value, std=document.kappa_m_s2.std, unit="m/s^2")
        draft.report("kappa_between_trials", document.kappa_m_s2.between_std, unit="m/s^2")
    if document.rho_m is not None:
        draft.report("rho", document.rho_m.value, std=document.rho_m.std, unit="m")
