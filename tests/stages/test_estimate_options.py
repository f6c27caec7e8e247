"""What an experiment may leave open to its trials, set when a trial is estimated."""

from pathlib import Path

import pytest

from slidepipe.artifacts.estimate import EstimateDocument
from slidepipe.artifacts.schema import parse
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.strict_yaml import load
from slidepipe.errors import InputError
from slidepipe.stages.estimate import EstimateRequest, run

TRIAL = str(Path(__file__).resolve().parents[2] / "data" / "recorded" / "rotational-3800-seed203" / "trial.mcap")


def test_growth_is_told_and_written_and_another_recipe(tmp_path: Path) -> None:
    store = Store(tmp_path / "data")
    plain = run(EstimateRequest(TRIAL, store))
    asked = run(EstimateRequest(TRIAL, store, overrides=("estimation.growth_std_s_m=0.5",)))
    assert not asked.reused
    assert run(EstimateRequest(TRIAL, store, overrides=("estimation.growth_std_s_m=0.5",))).reused
    growth = asked.document.friction.growth_s_m
    assert growth.interval_95[0] < 0.0 < growth.interval_95[1], "the simulated world's friction does not grow"
    assert asked.document.friction.kappa_m_s2.std > 2.0 * plain.document.friction.kappa_m_s2.std
    assert plain.document.friction.growth_s_m is None
    assert "\n  growth_s_m:" not in plain.run.file("estimate").read_text()
    assert "\n  growth_s_m:" in asked.run.file("estimate").read_text()
    assert parse(EstimateDocument, load(asked.run.file("estimate"))) == asked.document


def test_what_is_not_told_is_null_and_said(tmp_path: Path) -> None:
    request = EstimateRequest(TRIAL, Store(tmp_path / "data"), overrides=("estimation.sticking=apart",))
    document = run(request).document
    assert document.friction.static_share is None
    assert any(said.startswith("mu_s / mu_k could not be told: 1.0") for said in document.not_told)


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("friction=0.3", "--set friction=0.3: the trial was run with the rest of the experiment, only estimation can"),
        ("estimation.surfac=pressure", "estimation.surfac: unknown key, did you mean surface"),
        ("estimation.sticking=more", "must be 'as_sliding' or 'apart', got 'more'"),
        ("estimation.growth_std_s_m=-1", "estimation.growth_std_s_m: "),
    ],
)
def test_what_cannot_be_set(tmp_path: Path, override: str, message: str) -> None:
    store = Store(tmp_path / "data")
    with pytest.raises(InputError, match=message):
        run(EstimateRequest(TRIAL, store, overrides=(override,)))
    assert not store.root.exists()
