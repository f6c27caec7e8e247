"""The trials of an experiment together, as a person reads them."""

from rich.console import RenderableType
from rich.table import Table

from slidepipe.artifacts.pooled import PooledDocument, PooledTrial, PooledValue
from slidepipe.artifacts.run import Run
from slidepipe.artifacts.values import Planar
from slidepipe.cli.views.tables import (
    NONE,
    columns,
    facts,
    friction,
    friction_interval,
    heading,
    interval,
    length_mm,
    number,
    planar,
)

_ERRORS = ("x mm", "y mm", "theta mrad")
_NUMBERS = ("trial", *_ERRORS, "kappa m/s²", "±", "rho mm")


def pooled_view(pooled: PooledDocument, run: Run) -> list[RenderableType]:
    """Final error and friction of each trial, how they repeat, and what they tell of friction together."""
    files = [name for name in ("pooled.yaml", pooled.picture) if name is not None]
    return [
        heading(f"pooled {run.id}", f"{pooled.experiment}, {len(pooled.trials)} trials"),
        _table(pooled),
        "",
        facts([*_friction(pooled), *_left_out(pooled), *(("note", text) for text in pooled.notes)]),
        "",
        *(str(run.directory / name) for name in files),
    ]


def _table(pooled: PooledDocument) -> Table:
    torsion = () if pooled.rho_m is None else ("rho mm",)
    table = columns("final minus goal", *_ERRORS, "kappa m/s²", "±", *torsion, "", numbers=_NUMBERS)
    last = len(pooled.trials) - 1
    for place, trial in enumerate(pooled.trials):
        kappa = trial.kappa_m_s2
        told = (number(kappa.value), f"{kappa.std:.2g}") if kappa else (NONE, NONE)
        error = planar(trial.error.vector) if trial.error else (NONE, NONE, NONE)
        turning = (_torsion(trial),) if torsion else ()
        table.add_row(trial.trial, *error, *told, *turning, _remark(trial), end_section=place == last)
    for name, vector, count in _repeatability(pooled):
        table.add_row(name, *planar(vector), "", "", *("" for _ in torsion), count)
    return table


def _repeatability(pooled: PooledDocument) -> list[tuple[str, Planar, str]]:
    found = pooled.repeatability
    if found is None:
        return []
    count = f"of {found.trials} {'trial' if found.trials == 1 else 'trials'}"
    spread = [] if found.std_error is None else [("standard deviation", found.std_error.vector, count)]
    return [("mean", found.mean_error.vector, count), *spread]


def _torsion(trial: PooledTrial) -> str:
    rho = trial.rho_m
    return f"{1e3 * rho.value:.2f} ± {1e3 * rho.std:.2f}" if rho else NONE


def _remark(trial: PooledTrial) -> str:
    stands = (("kappa", trial.kappa_outlying), ("rho", trial.rho_outlying), ("error", trial.error_outlying))
    out = [name for name, outlying in stands if outlying]
    return f"stands out: {' and '.join(out)}" if out else ""


def _left_out(pooled: PooledDocument) -> list[tuple[str, str]]:
    return [("left out", f"{one.trial}: {reason}") for one in pooled.trials for reason in one.left_out_because]


def _friction(pooled: PooledDocument) -> list[tuple[str, str]]:
    kappa, mu, taken = pooled.kappa_m_s2, pooled.mu, pooled.assumed
    if kappa is None or mu is None:
        return [("friction", "not estimated: none of the trials tells it")]
    force, mass = number(taken.normal_force_n, "N"), number(1e3 * taken.mass_kg, "g")
    ends = interval(kappa.interval_95, "m/s²")
    return [
        ("kappa = mu f_N / m", f"{number(kappa.value)} ± {kappa.std:.2g} m/s², 95 % interval {ends}"),
        ("noise within a trial", _share(kappa.within_std, kappa)),
        ("spread between trials", f"{_share(kappa.between_std, kappa)}, 95 % interval {_between(kappa)}"),
        ("one value for all", _same(kappa)),
        ("the next trial's kappa", f"95 % interval {interval(kappa.predictive_interval_95, 'm/s²')}"),
        *_rho(pooled),
        ("mu", f"{friction(mu.value)}, 95 % interval {friction_interval(mu.interval_95)}"),
        ("assumed for mu", f"f_N {force}, mass {mass}, rho {length_mm(taken.rho_m)} mm"),
    ]


def _rho(pooled: PooledDocument) -> list[tuple[str, str]]:
    rho = pooled.rho_m
    if rho is None:
        return []
    low, high = (f"{1e3 * end:.2f}" for end in rho.interval_95)
    spreads = (rho.within_std, rho.between_std)
    within, between = (f"{1e3 * one:.2f} mm ({100.0 * one / rho.value:.2g} %)" for one in spreads)
    return [
        ("rho = c a", f"{1e3 * rho.value:.2f} ± {1e3 * rho.std:.2f} mm, 95 % interval [{low}, {high}] mm"),
        ("within, between trials", f"{within}, {between}"),
    ]


def _share(spread: float, kappa: PooledValue) -> str:
    return f"{number(spread, 'm/s²')} ({100.0 * spread / kappa.value:.2g} %)"


def _between(kappa: PooledValue) -> str:
    return interval(kappa.between_interval_95, "m/s²")


def _same(kappa: PooledValue) -> str:
    if kappa.trials == 1:
        return "one trial cannot say"
    fits = "fits" if kappa.same_value_p > 0.05 else "does not fit"
    return f"{fits} the {kappa.trials} estimates (p = {kappa.same_value_p:.2g})"
