from pathlib import Path

import pytest

from slidepipe.artifacts.experiment import load_experiment
from slidepipe.artifacts.recording import read_recording
from slidepipe.artifacts.store import Store
from slidepipe.errors import InfeasibleError
from slidepipe.stages import plan
from slidepipe.stages.plan_files import REFERENCE_HAND, REFERENCE_JOINTS


@pytest.mark.parametrize("name", ["paper_linear", "paper_rotational", "regrasp"])
def test_shipped_experiments_keep_every_limit(experiments: Path, store: Store, name: str) -> None:
    document = plan.run(plan.PlanRequest(experiments / f"{name}.yaml", store)).document
    assert all(check.satisfied for check in (*document.margins, *document.limits))


def test_plan_is_small_and_its_reference_ticks_at_500_hz(experiments: Path, store: Store) -> None:
    result = plan.run(plan.PlanRequest(experiments / "paper_linear.yaml", store))
    assert result.run.file("plan").stat().st_size < 64_000
    joints = read_recording(result.run.file("reference")).joints(REFERENCE_JOINTS)
    assert set((joints.stamp_ns[1:] - joints.stamp_ns[:-1]).tolist()) == {2_000_000}
    assert len(joints.stamp_ns) == 801
    assert abs(joints.velocity_rad_s[[0, -1]]).max() < 1e-5
    assert len(read_recording(result.run.file("reference")).poses(REFERENCE_HAND).stamp_ns) == 801


def test_equal_plan_is_found_again_and_force_makes_another(experiments: Path, store: Store) -> None:
    request = plan.PlanRequest(experiments / "regrasp.yaml", store)
    first, again = plan.run(request), plan.run(request)
    assert not first.reused
    assert again.reused
    assert again.run.id == first.run.id
    assert again.document == first.document
    forced = plan.run(plan.PlanRequest(experiments / "regrasp.yaml", store, force=True))
    assert forced.run.id != first.run.id
    other = plan.run(plan.PlanRequest(experiments / "regrasp.yaml", store, ("friction=0.4",)))
    assert not other.reused


def test_overrides_are_kept_in_the_plan(experiments: Path, store: Store) -> None:
    result = plan.run(plan.PlanRequest(experiments / "regrasp.yaml", store, ("friction=0.4",)))
    assert load_experiment(result.run.file("experiment")).friction == 0.4
    assert result.document.believed.friction == 0.4


@pytest.mark.parametrize(
    ("name", "override", "message"),
    [
        (
            "paper_linear",
            "grasp.normal_force_per_finger_n=1.25",
            r"workspace: 1.039 m at t = 0.436 s, beyond 0.5 m\nhand speed: 4.741 m/s at t = 0.300 s, beyond 3 m/s",
        ),
        (
            "paper_rotational",
            "grasp.normal_force_per_finger_n=2.5",
            r"workspace: 1.191 m at t = 0.398 s, beyond 0.5 m\nhand speed: 6.628 m/s at t = 0.300 s, beyond 3 m/s",
        ),
        ("paper_linear", "arm.limits.tip_speed_m_s=1.5", r"hand speed: 1.829 m/s at t = 0.300 s, beyond 1.5 m/s"),
        (
            "paper_linear",
            "friction=0.2",
            r"share of the friction used while sticking before the slide: 1.\d+ of 1 at t",
        ),
    ],
)
def test_broken_limit_is_named_and_the_refusal_is_kept(
    experiments: Path, store: Store, name: str, override: str, message: str
) -> None:
    with pytest.raises(InfeasibleError, match=message):
        plan.run(plan.PlanRequest(experiments / f"{name}.yaml", store, (override,)))
    (run,) = store.runs()
    assert run.manifest.error is not None
    assert run.manifest.error.type == "InfeasibleError"
