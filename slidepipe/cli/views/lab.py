"""What was found in a lab, and how a played one kept time."""

from rich.console import RenderableType
from rich.text import Text

from slidepipe.cli.views.tables import facts, fixed, heading, length_mm
from slidepipe.stages.lab_check import LabCheck
from slidepipe.stages.serve import ServeResult


def check_view(check: LabCheck) -> list[RenderableType]:
    """Facts about the arm, then about the cameras."""
    parts: list[RenderableType] = [heading(f"lab {check.lab.name}", "sound" if check.sound else "not sound")]
    for about in dict.fromkeys(fact.about for fact in check.facts):
        rows = [
            (fact.name, fact.value if fact.sound else f"{fact.value}  <- not as it should be")
            for fact in check.facts
            if fact.about == about
        ]
        parts += ["", Text(about, style="bold"), facts(rows)]
    return parts


def serve_view(served: ServeResult) -> list[RenderableType]:
    """How it kept time, and where the finger is now."""
    x, y, theta = served.relative_pose
    rows = [
        ("ticks", f"{served.ticks}, {served.late_ticks} of them more than 5 ms late"),
        ("lateness", f"{fixed(1e6 * served.late_p99_s, 0)} us in 99 %, {fixed(1e6 * served.late_max_s, 0)} us at most"),
        ("links", str(served.links)),
        ("limp", f"{served.lost_links}, each when no more commands came" if served.lost_links else "0"),
        ("finger on the object", f"{length_mm(x)} mm, {length_mm(y)} mm, {fixed(1e3 * theta, 1)} mrad"),
        *(("not permitted", line) for line in served.refused),
    ]
    return [heading("served"), facts(rows)]
