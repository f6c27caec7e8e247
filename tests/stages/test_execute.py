from collections.abc import Callable
from pathlib import Path

import pytest

from slidepipe.artifacts import topics
from slidepipe.artifacts.recording import read_recording
from slidepipe.artifacts.store import Store
from slidepipe.errors import InputError, NotFoundError
from slidepipe.stages import execute, plan

SILENT = (
    "lab.tracker.kind=perfect",
    "lab.cameras.position_noise_m=0.0",
    "lab.cameras.angle_noise_rad=0.0",
    "lab.cameras.dropout_share=0.0",
)


def test_same_seed_same_bytes_another_seed_others(experiments: Path, store: Store) -> None:
    planned = plan.run(plan.PlanRequest(experiments / "paper_rotational.yaml", store))
    recordings = [
        read_recording(execute.run(execute.ExecuteRequest(planned.run.id, store, overrides)).run.file("recording"))
        for overrides in ((), (), ("lab.seed=2",))
    ]
    for topic in (topics.HAND, topics.OBJECT):
        first, again, other = (recording.payloads(topic) for recording in recordings)
        assert first == again
        assert first != other
    assert recordings[0].payloads(topics.MEASURED) == recordings[2].payloads(topics.MEASURED)


@pytest.mark.parametrize(
    ("name", "position_m", "angle_rad"), [("paper_linear", 0.5e-3, 10e-3), ("paper_rotational", 2e-3, 30e-3)]
)
def test_perfect_tracker_and_right_friction_land_the_first_trial(
    try_out: Callable, name: str, position_m: float, angle_rad: float
) -> None:
    """With solref 0.0001 s, impratio 1000 and a time step of 2.5e-5 s, as the shipped files say."""
    done, _ = try_out(name, *SILENT)
    goal = {"paper_linear": (0.01, 0.02), "paper_rotational": (0.01, 0.04)}[name]
    reached = done.truth.final_relative_pose
    missed_m = ((reached.x_m - goal[0]) ** 2 + (reached.y_m - goal[1]) ** 2) ** 0.5
    missed_rad = abs(reached.theta_rad - 3.141592653589793)
    print(f"{name}: missed by {1e3 * missed_m:.2f} mm and {1e3 * missed_rad:.1f} mrad")  # noqa: T201
    assert missed_m < position_m
    assert missed_rad < angle_rad


def test_provenance_comes_first_and_the_end_last(regrasp) -> None:
    result, store, _ = regrasp
    run = store.get(result.document.rows[0].runs.execute)
    recording = read_recording(run.file("recording"))
    assert recording.metadata["slidepipe.run"]["run"] == run.id
    assert recording.metadata["slidepipe.run"]["plan"] == result.document.rows[0].runs.plan
    assert recording.metadata["slidepipe.end"]["state"] == "complete"
    assert recording.attachment("plan.yaml") == store.get(result.document.rows[0].runs.plan).file("plan").read_bytes()


def test_tracking_error_is_visible_and_small(regrasp) -> None:
    result, store, _ = regrasp
    recording = read_recording(store.get(result.document.rows[0].runs.execute).file("recording"))
    commanded, measured = recording.joints(topics.COMMANDED), recording.joints(topics.MEASURED)
    worst = abs(commanded.position_rad - measured.position_rad).max(axis=0)
    assert (worst > 1e-4).all()
    assert (worst < 2e-2).all()


def test_only_the_lab_can_be_set(regrasp) -> None:
    result, store, _ = regrasp
    with pytest.raises(InputError, match=r"^--set friction=0.5: an execution can set the lab alone"):
        execute.run(execute.ExecuteRequest(result.document.rows[0].runs.plan, store, ("friction=0.5",)))


def test_a_run_without_a_plan_cannot_be_executed(regrasp) -> None:
    result, store, _ = regrasp
    with pytest.raises(NotFoundError, match=r"has no plan, its files are: estimate, smoothed"):
        execute.run(execute.ExecuteRequest(result.document.rows[0].runs.estimate, store))


def test_gripper_of_other_than_two_fingers_is_refused_and_leaves_nothing(experiments: Path, store: Store) -> None:
    overrides = ("grasp.finger_count=4", "grasp.normal_force_per_finger_n=0.3125")
    planned = plan.run(plan.PlanRequest(experiments / "paper_linear.yaml", store, overrides))
    with pytest.raises(InputError, match=r"grasp.finger_count: the simulated lab's gripper has 2 fingers, got 4"):
        execute.run(execute.ExecuteRequest(planned.run.id, store))
    assert [run.manifest.stage for run in store.runs()] == ["plan"]
