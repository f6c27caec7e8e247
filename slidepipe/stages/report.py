"""Report: everything about an experiment's trials on one page that needs no network."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from slidepipe import __version__
from slidepipe.artifacts.durable import folder, whole
from slidepipe.artifacts.recording_reader import read_recording
from slidepipe.artifacts.schema import dump_model
from slidepipe.artifacts.store import Store
from slidepipe.figures.convergence import Chain, draw_convergence
from slidepipe.figures.joints import JointsPicture, draw_joints
from slidepipe.figures.report import Picture, ReportPage, render_report
from slidepipe.figures.sliding import sliding_sheet
from slidepipe.figures.tracking import tracking_sheet
from slidepipe.stages import report_words
from slidepipe.stages.goal import miss
from slidepipe.stages.pictures import TrialRuns, TrialView
from slidepipe.stages.report_scene import scene
from slidepipe.stages.report_trials import ReportTrial, Subject, find_subject
from slidepipe.stages.trial_facts import RECORDING, followed

MOST_SCENES = 12
"""Trials with an animation, the latest: each costs some 20 kB."""


@dataclass(frozen=True, slots=True)
class ReportRequest:
    """What the report is about, an experiment's name or a run, and where it is written."""

    reference: str
    path: Path
    store: Store


@dataclass(frozen=True, slots=True)
class ReportResult:
    """The page's path, and what was found for it."""

    path: Path
    subject: str
    trials: tuple[str, ...]
    warnings: tuple[str, ...]
    size: int


def run(request: ReportRequest) -> ReportResult:
    """Write the page, whole or not at all.

    Raises
    ------
    NotFoundError
        There is no such experiment or run, or no trial belongs to it.
    InputError
        The page cannot be written there.
    """
    subject = find_subject(request.store, request.reference)
    folder(request.path.parent)
    with whole(request.path) as draft:
        page = _page(subject)
        text = render_report(page)
        draft.write_text(text, encoding="utf-8")
    names = tuple(trial.trial_run.id for trial in subject.trials)
    return ReportResult(request.path, subject.name, names, page.warnings, len(text.encode()))


def _page(subject: Subject) -> ReportPage:
    last = subject.trials[-1]
    scenes = [scene(trial) for trial in subject.trials[-MOST_SCENES:]]
    finished = last.trial_run.manifest.times.finished
    return ReportPage(
        title=f"Report: {subject.name}",
        subtitle=f"{_counted(len(subject.trials), 'trial')}, the last of {finished[:16].replace('T', ' ')} UTC",
        warnings=report_words.warnings(subject),
        experiment=report_words.experiment_facts(last),
        experiment_yaml=dump_model(last.experiment),
        trials=report_words.trials_table(subject),
        convergence=_convergence(subject),
        scenes=tuple(one for one in scenes if one is not None),
        estimates=report_words.estimates_table(subject),
        notes=report_words.notes(subject),
        pictures=tuple(_pictures(subject)),
        provenance=report_words.provenance_table(subject),
        hashes=report_words.hashes_table(subject),
        made=f"Made by slidepipe {__version__} from the run store.",
    )


def _counted(count: int, word: str) -> str:
    return f"{count} {word}" if count == 1 else f"{count} {word}s"


def _convergence(subject: Subject) -> Picture | None:
    """Errors over the trials, where there is more than one to compare."""
    told = [trial for trial in subject.trials if trial.estimate is not None]
    if len(told) < 2:
        return None
    last = told[-1]
    tolerance = last.experiment.goal.tolerance
    by_chain: dict[str, list[ReportTrial]] = {}
    for trial in told:
        by_chain.setdefault(trial.chain, []).append(trial)
    true_mu = last.truth.friction if last.truth else None
    figure = draw_convergence(
        [_chain(name, trials) for name, trials in by_chain.items()],
        (tolerance.position_m, tolerance.angle_rad),
        true_mu,
    )
    caption = (
        "Distance and turn from the goal, and the friction estimate with its 95 % interval, over the trials of "
        f"{_counted(len(by_chain), 'chain')}. Shaded: within tolerance. Black: the believed "
        "friction" + (", orange: the true one of the last trial." if true_mu is not None else ".")
    )
    return Picture("Convergence", figure, caption)


def _chain(name: str, trials: Sequence[ReportTrial]) -> Chain:
    errors, frictions = [], []
    for trial in trials:
        told = trial.estimate
        left = miss(told.final_relative_pose, trial.experiment) if told and told.final_relative_pose else None
        errors.append((left.position_m, left.angle_rad) if left else (np.nan, np.nan))
        mu = told.friction.mu if told and told.friction else None
        frictions.append((mu.value, *mu.interval_95) if mu else (np.nan, np.nan, np.nan))
    error, friction = np.array(errors), np.array(frictions)
    return Chain(
        name=name,
        trial=np.array([float(trial.plan.trial) for trial in trials]),
        error_m=error[:, 0],
        error_rad=error[:, 1],
        mu=friction[:, 0],
        mu_low=friction[:, 1],
        mu_high=friction[:, 2],
        believed=np.array([trial.plan.believed.friction for trial in trials]),
    )


def _pictures(subject: Subject) -> list[Picture]:
    """How the finger slid and the arm followed, in the first and the last trial that were estimated."""
    told = [trial for trial in subject.trials if trial.estimate_run is not None]
    chosen = told if len(told) < 2 else [told[0], told[-1]]
    names = f"trial{'s' if len(chosen) > 1 else ''} {' and '.join(trial.name for trial in chosen)}"
    pictures = []
    if chosen:
        views = [TrialView(TrialRuns(*one.runs), one.experiment) for one in chosen]
        sliding, tracking = sliding_sheet([v.sliding() for v in views]), tracking_sheet([v.tracking() for v in views])
        pictures.append(Picture("The slide", sliding.figure, f"The finger in the body frame, {names}."))
        pictures.append(Picture("The hand", tracking.figure, f"The hand in the world plane, {names}."))
    last = subject.trials[-1]
    caption = (
        f"Command (dashed) and encoder of each joint, and the difference, trial {last.name}. Green: the planned slide."
    )
    pictures.append(Picture("The joints", draw_joints(_joints(last)), caption))
    return pictures


def _joints(trial: ReportTrial) -> JointsPicture:
    arm = followed(read_recording(trial.trial_run.file(RECORDING)))
    return JointsPicture(
        time_s=np.asarray(1e-9 * (arm.commanded.stamp_ns - trial.trial.started_ns), dtype=np.float64),
        commanded=arm.commanded.position_rad,
        measured=arm.measured.position_rad,
        slide_s=(trial.plan.slide.start_s, trial.plan.slide.stop_s),
    )
