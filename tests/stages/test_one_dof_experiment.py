from pathlib import Path

import pytest

from slidepipe.artifacts.one_dof import OneDofPlan, OneDofTrials
from slidepipe.artifacts.schema import parse
from slidepipe.artifacts.store import Store
from slidepipe.artifacts.strict_yaml import load
from slidepipe.errors import InputError
from slidepipe.mechanics.one_dof import Accelerations
from slidepipe.mechanics.theorem_1 import contraction_factor
from slidepipe.stages import one_dof


@pytest.fixture
def ask(experiments: Path, store: Store):
    return lambda *overrides: one_dof.OneDofRequest(experiments / "one_dof.yaml", store, overrides)


def test_plan_has_the_times_of_equation_4(ask) -> None:
    document = one_dof.plan(ask()).document
    a_f, a_o, a, d = 20.0, 5.0, 2.0, 0.1
    assert document.T2_s == pytest.approx((2 * d * (a + a_o) / ((a + a_f) * (a_f - a_o))) ** 0.5)
    assert document.T3_s == pytest.approx((2 * d * (a_f - a_o) / ((a + a_f) * (a + a_o))) ** 0.5)
    assert document.T1_s == pytest.approx(a_f * document.T2_s / (2 * a))
    assert document.T4_s == pytest.approx(document.T1_s - document.T3_s)
    assert [one.satisfied for one in document.conditions] == [True] * 4
    assert document.eps_star == pytest.approx(0.5676, abs=1e-4)


@pytest.mark.parametrize(
    ("settings", "broken"),
    [
        (("friction_error=0.71",), ["sticks", "can stop"]),
        (("friction_error=0.58",), ["stops"]),
        (("friction_error=0.3", "acceleration_m_s2=4.0"), ["sticks"]),
        (("friction_error=0.3", "tearing_acceleration_m_s2=6.0"), ["slides", "stops"]),
    ],
)
def test_conditions_that_do_not_hold_are_named(ask, settings, broken) -> None:
    document = one_dof.plan(ask(*settings)).document
    assert [one.name for one in document.conditions if not one.satisfied] == broken
    assert not document.converges
    assert document.contraction_bound is None
    result = one_dof.run(ask(*settings)).document
    assert not result.confirmed
    assert "promises nothing" in result.verdict


def test_every_trial_inside_the_interval_keeps_to_the_bound(ask) -> None:
    document = one_dof.run(ask()).document
    inside = [one for one in document.series if one.inside]
    assert [one.friction for one in inside] == [0.35, 0.42, 0.5, 0.58, 0.65]
    assert document.confirmed
    assert document.contraction_bound == pytest.approx(0.4)
    for series in inside:
        assert series.outcome == "converged"
        assert all(trial.factor <= document.contraction_bound + 1e-9 for trial in series.trials)
    assert inside[0].largest_factor == pytest.approx(0.4, abs=1e-9)


def test_outside_the_interval_it_says_what_happens(ask) -> None:
    outside = {one.friction: one for one in one_dof.run(ask()).document.series if not one.inside}
    assert outside[0.205].outcome == "grows"
    assert outside[0.205].largest_factor > 1.0
    assert outside[2.1].outcome == "nothing slides"
    assert outside[0.75].outcome == "converged"
    assert "within eps*" in outside[0.75].said
    assert all("nothing is promised" in outside[friction].said for friction in (0.205, 0.1, 2.1))


def test_measured_factor_is_the_closed_forms(ask) -> None:
    accelerations = Accelerations(a_f=20.0, a_o=5.0, a=2.0)
    for series in one_dof.run(ask()).document.series:
        expected = contraction_factor(accelerations, 10.0 * series.friction)
        assert [trial.factor for trial in series.trials] == pytest.approx([expected] * len(series.trials), abs=1e-8)


def test_what_is_stored_is_what_was_told(ask) -> None:
    planned, run = one_dof.plan(ask()), one_dof.run(ask())
    assert parse(OneDofPlan, load(planned.run.file(one_dof.PLAN))) == planned.document
    assert parse(OneDofTrials, load(run.run.file(one_dof.TRIALS))) == run.document
    assert one_dof.plan(ask()).reused


def test_accelerations_that_cannot_slide_are_refused(ask) -> None:
    with pytest.raises(InputError, match=r"tearing_acceleration_m_s2: must be above .* a_o = .* 5 m/s\^2.*got 3.0"):
        one_dof.plan(ask("tearing_acceleration_m_s2=3.0"))


def test_other_files_are_no_one_dof_experiments(experiments: Path, tmp_path: Path) -> None:
    assert one_dof.is_one_dof(experiments / "one_dof.yaml")
    assert not one_dof.is_one_dof(experiments / "regrasp.yaml")
    assert not one_dof.is_one_dof(tmp_path / "missing.yaml")
