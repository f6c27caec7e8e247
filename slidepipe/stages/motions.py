"""From an experiment to its plan: the times that it gives, or the motion that the planner finds by itself."""

from dataclasses import replace

import numpy as np

from slidepipe.artifacts.experiment import Experiment
from slidepipe.artifacts.values import Pose
from slidepipe.planning.automatic import find_plan, plan_automatically
from slidepipe.planning.planner import Plan, plan
from slidepipe.planning.replan import FrictionInterval, replan
from slidepipe.planning.search import Task, scaled
from slidepipe.planning.wish import WEIGHTS, Objective, Weights, Wish
from slidepipe.series import FloatArray
from slidepipe.stages.translate import first_regrasp, setup, vector

LESS_DOUBT = (0.5, 0.0)
"""Shares of the friction's doubt that a later plan is to survive where no motion survives all of it."""
PART_WAY = (0.7, 0.4)
"""Shares of the way to the goal that a later plan may go where no motion goes all of it."""


def first_plan(experiment: Experiment) -> Plan:
    """The plan of an experiment's first trial.

    Raises
    ------
    InfeasibleError
        A limit is broken, or no motion keeps all of them.
    """
    believed = setup(experiment, experiment.friction)
    if experiment.motion.chosen_by_planner:
        return plan_automatically(task(experiment), believed, wish(experiment))
    return plan(first_regrasp(experiment), believed)


def next_plan(experiment: Experiment, r_now: FloatArray, friction: float, interval: FrictionInterval | None) -> Plan:
    """The plan of a later trial, from where the last one ended and what is now believed.

    The planner's own motion must survive what is left of the friction's interval, no more: a short slide cannot survive
    as much as a long one. Where none does, the object may also start at another angle, for the hand moves to its start
    anyway; then the motion need survive less; then it may go part of the way, for a further trial to go on.

    Raises
    ------
    InfeasibleError
        The remaining error cannot be corrected within the limits.
    """
    believed = setup(experiment, friction)
    if not experiment.motion.chosen_by_planner:
        return replan(first_regrasp(experiment), r_now, believed, interval)
    asked = wish(experiment)
    if interval is not None:
        doubt = max(friction - interval.low, interval.high - friction) / friction
        asked = replace(asked, friction_error=min(asked.friction_error, doubt))
    from_here = replace(task(experiment), r_start=np.asarray(r_now, dtype=float))
    turned = replace(asked, angle_free=True)
    eased = [replace(turned, friction_error=share * asked.friction_error) for share in LESS_DOUBT]
    whole = [(from_here, wanted) for wanted in (asked, turned, *eased)]
    partly = [(scaled(from_here, share), eased[-1]) for share in PART_WAY]
    for towards, wanted in (*whole, *partly):
        found = find_plan(towards, believed, wanted)
        if found is not None:
            return found
    return plan_automatically(from_here, believed, asked)  # says why there is none


def task(experiment: Experiment) -> Task:
    """What an experiment asks of a planner that finds the motion by itself."""
    goal = experiment.goal
    return Task(
        q_o_start=vector(experiment.start.object_pose),
        r_start=vector(experiment.start.relative_pose),
        r_goal=vector(goal.relative_pose),
        q_f_end=None if goal.hand_pose is None else vector(goal.hand_pose),
    )


def wish(experiment: Experiment) -> Wish:
    """What an experiment wishes of the motion."""
    motion, believed = experiment.motion, experiment.grasp.normal_force_per_finger_n
    low, high = motion.free.normal_force_per_finger_n or (believed, believed)
    return Wish(
        weights=_weights(experiment),
        friction_error=motion.friction_error,
        turn_rad=motion.turn_rad,
        angle_free=motion.free.object_angle,
        force_range=(low / believed, high / believed),
    )


def objective_words(experiment: Experiment) -> str:
    """What the motion was chosen for."""
    motion = experiment.motion
    if not motion.chosen_by_planner:
        return "given times"
    if motion.objective is not None:
        return motion.objective
    weights = _weights(experiment)
    names = ("time", "hand_acceleration", "friction_error")
    return ", ".join(f"{name} {getattr(weights, name):g}" for name in names if getattr(weights, name) > 0.0)


def resolved(experiment: Experiment, chosen: Plan) -> Experiment:
    """The experiment with what the planner chose in it: the object's angle at the start, and the grip force.

    The simulated world's grip is as much off the chosen force as it was off the believed one.
    """
    pose = Pose.of(chosen.course.q_o_start)
    per_finger = chosen.setup.finger.f_N / experiment.grasp.finger_count
    ratio = per_finger / experiment.grasp.normal_force_per_finger_n
    if pose == experiment.start.object_pose and np.isclose(ratio, 1.0, rtol=1e-9):
        return experiment
    true = experiment.lab.normal_force_per_finger_n * ratio
    return experiment.model_copy(
        update={
            "start": experiment.start.model_copy(update={"object_pose": pose}),
            "grasp": experiment.grasp.model_copy(update={"normal_force_per_finger_n": per_finger}),
            "lab": experiment.lab.model_copy(update={"normal_force_per_finger_n": true}),
        }
    )


def _weights(experiment: Experiment) -> Weights:
    motion = experiment.motion
    if motion.objective is not None:
        return WEIGHTS[Objective(motion.objective)]
    given = motion.weights
    if given is None:
        return WEIGHTS[Objective.ROBUST]
    return Weights(given.time, given.hand_acceleration, given.friction_error)
