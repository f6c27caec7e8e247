"""Why the next plan is as it is, and what was learned of the arm, as a person reads them."""

from rich.console import RenderableType

from slidepipe.artifacts.arm_correction import ArmCorrectionDocument, Joints
from slidepipe.artifacts.values import Interval
from slidepipe.artifacts.why import ErrorOf, ExpectedError, WhyDocument
from slidepipe.cli.views.tables import angle_mrad, columns, facts, heading, length_mm, planar


def why_view(why: WhyDocument) -> list[RenderableType]:
    """Error before, expected after, and what was changed in between."""
    rows = [
        ("error before", _before(why.error_before)),
        ("expected after", _expected(why.expected_after)),
        ("", _chances(why.expected_after)),
        *(("changed" if index == 0 else "", line) for index, line in enumerate(why.changed)),
    ]
    return [heading("why this plan", f"trial {why.trial}, iteration.way: {why.way}"), facts(rows)]


def arm_view(arm: ArmCorrectionDocument) -> list[RenderableType]:
    """By how many per cent each joint differs from the arm's table."""
    numbers = [f"joint {joint}" for joint in range(1, 8)]
    table = columns("% beside the table", *numbers, numbers=numbers)
    for name, values, stds in (
        ("moving mass", arm.moving_mass, arm.moving_mass_std),
        ("resting mass", arm.resting_mass, arm.resting_mass_std),
        ("dry friction", arm.coulomb, arm.coulomb_std),
        ("viscous friction", arm.viscous, arm.viscous_std),
    ):
        table.add_row(name, *_shares(values, stds))
    table.add_row("missing torque, N m", *(f"{value:.3f}" for value in arm.torque_rms_n_m))
    table.add_row("left of it, N m", *(f"{value:.3f}" for value in arm.left_rms_n_m))
    trials = f"{len(arm.trials)} {'trial' if len(arm.trials) == 1 else 'trials'}"
    return [heading("the arm as learned", f"from {trials}"), table]


def _before(error: ErrorOf | None) -> str:
    if error is None:
        return "the object was lost"
    x, y, theta = planar(error.pose.vector)
    distance, angle = length_mm(error.position_m), angle_mrad(error.angle_rad)
    return f"{distance} mm and {angle} mrad (x {x} mm, y {y} mm, theta {theta} mrad)"


def _expected(told: ExpectedError) -> str:
    position, angle = length_mm(told.position_m), angle_mrad(told.angle_rad)
    return (
        f"{position} mm, 95 % {_span(told.position_interval_95_m)}; "
        f"{angle} mrad, 95 % {_span(told.angle_interval_95_rad, digits=1)}"
    )


def _chances(told: ExpectedError) -> str:
    return (
        f"within tolerance {100 * told.within_tolerance_share:.0f} %, lost {100 * told.lost_share:.0f} % of "
        f"{told.draws} worlds; the model misses by {100 * told.model_miss_share:.1f} % of a slide"
    )


def _span(interval: Interval, digits: int = 2) -> str:
    low, high = (1e3 * end for end in interval)
    return f"[{low:.{digits}f}, {high:.{digits}f}]"


def _shares(values: Joints, stds: Joints) -> list[str]:
    return [f"{100 * value:+.0f} ± {100 * std:.0f}" for value, std in zip(values, stds, strict=True)]
