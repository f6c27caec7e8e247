"""A trial as a person reads it, with the truth beside it where the lab was simulated."""

from rich.console import RenderableType

from slidepipe.artifacts.run import Run
from slidepipe.artifacts.trial import StreamReport, TrialDocument, TruthDocument
from slidepipe.cli.views.tables import (
    NONE,
    angle_mrad,
    columns,
    facts,
    fixed,
    heading,
    length_mm,
    near,
    number,
    planar,
    share,
)


def trial_view(trial: TrialDocument, truth: TruthDocument | None, run: Run) -> list[RenderableType]:
    """Outcome, tracking error and frames, then what was true."""
    seed = "" if trial.seed is None else f", seed {trial.seed}"
    return [
        heading(f"trial {run.id}", f"{trial.lab} lab{seed}"),
        facts(_rows(trial)),
        *(_truth(truth) if truth is not None else ()),
        "",
        str(run.directory / "trial.yaml"),
    ]


def _rows(trial: TrialDocument) -> list[tuple[str, str]]:
    frames = trial.frames
    return [
        ("plan", trial.plan),
        ("outcome", trial.outcome),
        ("lasted", _lasted(trial)),
        ("tracking error", _tracking(trial)),
        ("frames", f"{frames.taken}, {_missing(trial)}, longest gap {fixed(1e3 * frames.longest_gap_s, 1)} ms"),
        *(_stream(trial.stream) if trial.stream is not None else ()),
        *((name, text) for name, text in (("stopped", trial.stopped), ("invalid", trial.invalid)) if text is not None),
    ]


def _lasted(trial: TrialDocument) -> str:
    lasted_s = 1e-9 * (trial.finished_ns - trial.started_ns)
    return f"{fixed(lasted_s, 3)} s" if lasted_s else "the motion did not begin"


def _stream(stream: StreamReport) -> list[tuple[str, str]]:
    p50, p99, top = (fixed(1e6 * late_s, 0) for late_s in (stream.late_p50_s, stream.late_p99_s, stream.late_max_s))
    lost = stream.states_lost + stream.frames_missing + stream.records_lost
    return [
        ("stream", f"{stream.ticks} ticks, late by {p50} us median, {p99} us in 99 %, {top} us at most"),
        ("messages lost", f"{lost}, longest gap between commands {fixed(1e3 * stream.longest_gap_s, 1)} ms"),
        *(("not permitted", line) for line in stream.not_permitted),
    ]


def _tracking(trial: TrialDocument) -> str:
    error = trial.tracking_error
    if error is None:
        return NONE
    rms = f"rms {length_mm(error.position_rms_m)} mm and {angle_mrad(error.angle_rms_rad)} mrad"
    return f"{rms}, peak {length_mm(error.position_peak_m)} mm and {angle_mrad(error.angle_peak_rad)} mrad"


def _missing(trial: TrialDocument) -> str:
    frames = trial.frames
    hand, thing = share(frames.hand_missing, frames.taken), share(frames.object_missing, frames.taken)
    return f"without the hand {hand}, without the object {thing}"


def _truth(truth: TruthDocument) -> list[RenderableType]:
    names = ("x mm", "y mm", "theta mrad")
    poses = columns("true pose of the finger on the object", *names, numbers=names)
    poses.add_row("before", *planar(truth.initial_relative_pose.vector))
    poses.add_row("after", *planar(near(truth.final_relative_pose.vector, truth.initial_relative_pose.vector)))
    known = truth.slide_start_s is not None and truth.slide_stop_s is not None
    slide = f"from {number(truth.slide_start_s)} s to {number(truth.slide_stop_s)} s" if known else "nothing slid"
    kappa = number(truth.kappa_m_s2, "m/s²")
    friction = f"mu {truth.friction:.4f}, kappa {kappa}, rho {length_mm(truth.rho_m)} mm"
    return ["", poses, "", facts([("true friction", friction), ("true slide", slide)])]
