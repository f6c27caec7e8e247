"""Before anything moves: a plan's reference beside the limits of the lab that shall follow it."""

import numpy as np

from slidepipe.arm.dynamics import elbow_speed
from slidepipe.arm.model import nominal_model
from slidepipe.artifacts.experiment import Experiment
from slidepipe.artifacts.lab import LabDocument
from slidepipe.errors import InfeasibleError, InputError
from slidepipe.planning.limits import Check, worst
from slidepipe.series import FloatArray, JointSeries
from slidepipe.stages.translate import setup
from slidepipe.tick import TICK_S

STEP_MARGIN = 1.5
"""A reference may go so much farther in a tick than the speed limit allows, for it is rounded."""


def preflight(reference: JointSeries, lab: LabDocument, experiment: Experiment) -> tuple[Check, ...]:
    """Check a reference against a lab: ranges, speeds, steps, the clip of its transport, and the elbow's speed.

    Returns
    -------
    tuple of Check
        The elbow's speed and the torque nearest to the clip first.

    Raises
    ------
    InfeasibleError
        A limit is broken: one line for each, with its value, its bound and the time.
    InputError
        The reference is not one of seven joints, or holds a number that is not finite.
    """
    _refuse_nonsense(reference)
    checks = sorted(_checks(reference, lab, experiment), key=lambda check: check.value / check.bound, reverse=True)
    broken = [f"lab {lab.name}: {check}" for check in checks if not check.satisfied]
    if broken:
        raise InfeasibleError(*broken)
    return tuple(checks)


def _refuse_nonsense(reference: JointSeries) -> None:
    for name in ("position_rad", "velocity_rad_s", "effort_n_m"):
        values = getattr(reference, name)
        if values.ndim != 2 or values.shape[1] != 7 or not np.isfinite(values).all():
            raise InputError(f"reference: {name} must be finite numbers for seven joints, got shape {values.shape}")


def _checks(reference: JointSeries, lab: LabDocument, experiment: Experiment) -> list[Check]:
    limits, q = lab.arm.limits, reference.position_rad
    time_s = np.arange(len(q), dtype=np.float64) * TICK_S
    lower, upper = np.array(limits.joint_lower_rad), np.array(limits.joint_upper_rad)
    speeds = np.array(limits.joint_speed_rad_s)
    steps = np.abs(np.diff(q, axis=0, append=q[-1:]))
    clip = f"torque beyond gravity (clip of the {lab.arm.dialect} transport)"
    checks = [
        check
        for what, values, bounds, unit in (
            ("from the middle of its range", np.abs(q - (upper + lower) / 2), (upper - lower) / 2, "rad"),
            ("speed", np.abs(reference.velocity_rad_s), speeds, "rad/s"),
            ("step", steps, STEP_MARGIN * speeds * TICK_S, "rad"),
            (clip, np.abs(reference.effort_n_m), np.array(limits.torque_beyond_gravity_n_m), "N m"),
        )
        for check in _each_joint(what, time_s, values, (bounds, unit))
    ]
    model = nominal_model(setup(experiment, experiment.friction).tool)
    elbow = elbow_speed(model, q, reference.velocity_rad_s)
    return [*checks, worst("elbow speed", time_s, elbow, limits.elbow_speed_m_s, "m/s")]


def _each_joint(what: str, time_s: FloatArray, values: FloatArray, bound: tuple[FloatArray, str]) -> list[Check]:
    bounds, unit = bound
    return [
        worst(f"joint {joint + 1} {what}", time_s, values[:, joint], float(bounds[joint]), unit)
        for joint in range(values.shape[1])
    ]
