"""What the trials of a campaign teach of the arm, and a plan whose torques know it."""

from collections.abc import Callable
from dataclasses import replace

from slidepipe.arm.identify import ArmCorrection, correct, identify
from slidepipe.arm.model import nominal_model
from slidepipe.artifacts import topics
from slidepipe.artifacts.arm_correction import ArmCorrectionDocument, Joints
from slidepipe.artifacts.experiment import Experiment
from slidepipe.artifacts.recording_reader import read_recording
from slidepipe.errors import InfeasibleError
from slidepipe.planning.limits import check_arm
from slidepipe.planning.planner import Plan
from slidepipe.series import FloatArray
from slidepipe.stages.past import PastTrial
from slidepipe.stages.translate import setup
from slidepipe.stages.trial_facts import RECORDING

TORQUE_SHARES = (1.0, 0.92, 0.84)
"""Shares of the joints' torque that a plan may use, in turn, to leave some for what the arm was found to need."""


def learn(past: tuple[PastTrial, ...], experiment: Experiment) -> ArmCorrection:
    """Identify the arm from every recording of the campaign."""
    model = nominal_model(setup(experiment, experiment.friction).tool)
    return identify(model, [read_recording(one.trial_run.file(RECORDING)).joints(topics.MEASURED) for one in past])


def corrected_plan(make: Callable[[Experiment], Plan], correction: ArmCorrection, experiment: Experiment) -> Plan:
    """Plan, then correct its torques; where the real arm would need more than a joint can give, plan for less.

    Raises
    ------
    InfeasibleError
        What ``make`` raises, or what the corrected torques break even so.
    """
    refusals = []
    for share in TORQUE_SHARES:
        try:
            return with_correction(make(_weaker(experiment, share)), correction, experiment)
        except InfeasibleError as refusal:
            refusals.append(refusal)
    raise refusals[0]


def _weaker(experiment: Experiment, share: float) -> Experiment:
    """The experiment with joints that may give only a share of their torque."""
    arm = experiment.arm
    torque = tuple(share * one for one in arm.limits.joint_torque_n_m)
    limits = arm.limits.model_copy(update={"joint_torque_n_m": torque})
    return experiment.model_copy(update={"arm": arm.model_copy(update={"limits": limits})})


def with_correction(plan: Plan, correction: ArmCorrection, experiment: Experiment) -> Plan:
    """Plan whose feedforward torques are the corrected arm's.

    Raises
    ------
    InfeasibleError
        The real arm would need more than a joint can give.
    """
    believed = setup(experiment, experiment.friction)
    load = correct(plan.load, nominal_model(believed.tool), plan.joints, correction)
    limits = check_arm(plan.joints, load, believed.limits)
    broken = [f"with the arm as it was learned: {check}" for check in limits if not check.satisfied]
    if broken:
        raise InfeasibleError(*broken)
    return replace(plan, load=load, limits=tuple(limits))


def correction_document(
    correction: ArmCorrection, past: tuple[PastTrial, ...], experiment: Experiment
) -> ArmCorrectionDocument:
    """Correction as an artifact."""
    std = correction.std.T
    return ArmCorrectionDocument(
        experiment=experiment.name,
        trials=tuple(one.trial_run.id for one in past),
        moving_mass=_joints(correction.moving_mass),
        moving_mass_std=_joints(std[0]),
        resting_mass=_joints(correction.resting_mass),
        resting_mass_std=_joints(std[1]),
        coulomb=_joints(correction.coulomb),
        coulomb_std=_joints(std[2]),
        viscous=_joints(correction.viscous),
        viscous_std=_joints(std[3]),
        torque_rms_n_m=_joints(correction.torque_rms_n_m),
        left_rms_n_m=_joints(correction.left_rms_n_m),
    )


def _joints(values: FloatArray) -> Joints:
    return tuple(float(value) for value in values)
