from pathlib import Path

import pytest

EXPERIMENT = """\
schema: slidepipe.experiment/1
name: paper_linear
object: {size_x_m: 0.1, size_y_m: 0.06, thickness_m: 0.02, mass_kg: 0.023}
grasp: {finger_count: 2, normal_force_per_finger_n: 0.625, contact_radius_m: 0.0174, torsion_constant: 0.6}
friction: 0.38
start:
  object_pose: {x_m: 0.0, y_m: 0.0, theta_rad: 0.0}
  relative_pose: {x_m: -0.01, y_m: -0.02, theta_rad: 3.141592653589793}
goal:
  relative_pose: {x_m: 0.01, y_m: 0.02, theta_rad: 3.141592653589793}
  hand_pose: {x_m: 0.01, y_m: 0.02, theta_rad: 3.141592653589793}
  tolerance: {position_m: 0.001, angle_rad: 0.01}
motion: {stick_s: 0.3, slide_s: 0.2, settle_s: 1.1}
workspace: {centre_x_m: 0.0, centre_y_m: 0.0, radius_m: 0.5}
arm:
  model: wam7
  plane: {origin_m: [0.5, 0.0, 0.3], heading_rad: 1.5707963267948966}
  tool: {length_m: 0.1, angle_rad: 0.0}
  posture_rad: [0, 0, 0, 1.5, 0, 0, 0]
  limits:
    joint_speed_rad_s: [4, 4, 4, 4, 8, 8, 8]
    joint_torque_n_m: [77.3, 160.6, 95.6, 29.4, 11.6, 11.6, 2.7]
    tip_speed_m_s: 3.0
    elbow_speed_m_s: 3.0
iteration: {max_trials: 5, friction: estimate}
lab:
  seed: 1
  friction: 0.4256
  normal_force_per_finger_n: 0.625
  tracker: {kind: wam, feedforward: true}
  cameras: {rate_hz: 360}
"""


@pytest.fixture
def experiment_text() -> str:
    return EXPERIMENT


@pytest.fixture
def experiment_path(tmp_path: Path) -> Path:
    path = tmp_path / "exp.yaml"
    path.write_text(EXPERIMENT)
    return path
