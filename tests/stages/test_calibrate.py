"""From a recording to a calibration, and from there to the estimate of another trial."""

from pathlib import Path

import numpy as np
import pytest

from slidepipe.artifacts.calibration import CalibrationDocument
from slidepipe.artifacts.manifest import RunState
from slidepipe.artifacts.schema import parse
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.strict_yaml import load
from slidepipe.errors import EstimationError, InputError, NotFoundError
from slidepipe.stages import calibrate, estimate, execute, plan
from slidepipe.stages.calibration_files import read_calibration

RECORDED = Path(__file__).resolve().parents[2] / "data" / "recorded"
MARKERS_M = (0.012, -0.02, 0.01)
OFFSETS = (
    "lab.cameras.frame.position_m=[1.2, -0.4, 0.3]",
    "lab.cameras.frame.rotation_rad=[1.2, -0.7, 2.0]",
    "lab.cameras.hand_markers.position_m=[0.012, -0.02, 0.01]",
    "lab.cameras.hand_markers.rotation_rad=[0.3, -0.2, 0.8]",
)


@pytest.fixture(scope="module")
def moved(tmp_path_factory: pytest.TempPathFactory) -> tuple[Store, execute.ExecuteResult]:
    """A trial that cameras at a strange place saw, with markers beside the finger."""
    store = Store(tmp_path_factory.mktemp("calibrate") / "data")
    experiment = Path(__file__).resolve().parents[2] / "experiments" / "paper_rotational.yaml"
    planned = plan.run(plan.PlanRequest(experiment, store))
    return store, execute.run(execute.ExecuteRequest(planned.run.id, store, OFFSETS))


@pytest.fixture(scope="module")
def found(moved) -> calibrate.CalibrateResult:
    return calibrate.run(calibrate.CalibrateRequest(moved[1].run.id, moved[0]))


def test_markers_and_cameras_are_found_where_the_lab_has_them(found: calibrate.CalibrateResult) -> None:
    document = found.document
    away = np.array(document.hand_markers.position_m) - MARKERS_M
    assert np.abs(away / document.hand_markers.position_std_m).max() < 4.0
    assert np.abs(away[:2]).max() < 1.5e-4
    assert document.hand_markers.rotation_rad == pytest.approx((0.3, -0.2, 0.8), abs=1e-3)
    assert document.cameras_in_base.rotation_rad == pytest.approx((1.2, -0.7, 2.0), abs=1e-3)
    assert document.heading_rad == pytest.approx(np.pi / 2, abs=2e-3)
    assert document.lean_rad == pytest.approx(0.0, abs=2e-3)
    assert document.cameras_in_base.position_m[1:] == pytest.approx((-0.4, 0.3), abs=5e-4)
    assert abs(document.joints_late_s) < 1e-4
    assert any("stayed near a plane" in note for note in document.notes)


def test_a_calibration_is_stored_reused_and_read_back(moved, found: calibrate.CalibrateResult) -> None:
    assert parse(CalibrationDocument, load(found.run.file("calibration"))) == found.document
    assert calibrate.run(calibrate.CalibrateRequest(moved[1].run.id, moved[0])).reused
    back = read_calibration(found.run)
    assert tuple(back.hand_markers.position_m) == found.document.hand_markers.position_m
    assert tuple(back.cameras_in_base.rotation_rad) == found.document.cameras_in_base.rotation_rad


def test_with_the_calibration_the_estimate_is_that_of_the_truth(moved, found: calibrate.CalibrateResult) -> None:
    store, done = moved
    told = estimate.run(estimate.EstimateRequest(done.run.id, store, calibration=found.run.id))
    true = done.truth.final_relative_pose
    final = told.document.final_relative_pose
    assert (final.x_m, final.y_m) == pytest.approx((true.x_m, true.y_m), abs=2e-4)
    assert final.theta_rad == pytest.approx(true.theta_rad, abs=3e-3)
    assert told.document.friction.kappa_m_s2.value == pytest.approx(done.truth.kappa_m_s2, rel=0.02)
    assert [one.role for one in told.run.manifest.inputs] == ["recording", "calibration"]
    assert told.document.notes[-1].startswith(f"cameras and markers are where calibration {found.run.id} found them")
    with pytest.raises(InputError, match="another body, or their frame is not the arm's: slidepipe calibrate"):
        estimate.run(estimate.EstimateRequest(done.run.id, store))
    with pytest.raises(NotFoundError, match="has no calibration, its files are"):
        estimate.run(estimate.EstimateRequest(done.run.id, store, calibration=done.run.id))


def test_a_motion_that_does_not_turn_the_hand_is_refused(tmp_path: Path) -> None:
    store = Store(tmp_path / "data")
    trial = str(RECORDED / "linear-3800-seed103" / "trial.mcap")
    with pytest.raises(EstimationError, match=r"the hand turned by 0.\d degrees only, .* must turn the hand"):
        calibrate.run(calibrate.CalibrateRequest(trial, store))
    assert [run.manifest.state for run in store.runs()] == [RunState.FAILED]


def test_a_recorded_turn_tells_that_the_markers_are_at_the_finger(tmp_path: Path) -> None:
    trial = str(RECORDED / "rotational-3800-seed203" / "trial.mcap")
    document = calibrate.run(calibrate.CalibrateRequest(trial, Store(tmp_path / "data"))).document
    assert np.abs(document.hand_markers.position_m[:2]).max() < 1.5e-4
    assert max(document.hand_markers.position_std_m[:2]) < 5e-5
    assert document.cameras_in_base.rotation_rad == pytest.approx((0.0, 0.0, 0.0), abs=1e-3)
