"""What the trials of a campaign teach of the arm, and a plan whose torques know it."""

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


def learn(past: tuple[PastTrial, ...], experiment: Experiment) -> ArmCorrection:
    """Identify the arm from every recording of the campaign."""
    model = nominal_model(setup(experiment, experiment.friction).tool)
    return identify(model, [read_recording(one.trial_run.file(RECORDING)).joints(topics.MEASURED) for one in past])


def with_correction(plan: Plan, correction: ArmCorrection, experiment: Experiment) -> Plan:
    """Plan whose feedforward torques are the corrected arm's.

    Raises
    ------
    InfeasibleError
        The real arm would need more than a joint can give.
    """
    load = correct(plan.load, plan.joints, correction)
    limits = check_arm(plan.joints, load, setup(experiment, experiment.friction).limits)
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
