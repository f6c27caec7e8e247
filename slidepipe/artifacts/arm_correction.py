"""What the trials taught of the arm: by which shares its masses and joint friction differ from the table."""

from typing import ClassVar

from slidepipe.artifacts.schema import Artifact
from slidepipe.artifacts.values import RunId, Slug

Joints = tuple[float, ...]


class ArmCorrectionDocument(Artifact):
    """What is written as ``arm.yaml``: shares of the nominal arm's numbers, one for each joint, with their stds.

    ``torque_rms_n_m`` is what the nominal arm did not explain of the torques in ``trials``, ``left_rms_n_m`` what the
    corrected one does not.
    """

    SCHEMA: ClassVar[str] = "slidepipe.arm_correction"

    experiment: Slug
    trials: tuple[RunId, ...]
    moving_mass: Joints
    moving_mass_std: Joints
    resting_mass: Joints
    resting_mass_std: Joints
    coulomb: Joints
    coulomb_std: Joints
    viscous: Joints
    viscous_std: Joints
    torque_rms_n_m: Joints
    left_rms_n_m: Joints
