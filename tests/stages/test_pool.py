import shutil
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from slidepipe.artifacts.pooled import PooledDocument
from slidepipe.artifacts.schema import parse
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.strict_yaml import load
from slidepipe.errors import InputError
from slidepipe.stages import estimate, pool

RECORDED = Path(__file__).resolve().parents[2] / "data" / "recorded"
TRIALS = tuple(str(RECORDED / name / "trial.mcap") for name in
               ("linear-3800-seed103", "linear-3876-seed104", "linear-4180-seed107"))  # fmt: skip


@pytest.fixture(scope="module")
def pooled(tmp_path_factory: pytest.TempPathFactory) -> tuple[pool.PoolResult, Store]:
    store = Store(tmp_path_factory.mktemp("pool") / "data")
    return pool.run(pool.PoolRequest(TRIALS, store)), store


def test_friction_and_repeatability(pooled) -> None:
    document = pooled[0].document
    kappas = [one.document.friction.kappa_m_s2.value for one in pooled[0].estimates]
    assert [trial.kappa_m_s2.value for trial in document.trials] == kappas
    assert document.kappa_m_s2.trials == 3
    assert min(kappas) < document.kappa_m_s2.value < max(kappas)
    assert document.kappa_m_s2.same_value_p < 1e-6, "the three were recorded at three frictions"
    assert document.mu.value == pytest.approx(document.kappa_m_s2.value * 0.023 / 1.25)
    errors = np.array([trial.error.vector for trial in document.trials])
    ends = [one.document.final_relative_pose for one in pooled[0].estimates]
    assert errors[:, 0] == pytest.approx([end.x_m - 0.01 for end in ends])
    assert document.repeatability.mean_error.vector == pytest.approx(tuple(errors.mean(axis=0)))
    assert document.repeatability.std_error.vector == pytest.approx(tuple(errors.std(axis=0, ddof=1)))


def test_the_run_names_recordings_and_estimates_by_hash(pooled) -> None:
    result, store = pooled
    inputs = result.run.manifest.inputs
    assert [one.role for one in inputs] == ["recording"] * 3 + ["estimate"] * 3
    assert [one.run for one in inputs[3:]] == [one.run.id for one in result.estimates]
    assert parse(PooledDocument, load(result.run.file("pooled"))) == result.document
    with Image.open(result.run.file("repeatability")) as picture:
        assert picture.format == "PNG"
    stages = [run.manifest.stage for run in store.runs()]
    again = pool.run(pool.PoolRequest(TRIALS, store))
    assert again.reused
    assert again.document == result.document
    assert [run.manifest.stage for run in store.runs()] == stages == ["estimate"] * 3 + ["pool"]


def test_a_figure_is_drawn_on_request_and_is_a_run_of_its_own(pooled) -> None:
    store = pooled[1]
    plain = estimate.run(estimate.EstimateRequest(TRIALS[0], store))
    drawn = estimate.run(estimate.EstimateRequest(TRIALS[0], store, figure=True))
    assert plain.reused
    assert not drawn.reused
    assert drawn.document == plain.document
    with Image.open(drawn.run.file("figure")) as picture:
        assert picture.size == (2700, 1548)
    assert estimate.run(estimate.EstimateRequest(TRIALS[0], store, figure=True)).reused


def test_torsion_is_pooled_beside_friction_where_the_slides_turn(tmp_path: Path, pooled) -> None:
    names = ("rotational-3800-seed203", "rotational-3800-seed207", "rotational-3876-seed204")
    trials = tuple(str(RECORDED / name / "trial.mcap") for name in names)
    document = pool.run(pool.PoolRequest(trials, Store(tmp_path / "data"))).document
    assert [trial.rho_m.value for trial in document.trials] == pytest.approx([0.03] * 3, rel=0.01)
    assert document.rho_m.trials == 3
    assert document.rho_m.interval_95[0] < 0.03 < document.rho_m.interval_95[1]
    assert document.rho_m.within_std == pytest.approx(0.0001, abs=0.0001)
    assert document.rho_m.same_value_p > 0.05, "the three have one contact"
    assert document.kappa_m_s2.same_value_p < 0.05, "and two frictions"
    assert not any(trial.rho_outlying for trial in document.trials)
    assert pooled[0].document.rho_m is None, "a slide that does not turn tells none"


def test_the_same_trial_twice_counts_once(tmp_path: Path) -> None:
    shutil.copy(TRIALS[0], tmp_path / "copy.mcap")
    store = Store(tmp_path / "data")
    with pytest.raises(InputError, match=r"copy.mcap: trial .* is named twice, each counts once"):
        pool.run(pool.PoolRequest((TRIALS[0], str(tmp_path / "copy.mcap")), store))
    assert not store.root.exists()


def test_trials_of_two_experiments_are_not_pooled(tmp_path: Path) -> None:
    store, other = Store(tmp_path / "data"), str(RECORDED / "rotational-3800-seed203" / "trial.mcap")
    with pytest.raises(InputError, match=r"is a trial of another experiment than .*, its name differs"):
        pool.run(pool.PoolRequest((TRIALS[0], other), store))
    assert not store.root.exists()


def test_a_trial_that_tells_nothing_is_named_with_its_reason(
    pooled, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from slidepipe.errors import EstimationError  # noqa: PLC0415

    told = dict(zip(TRIALS, pooled[0].estimates, strict=True))

    def answer(request: estimate.EstimateRequest) -> estimate.EstimateResult:
        if request.trial == TRIALS[1]:
            raise EstimationError("poses: 3 frames with the bodies in them")
        return told[request.trial]

    monkeypatch.setattr(estimate, "run", answer)
    document = pool.run(pool.PoolRequest(TRIALS, Store(tmp_path / "data"))).document
    assert document.trials[1].left_out_because == ("poses: 3 frames with the bodies in them",)
    assert document.trials[1].estimate is None
    assert document.kappa_m_s2.trials == 2
    assert "two trials tell little of the spread between trials" in document.notes[0]
    with pytest.raises(EstimationError, match=r"^20\w+-\w+: poses: 3 frames"):
        pool.run(pool.PoolRequest((TRIALS[1],), Store(tmp_path / "none")))
