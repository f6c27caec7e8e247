"""The tables of a report, and what it warns of."""

from collections.abc import Iterator

from slidepipe.artifacts.manifest import RunState
from slidepipe.artifacts.plan import PlanDocument
from slidepipe.artifacts.run import Run
from slidepipe.artifacts.schema import dump_model
from slidepipe.figures.report import Table
from slidepipe.stages.goal import Miss, miss, within_tolerance
from slidepipe.stages.report_trials import ReportTrial, Subject

NONE = "-"


def warnings(subject: Subject) -> tuple[str, ...]:
    """Everything that a reader should know before the numbers."""
    lines = list(subject.faults)
    for trial in subject.trials:
        lines += _about(trial)
    for run in _all_runs(subject):
        if run.manifest.state in (RunState.FAILED, RunState.INTERRUPTED):
            why = run.manifest.error.message.splitlines()[0] if run.manifest.error else "no error is recorded"
            lines.append(f"run {run.id} ({run.manifest.stage}) {run.manifest.state}: {why}")
    dirty = [run for run in _all_runs(subject) if run.manifest.code.dirty]
    if dirty:
        lines.append(f"{len(dirty)} of {len(_all_runs(subject))} runs were made by code that is in no commit")
    versions = {run.manifest.code.commit for run in _all_runs(subject)}
    if len(versions) > 1:
        lines.append(f"the runs were made by {len(versions)} different commits of the code")
    if len({dump_model(trial.experiment) for trial in subject.trials}) > 1:
        lines.append("the experiment file or what was set over it changed between these trials")
    return tuple(lines)


def _about(trial: ReportTrial) -> Iterator[str]:
    if trial.estimate is None:
        yield f"trial {trial.name} has no estimate: slidepipe estimate {trial.trial_run.id}"
    elif trial.estimate.lost is not None:
        yield f"trial {trial.name} lost the object: {trial.estimate.lost}"
    elif trial.estimate.friction is None:
        yield f"trial {trial.name} tells no friction: {trial.estimate.friction_missing_because}"
    for check in (*trial.plan.margins, *trial.plan.limits):
        if not check.satisfied:
            told = f"{check.name} {check.value:.3g} of {check.bound:.3g} {check.unit}"
            yield f"trial {trial.name} was planned beyond a limit: {told}"


def trials_table(subject: Subject) -> Table:
    """One row for each trial: what was planned, what was reached, and by how much it missed."""
    head = (
        "trial",
        "run",
        "outcome",
        "planned\nx, y mm; θ mrad",
        "reached, estimated\nx, y mm; θ mrad",
        "error\nmm",
        "error\nmrad",
        "true error\nmm",
        "believed\nμ",
        "estimated μ\n95 % interval",
        "true\nμ",
        "tracking\nrms mm",
    )
    return Table(head, tuple(_trial_row(one) for one in subject.trials), tuple(_mark(one) for one in subject.trials))


def _trial_row(trial: ReportTrial) -> tuple[str, ...]:
    told, truth = trial.estimate, trial.truth
    reached = told.final_relative_pose if told else None
    left = miss(reached, trial.experiment) if reached else None
    true = miss(truth.final_relative_pose, trial.experiment) if truth else None
    friction = told.friction if told else None
    tracking = trial.trial.tracking_error
    return (
        str(trial.plan.trial),
        trial.trial_run.id,
        "lost" if told is not None and told.lost is not None else trial.trial.outcome,
        _pose(trial.plan.goal_relative_pose.vector),
        _pose(reached.vector) if reached else NONE,
        *_missed(left),
        f"{1e3 * true.position_m:.2f}" if true and reached else NONE,
        f"{trial.plan.believed.friction:.4f}",
        f"{friction.mu.value:.4f} [{friction.mu.interval_95[0]:.4f}, {friction.mu.interval_95[1]:.4f}]"
        if friction
        else NONE,
        f"{truth.friction:.4f}" if truth else NONE,
        f"{1e3 * tracking.position_rms_m:.2f}" if tracking else NONE,
    )


def _mark(trial: ReportTrial) -> str:
    told = trial.estimate
    if told is None:
        return ""
    if told.final_relative_pose is None:
        return "lost"
    return "met" if within_tolerance(told.final_relative_pose, trial.experiment) else ""


def _missed(left: Miss | None) -> tuple[str, str]:
    return (f"{1e3 * left.position_m:.2f}", f"{1e3 * left.angle_rad:.1f}") if left else (NONE, NONE)


def _pose(vector: tuple[float, float, float]) -> str:
    return f"{1e3 * vector[0]:.2f}, {1e3 * vector[1]:.2f}; {1e3 * vector[2]:.1f}"


def estimates_table(subject: Subject) -> Table:
    """One row for each estimate, every value with its uncertainty."""
    head = (
        "trial",
        "estimate",
        "before\nx, y mm; θ mrad",
        "after\nx, y mm; θ mrad",
        "slide\ns",
        "κ = μ f_N / m\nm/s²",
        "95 % interval\nm/s²",
        "μ, if f_N and m are right\n95 % interval",
        "frames",
    )
    rows = []
    for trial in subject.trials:
        told = trial.estimate
        if told is None or trial.estimate_run is None:
            continue
        poses = (told.initial_relative_pose, told.final_relative_pose)
        seen = [
            f"{1e3 * one.x_m:.2f} ± {1e3 * one.x_std_m:.2f}, {1e3 * one.y_m:.2f} ± {1e3 * one.y_std_m:.2f}; "
            f"{1e3 * one.theta_rad:.1f} ± {1e3 * one.theta_std_rad:.1f}"
            if one
            else NONE
            for one in poses
        ]
        slide = f"{told.slide.start_s:.3f} to {told.slide.stop_s:.3f}" if told.slide else NONE
        rows.append(
            (str(trial.plan.trial), trial.estimate_run.id, *seen, slide, *_friction(trial), str(told.frames_used))
        )
    return Table(head, tuple(rows))


def _friction(trial: ReportTrial) -> tuple[str, str, str]:
    told = trial.estimate.friction if trial.estimate else None
    if told is None:
        return NONE, NONE, NONE
    kappa, mu = told.kappa_m_s2, told.mu
    return (
        f"{kappa.value:.3f} ± {kappa.std:.3f}",
        f"[{kappa.interval_95[0]:.3f}, {kappa.interval_95[1]:.3f}]",
        f"{mu.value:.4f} [{mu.interval_95[0]:.4f}, {mu.interval_95[1]:.4f}]",
    )


def notes(subject: Subject) -> tuple[str, ...]:
    """What the estimates say beside their numbers, each note once."""
    told = [note for trial in subject.trials if trial.estimate for note in trial.estimate.notes]
    return tuple(dict.fromkeys(told))


def experiment_facts(trial: ReportTrial) -> tuple[tuple[str, str], ...]:
    """The experiment in a few lines."""
    one, thing = trial.experiment, trial.experiment.object
    sides = " × ".join(f"{1e3 * side:g}" for side in (thing.size_x_m, thing.size_y_m, thing.thickness_m))
    start, goal = one.start.relative_pose.vector, one.goal.relative_pose.vector
    return (
        ("object", f"{sides} mm, {1e3 * thing.mass_kg:g} g"),
        ("grasp", f"{one.grasp.finger_count} fingers, {one.grasp.normal_force_per_finger_n:g} N each"),
        ("contact", f"radius {1e3 * one.grasp.contact_radius_m:g} mm, c = {one.grasp.torsion_constant:g}"),
        ("believed friction", f"μ = {one.friction:g}, κ = {one.kappa_m_s2:.3g} m/s²"),
        ("start (mm, mrad)", _pose(start)),
        ("goal (mm, mrad)", _pose(goal)),
        ("tolerance", f"{1e3 * one.goal.tolerance.position_m:g} mm, {1e3 * one.goal.tolerance.angle_rad:g} mrad"),
        ("phases", _phases(trial.plan)),
        ("lab", f"{trial.trial.lab}, seed {one.lab.seed}, arm followed by {one.lab.tracker.kind}"),
        ("iteration", f"at most {one.iteration.max_trials} trials, next plan: {one.iteration.way}"),
    )


def _phases(plan: PlanDocument) -> str:
    """How long each phase of a plan lasts, and what it was chosen for."""
    lasting = ", ".join(f"{one.name} {one.stop_s - one.start_s:.3g} s" for one in plan.phases)
    return f"{lasting} ({plan.objective})" if plan.objective else lasting


def provenance_table(subject: Subject) -> Table:
    """One row for each run."""
    head = ("run", "stage", "state", "finished (UTC)", "code", "recipe", "made from")
    rows = []
    for run in _all_runs(subject):
        told = run.manifest
        code = f"{told.code.version} {(told.code.commit or 'no commit')[:10]}{' dirty' if told.code.dirty else ''}"
        made_from = ", ".join(dict.fromkeys(one.run or one.file for one in told.inputs)) or NONE
        rows.append((run.id, told.stage, str(told.state), told.times.finished[:19], code, told.recipe[:12], made_from))
    return Table(head, tuple(rows))


def hashes_table(subject: Subject) -> Table:
    """One row for each file that went in from outside or came out."""
    rows = []
    for run in _all_runs(subject):
        outside = [one for one in run.manifest.inputs if one.run is None]
        rows += [(run.id, f"in: {one.file}", str(one.size), one.sha256) for one in outside]
        rows += [(run.id, one.file, str(one.size), one.sha256) for one in run.manifest.outputs]
    return Table(("run", "file", "bytes", "sha256"), tuple(rows))


def _all_runs(subject: Subject) -> tuple[Run, ...]:
    """Every run on the page, each once, in the order in which they were finished."""
    runs = {run.id: run for trial in subject.trials for run in trial.runs}
    runs.update({run.id: run for run in subject.others})
    return tuple(sorted(runs.values(), key=lambda run: run.manifest.times.finished))
