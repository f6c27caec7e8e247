"""A stored calibration as the estimators take it."""

import numpy as np

from slidepipe.artifacts.calibration import CalibrationDocument, Placement
from slidepipe.artifacts.run import Run
from slidepipe.artifacts.schema import parse
from slidepipe.artifacts.strict_yaml import load
from slidepipe.estimation import calibration as estimation
from slidepipe.estimation.calibration import Calibration

CALIBRATION = "calibration"
"""Role of a calibration's file."""


def read_calibration(run: Run) -> Calibration:
    """Read the calibration that a run made.

    Raises
    ------
    NotFoundError
        The run holds none.
    """
    told = parse(CalibrationDocument, load(run.file(CALIBRATION)))
    tilt = told.object_tilt
    return Calibration(
        cameras_in_base=_placement(told.cameras_in_base),
        hand_markers=_placement(told.hand_markers),
        object_tilt_rad=None if tilt is None else np.array(tilt.rotation_rad),
        object_tilt_std_rad=None if tilt is None else np.array(tilt.std_rad),
        heading_rad=told.heading_rad,
        lean_rad=told.lean_rad,
        plane_std_rad=told.plane_std_rad,
        down_in_cameras=np.array(told.down_in_cameras),
        down_std_rad=told.down_std_rad,
        delay_s=told.joints_late_s,
        delay_std_s=told.joints_late_std_s,
        turn_rad=told.turn_rad,
        rms_m=told.rms_m,
        rms_rad=told.rms_rad,
        frames=told.frames,
        outliers=told.outliers,
    )


def _placement(record: Placement) -> estimation.Placement:
    return estimation.Placement(
        np.array(record.position_m),
        np.array(record.rotation_rad),
        np.array(record.position_std_m),
        np.array(record.rotation_std_rad),
    )
