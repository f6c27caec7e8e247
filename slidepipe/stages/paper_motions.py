"""Figs. 6 to 8 and 10 to 12: what was planned, executed and estimated."""

import numpy as np

from slidepipe.figures.friction_path import FrictionPanel, draw_friction_path
from slidepipe.figures.relative_profile import RelativePicture, draw_relative_profile
from slidepipe.figures.repeats import Repeat, RepeatsPicture, draw_repeats
from slidepipe.figures.sliding import sliding_sheet
from slidepipe.figures.traces import turned
from slidepipe.figures.tracking import tracking_sheet
from slidepipe.figures.trajectories import TrajectoryPanel, draw_trajectories
from slidepipe.mechanics.planar import rotation
from slidepipe.series import FloatArray
from slidepipe.stages.paper_repeats import PAPER_ERROR, PAPER_SD, RepeatError, repeat_error
from slidepipe.stages.paper_runs import FRICTION_SD, PaperRuns, Planned
from slidepipe.stages.paper_theory import Drawn
from slidepipe.stages.pictures import TrialView
from slidepipe.stages.translate import setup, vector

SECTION = {"paper_linear": "VIII-A", "paper_rotational": "VIII-B"}


def fig06(runs: PaperRuns) -> Drawn:
    """Fig. 6, of the slide of Section VIII-A."""
    planned = runs.linear
    slide, motion = planned.document.slide, planned.motion
    rate = float(np.linalg.norm(slide.relative_acceleration[:2]))
    time_s = motion.time_s
    into = np.clip(time_s - slide.start_s, 0.0, None)
    left = np.clip(slide.stop_s - time_s, 0.0, None)
    sign = np.where(time_s < slide.switch_s - 1e-9, 1.0, -1.0)
    acceleration = np.where((into > -1e-9) & (time_s >= slide.start_s - 1e-9) & (left > 1e-9), sign * rate, 0.0)
    distance = np.linalg.norm(motion.r_f_b[:, :2] - motion.r_f_b[0, :2], axis=1)
    edges = (0.0, slide.start_s, slide.switch_s, slide.stop_s, float(time_s[-1]))
    data = RelativePicture(time_s, distance, rate * np.minimum(into, left), acceleration, edges)
    a = slide.relative_acceleration
    caption = (
        f"Relative motion along the way from start to goal, of plan {planned.run.id} ({planned.experiment.name}): "
        f"{rate:.3g} m/s² for T2 = {slide.switch_s - slide.start_s:g} s, then its opposite for "
        f"T3 = {slide.stop_s - slide.switch_s:g} s, over {1e3 * distance[-1]:.1f} mm. In {{b}} that is "
        f"[{a[0]:g}, {a[1]:g}, {a[2]:g}], which is the paper's [2 m/s², 4 m/s², 0] of Section VIII-A."
    )
    return Drawn(draw_relative_profile(data), caption)


def fig07(runs: PaperRuns) -> Drawn:
    """Fig. 7, of both plans."""
    panels = [_friction(planned) for planned in (runs.linear, runs.rotational)]
    still, turning = (_spread_rad(panel) for panel in panels)
    caption = (
        "Friction forces and sliding velocities in {f} while it slides, "
        f"(a) of plan {runs.linear.run.id}, (b) of plan {runs.rotational.run.id}. In (a) the direction does not "
        "change: the path is a "
        f"point, as in the paper (it spreads by {still:.1g} rad). In (b) the velocity is constant in {{b}} and turns "
        "with "
        f"the finger in {{f}}: the force runs along a circle of latitude, over {np.degrees(turning):.1f}°. The paper's "
        "slide turns by 45° as well. $m_z$ is divided by $a$. The paper reads 1.25 N and 2.5 N as the force of one "
        f"finger, we as that of both: our ellipsoids are half as large, $μ f_N$ = {panels[0].semi_axes[0]:.3g} N and "
        f"{panels[1].semi_axes[0]:.3g} N."
    )
    return Drawn(draw_friction_path(panels), caption)


def fig08(runs: PaperRuns) -> Drawn:
    """Fig. 8, of both plans."""
    panels = [_trajectory(planned) for planned in (runs.linear, runs.rotational)]
    farthest = [float(np.max(np.linalg.norm(panel.q_f[:, :2], axis=1))) for panel in panels]
    slides = " and ".join(f"{panel.slide_s[0]:g} s to {panel.slide_s[1]:g} s" for panel in panels)
    caption = (
        f"Trajectories of (a, b) plan {runs.linear.run.id} and (c, d) plan {runs.rotational.run.id}, the slides "
        f"({slides}) in detail. Red dots are the finger's contact, brown lines its direction, the thin black arrows "
        "the object's acceleration, the thick ones its way. The durations are the paper's. The hand leaves the origin "
        f"by {farthest[0]:.2f} m and {farthest[1]:.2f} m and stays within the paper's circle of 1 m, read as its "
        "diameter. The "
        "paper leaves the velocity at the start of the slide to choice; ours is the one that ends with the hand at "
        "rest where the experiment file wants it, so that the paths differ from the printed ones."
    )
    return Drawn(draw_trajectories(panels), caption)


def fig10(runs: PaperRuns) -> Drawn:
    """Fig. 10, of the trial with the believed friction."""
    tried = runs.nominal
    panel = TrialView(tried.runs, tried.experiment).tracking()
    error = tried.trial.tracking_error
    told = (
        f"rms {1e3 * error.position_rms_m:.2f} mm and {1e3 * error.angle_rms_rad:.1f} mrad, at most "
        f"{1e3 * error.position_peak_m:.2f} mm and {1e3 * error.angle_peak_rad:.1f} mrad"
        if error
        else "not known"
    )
    caption = (
        f"The hand of the simulated WAM and its reference, trial {tried.runs.execute.id} of plan {tried.runs.plan.id}, "
        f"as the cameras saw it (estimate {tried.runs.estimate.id}); green: the slide. Error by the encoders: {told}. "
        "The paper prints no number and names the tracking error as a cause of its misses; our arm follows better, "
        "since "
        "its feedforward knows the arm's masses to 5 % and its joint friction to 20 %."
    )
    return Drawn(tracking_sheet([panel]).figure, caption)


def fig11(runs: PaperRuns) -> Drawn:
    """Fig. 11, of the trial with the believed friction."""
    tried = runs.nominal
    panel = TrialView(tried.runs, tried.experiment).sliding()
    reached = tried.estimate.final_relative_pose
    if reached is None:
        result = "The object was lost."
    else:
        miss = np.array(reached.vector) - vector(tried.experiment.goal.relative_pose)
        result = (
            f"It ends {1e3 * miss[0]:+.2f} mm, {1e3 * miss[1]:+.2f} mm and {1e3 * miss[2]:+.1f} mrad from the goal, "
            "where the "
            "paper's mean error is 10.3 mm, 11.2 mm and -160 mrad"
        )
    caption = (
        f"The finger in the body frame, trial {tried.runs.execute.id} (estimate {tried.runs.estimate.id}); green: the "
        f"slide as planned. {result}: in this trial the world's friction is what the planner believes, in the paper's "
        "nobody knew."
    )
    return Drawn(sliding_sheet([panel]).figure, caption)


def fig12(runs: PaperRuns) -> Drawn:
    """Fig. 12, of repeated trials of one plan."""
    experiment = runs.linear.experiment
    start, goal = vector(experiment.start.relative_pose), vector(experiment.goal.relative_pose)
    repeats = []
    for one in sorted(runs.repeats, key=lambda one: one.experiment.lab.friction):
        before, after = one.estimate.initial_relative_pose, one.estimate.final_relative_pose
        if before is not None and after is not None:
            repeats.append(Repeat(_near(before.vector, start), _near(after.vector, goal)))
    paper_end = goal - PAPER_ERROR
    figure = draw_repeats(RepeatsPicture(repeats, start, goal, paper_end, PAPER_SD))
    return Drawn(figure, _repeats_caption(runs, repeat_error(runs)))


def _repeats_caption(runs: PaperRuns, told: RepeatError) -> str:
    first, last = runs.repeats[0].runs.execute.id, runs.repeats[-1].runs.execute.id
    mean, sd = told.mean * [1e3, 1e3, 1e3], told.sd * [1e3, 1e3, 1e3]
    lost = f" {told.lost} lost the object and are not shown." if told.lost else ""
    return (
        f"{len(runs.repeats)} trials of plan {runs.linear.run.id} ({first} to {last}), in worlds whose friction is "
        "drawn "
        f"about the believed one with a standard deviation of {100 * FRICTION_SD:g} %.{lost} Triangles: start, "
        "circles: end, as "
        "estimated from the recordings; dark: least friction; red: as planned; grey plane: no relative rotation. "
        "Goal less end, mean ± s.d.: "
        f"x {mean[0]:.1f} ± {sd[0]:.1f} mm, y {mean[1]:.1f} ± {sd[1]:.1f} mm, θ {mean[2]:.0f} ± {sd[2]:.0f} mrad; in "
        "the paper "
        "10.3 ± 2.3 mm, 11.2 ± 4.0 mm, -160 ± 270 mrad (dashed, if its objects fell short). Friction alone spreads the "
        "ends along the slide; the paper's also miss across it, and turn."
    )


def _friction(planned: Planned) -> FrictionPanel:
    slide, motion = planned.document.slide, planned.motion
    finger = setup(planned.experiment, planned.document.believed.friction).finger
    step_s = float(motion.time_s[1])
    part = motion.during(slide.start_s + step_s, slide.stop_s - step_s)
    dv = np.einsum("tji,tj->ti", rotation(motion.r_f_b[part, 2]), motion.dr_f_b[part])
    scale = np.array([1.0, 1.0, 1.0 / finger.a])
    name = f"Section {SECTION[planned.experiment.name]}: $μ f_N$ = {finger.mu * finger.f_N:.3g} N"
    return FrictionPanel(name, finger.semi_axes * scale, finger.friction(dv) * scale, dv / scale)


def _spread_rad(panel: FrictionPanel) -> float:
    """How far the tangential force turns."""
    angle = np.unwrap(np.arctan2(panel.f[:, 1], panel.f[:, 0]))
    return float(np.ptp(angle))


def _trajectory(planned: Planned) -> TrajectoryPanel:
    slide, motion, thing = planned.document.slide, planned.motion, planned.experiment.object
    return TrajectoryPanel(
        title=f"Section {SECTION[planned.experiment.name]}",
        time_s=motion.time_s,
        q_o=motion.q_o,
        q_f=motion.q_f,
        ddq_o=motion.ddq_o,
        slide_s=(slide.start_s, slide.stop_s),
        block_size_m=np.array([thing.size_x_m, thing.size_y_m]),
    )


def _near(pose: tuple[float, float, float], reference: FloatArray) -> FloatArray:
    """Pose with its angle in the turn of the reference."""
    return np.asarray(turned(np.array([pose]), float(reference[2]) - pose[2])[0])
