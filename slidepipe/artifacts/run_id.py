"""Names of runs: the second in UTC in which a run began, and 40 random bits. Never a counter."""

import re
import secrets
from datetime import datetime

ALPHABET = "0123456789abcdefghjkmnpqrstvwxyz"
"""Base 32 in lower case without the letters that are taken for digits."""

STAGING = ".tmp-"
"""What the name of a draft begins with; a day's directory holds drafts beside runs."""

_PATTERN = re.compile(r"(\d{4})(\d\d)(\d\d)T\d{6}Z-[0-9a-hjkmnp-tv-z]{8}")


def new_run_id(begun: datetime) -> str:
    """Name for a run that began then, in UTC.

    Examples
    --------
    >>> new_run_id(datetime(2026, 11, 23, 9, 30, 12))[:17]
    '20261123T093012Z-'
    """
    bits = secrets.randbits(40)
    random = "".join(ALPHABET[bits >> shift & 31] for shift in range(35, -1, -5))
    return f"{begun:%Y%m%dT%H%M%SZ}-{random}"


def day_of(run_id: str) -> str | None:
    """Day of a run id as its directory is called; None where it is no run id.

    Examples
    --------
    >>> day_of("20261123T093012Z-k3f9q2aw")
    '2026-11-23'
    """
    match = _PATTERN.fullmatch(run_id)
    return "-".join(match.groups()) if match else None
