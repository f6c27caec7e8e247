from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from slidepipe.artifacts.experiment import Experiment, load_experiment
from slidepipe.artifacts.schema import dump_model, parse
from slidepipe.artifacts.strict_yaml import loads
from slidepipe.errors import InputError, NotFoundError


def lines(path: Path, old: str, new: str) -> list[str]:
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))
    with pytest.raises(InputError) as caught:
        load_experiment(path)
    return [line.removeprefix(f"{path}:") for line in caught.value.lines]


def test_the_file_is_read(experiment_path):
    experiment = load_experiment(experiment_path)
    assert experiment.name == "paper_linear"
    assert experiment.grasp.normal_force_n == 1.25
    assert experiment.kappa_m_s2 == pytest.approx(0.38 * 1.25 / 0.023)
    assert experiment.true_kappa_m_s2 == pytest.approx(0.4256 * 1.25 / 0.023)
    assert experiment.rho_m == pytest.approx(0.6 * 0.0174)
    assert experiment.goal.relative_pose.vector == (0.01, 0.02, 3.141592653589793)
    assert experiment.arm.posture_rad == (0, 0, 0, 1.5, 0, 0, 0)
    assert experiment.lab.contact.impratio == 1000.0


def test_it_can_be_written_back(experiment_path):
    experiment = load_experiment(experiment_path)
    assert parse(Experiment, loads(dump_model(experiment), "copy.yaml")) == experiment


@settings(max_examples=50, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(friction=st.floats(0.01, 5.0), x_m=st.floats(-0.05, 0.05), mass_kg=st.floats(0.0, 50.0, exclude_min=True))
def test_any_numbers_come_back_exactly(experiment_path, friction, x_m, mass_kg):
    overrides = [f"friction={friction!r}", f"goal.relative_pose.x_m={x_m!r}", f"object.mass_kg={mass_kg!r}"]
    experiment = load_experiment(experiment_path, overrides)
    assert (experiment.friction, experiment.goal.relative_pose.x_m, experiment.object.mass_kg) == (
        friction,
        x_m,
        mass_kg,
    )
    assert parse(Experiment, loads(dump_model(experiment), "copy.yaml")) == experiment


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (", mass_kg: 0.023", "", "3:1: object.mass_kg: required key is missing"),
        ("radius_m: 0.5}", "radius_m: 0.5, colour: 1}",
         "14:62: workspace.colour: unknown key, allowed are centre_x_m, centre_y_m, radius_m"),
        ("mass_kg: 0.023", "mass_kg: -0.023", "3:60: object.mass_kg: must be > 0, got -0.023 kg"),
        ("{x_m: 0.01, y_m: 0.02, theta_rad: 3.141592653589793}\n  hand", "{x_m: 0.06, y_m: 0.02, theta_rad: 0}\n  hand",
         ("10:19: goal.relative_pose.x_m: the goal is outside the object, must be within -0.05 and 0.05 m (half of "
         "object.size_x_m), got 0.06 m")),
        ("y_m: -0.02", "y_m: -0.04", ("8:31: start.relative_pose.y_m: the start is outside the object, must be within "
         "-0.03 and 0.03 m (half of object.size_y_m), got -0.04 m")),
        ("x_m: -0.01, y_m: -0.02", "x_m: 0.01, y_m: 0.02",
         "10:3: goal.relative_pose: must differ from start.relative_pose: there is nothing to slide"),
        ("slide_s: 0.2", "slide_s: 0", "13:24: motion.slide_s: must be > 0, got 0 s"),
        ("slide_s: 0.2", "slide_s: 0.2015",
         "13:24: motion.slide_s: must be a multiple of 0.004 s of the control loop, got 0.2015 s"),
        ("friction: 0.38", "friction: 1e-05", "5:1: friction: must be >= 0.01, got 1e-05"),
        ("friction: 0.38", "friction: 38", "5:1: friction: must be <= 5, got 38"),
        ("friction: 0.38", "friction: 0.38\nfriction: 0.4", "6:1: friction: duplicate key, first given at line 5"),
        ("finger_count: 2", "finger_count: 0", "4:9: grasp.finger_count: must be >= 1, got 0"),
        ("finger_count: 2", "finger_count: 2.0", "4:9: grasp.finger_count: must be a whole number, got 2.0"),
        ("contact_radius_m: 0.0174", "contact_radius_m: 0", "4:60: grasp.contact_radius_m: must be > 0, got 0 m"),
        ("mass_kg: 0.023", "mass_kg: 23 g", "3:60: object.mass_kg: must be a number of kg, got '23 g'"),
        ("size_x_m: 0.1", "size_x_m: 60", "3:10: object.size_x_m: must be <= 2, got 60 m"),
        ("x_m: 0.0, y_m: 0.0, theta_rad: 0.0", "x_m: 0.0, y_m: 0.0, theta_rad: 90",
         "7:37: start.object_pose.theta_rad: must be within a turn, 6.28 rad, got 90 rad"),
        ("length_m: 0.1", "length_m: 100", "18:10: arm.tool.length_m: must be <= 2, got 100 m"),
        ("[0, 0, 0, 1.5, 0, 0, 0]", "3", "19:3: arm.posture_rad: must be a list, got 3 rad"),
        ("y_m: 0.02, theta_rad: 3.141592653589793}\n  hand", "y_m: 0.02, theta_rad: 180}\n  hand",
         ("10:41: goal.relative_pose.theta_rad: must be within a turn, 6.28 rad, of the start's 3.14159 rad, got 180 "
          "rad")),
        ("name: paper_linear", "name: ../x",
         "2:1: name: must be at most 64 of a to z, 0 to 9, _ and -, a letter or digit first, got '../x'"),
        ("[0, 0, 0, 1.5, 0, 0, 0]", "[0, 0, 0, 1.5, 0, 0]", "19:3: arm.posture_rad: must have 7 entries, got 6"),
        ("29.4, 11.6", "29.4, -11.6", "22:49: arm.limits.joint_torque_n_m[4]: must be > 0, got -11.6 N m"),
        ("friction: estimate", "friction: no",
         "25:1: iteration.way: must be 'goal', 'posterior' or 'learned', got 'no'"),
        ("feedforward: true", "feedforward: yes", "30:24: lab.tracker.feedforward: must be true or false, got 'yes'"),
        ("rate_hz: 360", "dropout_share: 1", "31:13: lab.cameras.dropout_share: must be < 1, got 1"),
    ],
)  # fmt: skip
def test_each_fault_is_one_line(experiment_path, old, new, message):
    assert lines(experiment_path, old, new) == [message]


def test_a_slip_of_the_pen_gives_exactly_these_lines(experiment_path):
    assert lines(experiment_path, "friction: 0.38", "frictoin: 0.38") == [
        "1:1: friction: required key is missing",
        "5:1: frictoin: unknown key, did you mean friction?",
    ]


@pytest.mark.parametrize("key", ["seed: 1", "friction: 0.4256", "normal_force_per_finger_n: 0.625"])
def test_the_worlds_physics_have_no_defaults(experiment_path, key):
    name = key.partition(":")[0]
    assert lines(experiment_path, f"  {key}\n", "") == [f"26:1: lab.{name}: required key is missing"]


def test_overrides_name_the_option(experiment_path):
    assert load_experiment(experiment_path, ["lab.contact.impratio=100"]).lab.contact.impratio == 100.0
    with pytest.raises(InputError) as caught:
        load_experiment(experiment_path, ["frction=0.4", "goal.relative_pose.x_m=0.06", "lab.cameras.rate=1"])
    assert caught.value.lines == (
        "--set lab.cameras.rate=1: lab.cameras.rate: unknown key, did you mean rate_hz?",
        "--set frction=0.4: frction: unknown key, did you mean friction?",
    )
    with pytest.raises(
        InputError, match=r"^--set goal.relative_pose.x_m=0.06: goal.relative_pose.x_m: the goal is outside"
    ):
        load_experiment(experiment_path, ["goal.relative_pose.x_m=0.06"])


def test_a_directory_and_a_missing_file(tmp_path):
    with pytest.raises(InputError) as caught:
        load_experiment(tmp_path)
    assert caught.value.lines == (f"{tmp_path}: is a directory, a YAML file is needed",)
    with pytest.raises(NotFoundError):
        load_experiment(tmp_path / "none.yaml")


@pytest.mark.parametrize(("friction", "way"), [("estimate", "posterior"), ("keep", "goal")])
def test_version_1_said_what_becomes_of_the_friction(experiment_path, friction, way):
    experiment_path.write_text(experiment_path.read_text().replace("friction: estimate", f"friction: {friction}"))
    iteration = load_experiment(experiment_path).iteration
    assert (iteration.way, iteration.max_trials, iteration.patience) == (way, 5, 3)
