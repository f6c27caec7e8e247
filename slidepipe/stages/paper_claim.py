"""One number of the paper beside ours."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Claim:
    """One number of the paper beside ours, as they are printed."""

    where: str
    what: str
    paper: str
    ours: str
    difference: str
    reason: str


def less(difference: float, unit: str = "") -> str:
    """Return a difference, or that there is none beside rounding."""
    return "none" if abs(difference) < 1e-9 else f"{difference:+.2g} {unit}".rstrip()
