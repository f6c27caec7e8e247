"""A calibration with numbers that a test can look for."""

from cli.samples import TRIAL
from slidepipe.artifacts.calibration import CalibrationDocument, Placement, Tilt

CALIBRATION = "20261124T093200Z-ca7brat0"


def calibration(*, tilt: bool = True) -> CalibrationDocument:
    return CalibrationDocument(
        trial=TRIAL,
        experiment="regrasp",
        cameras_in_base=Placement(
            position_m=(1.19976, -0.39995, 0.3), position_std_m=(0.00418, 9e-5, 1.2e-4),
            rotation_rad=(1.2, -0.7, 2.0), rotation_std_rad=(1e-4, 2e-4, 2e-4),
        ),
        hand_markers=Placement(
            position_m=(0.01197, -0.02003, 0.0297), position_std_m=(2e-5, 3e-5, 0.00418),
            rotation_rad=(0.3, -0.2, 0.8), rotation_std_rad=(1e-4, 2e-4, 2e-4),
        ),
        object_tilt=Tilt(rotation_rad=(-0.0164, -0.0117, 0.0), std_rad=(3e-4, 2e-4, 0.0)) if tilt else None,
        heading_rad=1.5709,
        lean_rad=-0.0013,
        plane_std_rad=0.0003,
        down_in_cameras=(-0.8991, 0.0957, -0.4271),
        down_std_rad=2e-4,
        joints_late_s=-2.4e-5,
        joints_late_std_s=1.3e-5,
        turn_rad=2.742,
        rms_m=0.0003,
        rms_rad=0.003,
        frames=598,
        outliers=1,
        notes=("the base is taken to stand level",),
    )  # fmt: skip
