"""A plan as a person reads it."""

from collections.abc import Iterable

from rich.console import RenderableType
from rich.table import Table

from slidepipe.artifacts.plan import LimitCheck, PlanDocument, Slide
from slidepipe.artifacts.run import Run
from slidepipe.cli.views.tables import NONE, columns, facts, fixed, heading, length_mm, number, planar

NEAREST = 5
"""Limits that are shown beside the margins and the peak speeds, unless all are asked for."""


def plan_view(plan: PlanDocument, run: Run, *, all_limits: bool) -> list[RenderableType]:
    """Phases, poses, the velocity at the start of sliding, and how near the motion comes to its limits."""
    return [
        heading(f"plan {run.id}", f"{plan.experiment}, trial {plan.trial}"),
        _facts(plan),
        "",
        _poses(plan),
        "",
        _phases(plan),
        "",
        _limits(_chosen(plan, all_limits=all_limits)),
        "",
        str(run.directory / "plan.yaml"),
    ]


def _facts(plan: PlanDocument) -> Table:
    believed = plan.believed
    x, y, theta = plan.object_velocity_at_slide
    kappa = number(believed.kappa_m_s2, "m/s²")
    friction = f"mu {believed.friction:.4f}"
    if believed.friction_std is not None:
        friction += f" ± {believed.friction_std:.4f}"
    rows = [
        ("reason", plan.reason),
        ("believed", f"{friction}, kappa {kappa}, rho {length_mm(believed.rho_m)} mm"),
        ("object at the start of sliding", f"x {fixed(x, 3)} m/s, y {fixed(y, 3)} m/s, theta {fixed(theta, 3)} rad/s"),
    ]
    if plan.previous_estimate:
        rows.insert(1, ("from estimate", plan.previous_estimate))
    return facts(rows)


def _poses(plan: PlanDocument) -> Table:
    names = ("x mm", "y mm", "theta mrad")
    table = columns("pose", *names, numbers=names)
    table.add_row("finger on the object, before", *planar(plan.start_relative_pose.vector))
    table.add_row("finger on the object, after", *planar(plan.goal_relative_pose.vector))
    table.add_row("hand in the plane, before", *planar(plan.hand_start_pose.vector))
    table.add_row("hand in the plane, after", *planar(plan.hand_end_pose.vector))
    return table


def _phases(plan: PlanDocument) -> Table:
    names = ("from s", "to s", "x m/s²", "y m/s²", "theta rad/s²")
    table = columns("phase", *names, "acceleration of", numbers=names)
    for phase in plan.phases:
        known = phase.object_acceleration
        numbers = [NONE] * 3 if known is None else [fixed(value, 3) for value in known]
        table.add_row(phase.name, fixed(phase.start_s, 3), fixed(phase.stop_s, 3), *numbers, "the object in the plane")
        if phase.name == "slide":
            _add_halves(table, plan.slide)
    return table


def _add_halves(table: Table, slide: Slide) -> None:
    """Two halves of the bang-bang slide."""
    for name, start, stop, sign in (
        ("  starting", slide.start_s, slide.switch_s, 1.0),
        ("  braking", slide.switch_s, slide.stop_s, -1.0),
    ):
        numbers = [fixed(sign * value, 3) for value in slide.relative_acceleration]
        table.add_row(name, fixed(start, 3), fixed(stop, 3), *numbers, "the finger on the object")


def _limits(checks: Iterable[LimitCheck]) -> Table:
    numbers = ("reached", "bound", "used", "at s")
    table = columns("limit", *numbers, numbers=numbers)
    table.columns[0].no_wrap = False
    for check in checks:
        used = _used(check)
        percent = NONE if used is None else f"{100.0 * used:.0f} %"
        reached, bound = number(check.value, check.unit), number(check.bound, check.unit)
        table.add_row(check.name, reached, bound, percent, fixed(check.time_s, 3))
    return table


def _chosen(plan: PlanDocument, *, all_limits: bool) -> list[LimitCheck]:
    """Margins, peak speeds, and the limits nearest to their bounds, or all of them."""
    if all_limits:
        return [*plan.margins, *plan.limits]
    speeds = [check for check in plan.limits if check.unit == "m/s"]
    others = [check for check in plan.limits if check not in speeds]
    return [*plan.margins, *speeds, *sorted(others, key=lambda check: -(_used(check) or 0.0))[:NEAREST]]


def _used(check: LimitCheck) -> float | None:
    """Share of the bound that is used; None where the bound is no measure for it."""
    return check.value / check.bound if check.bound > 0.0 else None
