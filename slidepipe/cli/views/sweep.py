"""A sweep as a person reads it."""

from rich.console import RenderableType

from slidepipe.artifacts.run import Run
from slidepipe.artifacts.sweep import Spread, SweepDocument, SweepTrialDocument
from slidepipe.cli.views.tables import NONE, angle_mrad, columns, facts, heading, length_mm, planar

WORLDS = {
    "mechanics": "the exact mechanics with a perfect hand, first motion only",
    "lab": "the simulated lab, whole loop",
}


def sweep_view(sweep: SweepDocument, run: Run) -> list[RenderableType]:
    """How each setting ended, and the error after the first and the last trial."""
    numbers = ("worlds", "converged", "lost", "x mm", "y mm", "theta mrad")
    names = ("worlds", "converged", "lost", "error after", "x mm", "y mm", "theta mrad")
    table = columns("setting", *names, numbers=numbers)
    table.columns[0].no_wrap, table.columns[0].overflow = False, "fold"
    for setting in sweep.settings:
        name = " ".join(setting.overrides) or sweep.experiment
        shares = (f"{100 * setting.converged_share:.1f} %", f"{100 * setting.lost_share:.1f} %")
        table.add_row(name, str(setting.worlds), *shares, "trial 1", *_spread(setting.first_trial))
        if sweep.world == "lab":
            table.add_row("", "", "", "", "the last", *_spread(setting.last_trial), end_section=True)
    new = sweep.worlds - sweep.reused
    rows = [
        ("worlds", f"{sweep.worlds}, in {WORLDS[sweep.world]}"),
        ("drawn", " ".join(text for text in sweep.sets if ".." in text) or NONE),
        ("worked on", f"{new} in {sweep.seconds:.1f} s on {sweep.workers}; {sweep.reused} were there before"),
        ("numbers", f"sha256 {sweep.numbers_sha256[:16]}"),
    ]
    return [
        heading(f"run {run.id}", sweep.experiment),
        facts(rows),
        "",
        table,
        "",
        "errors: mean ± standard deviation of the true final pose, over the worlds that held the object",
        str(run.directory / sweep.table_file),
    ]


def sweep_trial_view(trial: SweepTrialDocument) -> list[RenderableType]:
    """One world: what was set, and where each trial ended."""
    numbers = ("trial", "x mm", "y mm", "theta mrad")
    table = columns("trial", "x mm", "y mm", "theta mrad", numbers=numbers)
    for number, one in enumerate(trial.trials, start=1):
        cells = ("lost", NONE, NONE) if one.error is None else planar(one.error.vector)
        table.add_row(str(number), *cells)
    rows = [("set", " ".join(trial.overrides) or NONE), ("outcome", trial.outcome)]
    if trial.why_ended is not None:
        rows.append(("because", trial.why_ended))
    return [heading(f"world {trial.index} of a sweep", trial.experiment), facts(rows), "", table]


def _spread(spread: Spread | None) -> tuple[str, str, str]:
    if spread is None:
        return NONE, NONE, NONE
    (x, y, theta), (x_std, y_std, theta_std) = spread.mean, spread.std
    return (
        f"{length_mm(x)} ± {length_mm(x_std)}",
        f"{length_mm(y)} ± {length_mm(y_std)}",
        f"{angle_mrad(theta)} ± {angle_mrad(theta_std)}",
    )
