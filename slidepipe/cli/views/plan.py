"""A plan as a person reads it."""

from collections.abc import Iterable

from rich.console import RenderableType
from rich.table import Table

from slidepipe.artifacts.plan import LimitCheck, PlanDocument, Robustness, Slide
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
        *_robustness(plan.robustness),
        *(str(run.file(output.role)) for output in run.manifest.outputs if output.role in ("plan", "figure")),
    ]


def _robustness(told: Robustness | None) -> list[RenderableType]:
    """What wrong friction does to the plan, and where the finger then ends."""
    if told is None:
        return []
    rows = [
        ("friction error survived", f"±{100 * told.friction_error:.1f} %"),
        ("  less friction", f"-{100 * told.below:.1f} %, then {told.binds_below}"),
        ("  more friction", f"+{100 * told.above:.1f} %, then {told.binds_above}"),
        (
            f"  within ±{100 * told.contraction_within:.0f} %",
            f"at most {100 * told.contraction:.0f} % of the way is left for the next trial",
        ),
    ]
    names = ("friction", "x mm", "y mm", "theta mrad", "left %")
    table = columns(*names, "outcome", numbers=names)
    for point in told.map:
        outcome = "survived" if point.survived else "failed"
        values = planar(point.relative_pose.vector)
        table.add_row(f"{point.friction:.3f}", *values, f"{100 * point.error_share:.0f}", outcome)
    return [facts(rows), "", table, ""]


def _facts(plan: PlanDocument) -> Table:
    believed = plan.believed
    x, y, theta = plan.object_velocity_at_slide
    kappa = number(believed.kappa_m_s2, "m/s²")
    friction = f"mu {believed.friction:.4f}"
    if believed.friction_std is not None:
        friction += f" ± {believed.friction_std:.4f}"
    rows = [
        ("reason", plan.reason),
        *([("best at", plan.objective)] if plan.objective else []),
        ("believed", f"{friction}, kappa {kappa}, rho {length_mm(believed.rho_m)} mm"),
        ("object at the start of sliding", f"x {fixed(x, 3)} m/s, y {fixed(y, 3)} m/s, theta {fixed(theta, 3)} rad/s"),
    ]
    if plan.normal_force_n is not None:
        rows.append(("normal force", number(plan.normal_force_n, "N")))
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
    tearing = slide.relative_acceleration
    braking = slide.braking_acceleration or tuple(-value for value in tearing)
    for name, start, stop, values in (
        ("  starting", slide.start_s, slide.switch_s, tearing),
        ("  braking", slide.switch_s, slide.stop_s, braking),
    ):
        numbers = [fixed(value, 3) for value in values]
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
