"""A loop of trials as a person reads it: the truth stands beside the estimate."""

from rich.console import RenderableType
from rich.table import Table

from slidepipe.artifacts.campaign import CampaignDocument, CampaignRow
from slidepipe.artifacts.run import Run
from slidepipe.artifacts.values import Planar
from slidepipe.cli.views.tables import (
    NONE,
    angle_mrad,
    columns,
    friction,
    friction_interval,
    heading,
    length_mm,
    near,
    planar,
)

_NUMBERS = ("trial", "x\nmm", "y\nmm", "theta\nmrad", "error\nmm", "error\nmrad", "mu")


def campaign_view(campaign: CampaignDocument, run: Run) -> list[RenderableType]:
    """One block for each trial: planned, reached as estimated, and true; then the verdict and the pictures."""
    table = columns("trial", "finger on the object", *_NUMBERS[1:], "95 %\ninterval", numbers=_NUMBERS)
    for row in campaign.rows:
        _add(table, row)
    pictures = [str(run.directory / name) for name in campaign.pictures]
    return [heading(f"run {run.id}", campaign.experiment), table, "", *verdict(campaign), *pictures]


def verdict(campaign: CampaignDocument) -> list[str]:
    """How it ended, in one sentence, and what to do now in another."""
    count = f"{len(campaign.rows)} {'trial' if len(campaign.rows) == 1 else 'trials'}"
    said = {
        "converged": f"converged: within tolerance after {count}",
        "out of trials": f"not converged: still out of tolerance after {count}",
        "no progress": f"no progress: stopped after {count}",
        "lost": f"lost: the fingers did not hold the object to the end of trial {len(campaign.rows)}",
        "no plan": f"no plan: stopped after {count}",
    }[campaign.outcome]
    lines = [said if campaign.stopped_because is None else f"{said}: {campaign.stopped_because}"]
    if campaign.what_to_do is not None:
        lines.append(f"what to do: {campaign.what_to_do}")
    return lines


def _add(table: Table, row: CampaignRow) -> None:
    planned = row.planned_relative_pose.vector
    table.add_row(str(row.trial), "planned, believed", *planar(planned), "", "", friction(row.believed_friction), "")
    reached = row.reached_relative_pose
    simulated = row.true_relative_pose is not None or row.true_friction is not None
    table.add_row(
        "",
        _reached(row),
        *_pose(reached.vector if reached else None, planned),
        *_error(row.error_m, row.error_rad),
        friction(row.estimated_friction),
        friction_interval(row.estimated_friction_interval_95),
        end_section=not simulated,
    )
    if simulated:
        true = row.true_relative_pose
        table.add_row(
            "",
            "true",
            *_pose(true.vector if true else None, planned),
            *_error(row.true_error_m, row.true_error_rad),
            friction(row.true_friction),
            "",
            end_section=True,
        )


def _reached(row: CampaignRow) -> str:
    if row.outcome == "lost":
        return "lost"
    return "reached, WORSE" if row.worse else "reached, estimated"


def _pose(vector: Planar | None, planned: Planar) -> tuple[str, str, str]:
    return (NONE, NONE, NONE) if vector is None else planar(near(vector, planned))


def _error(error_m: float | None, error_rad: float | None) -> tuple[str, str]:
    return (
        NONE if error_m is None else length_mm(error_m),
        NONE if error_rad is None else angle_mrad(error_rad),
    )
