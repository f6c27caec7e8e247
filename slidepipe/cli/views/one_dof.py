"""One degree of freedom as a person reads it."""

from rich.console import RenderableType
from rich.table import Table

from slidepipe.artifacts.one_dof import OneDofPlan, OneDofSeries, OneDofTrials
from slidepipe.artifacts.run import Run
from slidepipe.cli.views.tables import NONE, columns, facts, fixed, heading, number

CONDITIONS = {
    "sticks": "a < a_o (1 - eps)",
    "slides": "a_f > a_o (1 + eps)",
    "stops": "a_f > a_o (a(1+eps)+(1-eps)a_o) / (a+(1-2eps)a_o)",
    "can stop": "a + (1 - 2 eps) a_o > 0 (unsaid in the paper)",
}
"""Theorem 1's conditions by their names."""


def one_dof_plan_view(plan: OneDofPlan, run: Run) -> list[RenderableType]:
    """Times of eq. (4), the finger's motion, and Theorem 1's conditions."""
    return [
        heading(f"plan {run.id}", plan.experiment),
        facts(_facts(plan)),
        "",
        _profile(plan),
        "",
        _conditions(plan),
        "",
        *_promise(plan),
        str(run.directory / "one_dof_plan.yaml"),
    ]


def one_dof_trials_view(trials: OneDofTrials, run: Run) -> list[RenderableType]:
    """Contraction of every trial beside its bound, one block for each true friction."""
    numbers = ("mu", "error", "trial", "to slide\nmm", "slid\nmm", "left\nmm", "k", "bound")
    table = columns(*numbers, "", numbers=numbers)
    for series in trials.series:
        _add(table, series, trials.contraction_bound)
    said = columns("mu", "error", "", numbers=("mu", "error"))
    said.columns[2].no_wrap = False
    for series in trials.series:
        said.add_row(f"{series.friction:g}", _percent(series.error), series.said)
    return [
        heading(f"run {run.id}", trials.experiment),
        f"simulated: {trials.simulation}",
        "",
        table,
        "",
        said,
        "",
        trials.verdict,
        str(run.directory / "one_dof_trials.yaml"),
    ]


def _facts(plan: OneDofPlan) -> list[tuple[str, str]]:
    return [
        ("believed", f"mu {plan.friction:g}, a_o = mu f_N / m = {number(plan.friction_acceleration_m_s2, 'm/s²')}"),
        ("slide", f"{1e3 * plan.slide_m:g} mm"),
        ("T1", f"{plan.T1_s:.6f} s  sticking"),
        ("T2", f"{plan.T2_s:.6f} s  sliding, the finger tears itself loose"),
        ("T3", f"{plan.T3_s:.6f} s  sliding, the object catches up"),
        ("T4", f"{plan.T4_s:.6f} s  sticking"),
        ("finger", f"travels {1e3 * plan.peak_travel_m:.2f} mm and back, at most {plan.peak_speed_m_s:.4f} m/s"),
    ]


def _profile(plan: OneDofPlan) -> Table:
    names = ("from s", "to s", "finger m/s²")
    table = columns("phase", *names, numbers=names)
    for name, (start, stop, acceleration) in zip(("T1", "T2", "T3 + T4"), plan.profile, strict=False):
        table.add_row(name, fixed(start, 6), fixed(stop, 6), fixed(acceleration, 3))
    return table


def _conditions(plan: OneDofPlan) -> Table:
    numbers = ("left", "right", "eps below")
    table = columns(
        f"Theorem 1 at eps = {plan.friction_error:g}, in m/s²", "left", "", "right", "", "eps below", numbers=numbers
    )
    for one in plan.conditions:
        verdict = "satisfied" if one.satisfied else "NOT satisfied"
        table.add_row(
            f"{one.name}: {CONDITIONS[one.name]}",
            number(one.left_m_s2),
            one.relation,
            number(one.right_m_s2),
            verdict,
            number(one.holds_below),
        )
    return table


def _promise(plan: OneDofPlan) -> list[str]:
    star = f"eps* = {plan.eps_star:.4f}, set by the condition '{plan.eps_star_bound_by}'"
    if plan.contraction_bound is None:
        return [f"{star}: for a friction error of {plan.friction_error:g} nothing is promised"]
    within, most = 100 * plan.friction_error, 100 * plan.contraction_bound
    return [
        star,
        f"friction within {within:g} % of the belief: every trial leaves at most {most:.2f} % of the distance",
    ]


def _add(table: Table, series: OneDofSeries, bound: float | None) -> None:
    for index, trial in enumerate(series.trials, start=1):
        first, last = index == 1, index == len(series.trials)
        table.add_row(
            f"{series.friction:g}" if first else "",
            _percent(series.error) if first else "",
            str(index),
            fixed(1e3 * trial.left_before_m, 4),
            fixed(1e3 * trial.slid_m, 4),
            fixed(1e3 * trial.left_after_m, 4),
            fixed(trial.factor, 4),
            NONE if bound is None or not series.inside else fixed(bound, 4),
            series.outcome if last else "",
            end_section=last,
        )


def _percent(share: float) -> str:
    return f"{100 * share:+.1f} %"
