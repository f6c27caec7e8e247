"""What the animation shows of one trial: poses as smoothed, and the friction that the object's acceleration tells."""

from typing import Any

import numpy as np
from scipy.signal import savgol_filter

from slidepipe.artifacts.recording_reader import read_recording
from slidepipe.figures.report import Scene
from slidepipe.figures.traces import near
from slidepipe.mechanics.dynamics import about_com
from slidepipe.mechanics.planar import relative_pose, rotation
from slidepipe.series import FloatArray
from slidepipe.stages.estimate import SMOOTHED, SMOOTHED_HAND, SMOOTHED_OBJECT
from slidepipe.stages.report_trials import ReportTrial
from slidepipe.stages.translate import block, setup

FRAMES_PER_S = 90.0
ROOM_S = 0.2
"""How much of the rests is shown."""
WINDOW_S = 0.03
"""Over so long a parabola is fitted to the smoothed velocity, to differentiate it."""


def measured_friction(
    trial: ReportTrial, q_o: FloatArray, dq_o: FloatArray, q_f: FloatArray, step_s: float
) -> FloatArray:
    """Friction wrench (T, 3) on the object about the contact, in {f}: eq. (17) solved for f.

    Parameters
    ----------
    trial : ReportTrial
    q_o, dq_o, q_f : (T, 3)
        Poses of object and finger and velocity of the object in {w}.
    step_s : float
        Between two samples.

    Returns
    -------
    (T, 3)
        N, N and N m.
    """
    thing = block(trial.experiment)
    window = max(5, 2 * round(0.5 * WINDOW_S / step_s) + 1)
    ddq_o = savgol_filter(dq_o, window, 2, deriv=1, delta=step_s, axis=0)
    in_body = np.einsum("tji,tj->ti", rotation(q_o[:, 2]), thing.M * ddq_o - thing.g)
    r_f_b = relative_pose(q_o, q_f)
    return np.asarray(np.einsum("tji,tj->ti", rotation(r_f_b[:, 2]), about_com(in_body, -r_f_b)))


def scene(trial: ReportTrial) -> Scene | None:
    """Make the animation of a trial; none where it was not estimated."""
    if trial.estimate_run is None or trial.estimate is None:
        return None
    smoothed = read_recording(trial.estimate_run.file(SMOOTHED))
    hand, body = smoothed.planar(SMOOTHED_HAND), smoothed.planar(SMOOTHED_OBJECT)
    time_s = 1e-9 * (body.stamp_ns - trial.trial.started_ns)
    step_s = float(np.median(np.diff(time_s)))
    mu = trial.estimate.friction.mu.value if trial.estimate.friction else trial.plan.believed.friction
    finger = setup(trial.experiment, mu).finger
    scale = np.array([1.0, 1.0, 1.0 / finger.a])
    friction = measured_friction(trial, body.pose, body.velocity, hand.pose, step_s) * scale
    stop_s = trial.plan.phases[-1].stop_s
    shown = np.flatnonzero((time_s > -ROOM_S) & (time_s < stop_s + ROOM_S))
    shown = shown[:: max(1, round(1.0 / (FRAMES_PER_S * step_s)))]
    relative = near(relative_pose(body.pose, hand.pose), np.array([trial.plan.start_relative_pose.vector]))
    found = trial.estimate.slide
    thing = trial.experiment.object
    return Scene(
        name=trial.name,
        time_s=_rounded(time_s[shown], 4),
        object=_rounded(body.pose[shown], 5),
        finger=_rounded(hand.pose[shown], 5),
        friction=_rounded(friction[shown], 4),
        relative=_rounded((relative * [1e3, 1e3, np.degrees(1.0)])[shown], 2),
        slide_s=(found.start_s, found.stop_s) if found else None,
        block_m=(thing.size_x_m, thing.size_y_m),
        semi_axes_n=_three(finger.semi_axes * scale),
    )


def _rounded(values: Any, digits: int) -> Any:
    """Array as nested lists of short numbers."""
    return np.round(values, digits).tolist()


def _three(values: FloatArray) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in values)
    return x, y, z
