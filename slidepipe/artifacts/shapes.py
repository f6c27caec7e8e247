"""Text of a certain shape: its pattern, and what a message says of it."""

from types import MappingProxyType

SLUG = r"^[a-z0-9][a-z0-9_-]{0,63}$"
RUN_ID = r"^[0-9]{8}T[0-9]{6}Z-[0-9a-hjkmnp-tv-z]{8}$"
SHA256 = r"^[0-9a-f]{64}$"
INSTANT = r"^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{6}Z$"
HOST = r"^(\d{1,3}\.){3}\d{1,3}$"

IN_WORDS = MappingProxyType(
    {
        SLUG: "at most 64 of a to z, 0 to 9, _ and -, a letter or digit first",
        RUN_ID: "a run id such as 20261124T093012Z-8x3k2m9q",
        SHA256: "64 of 0 to 9 and a to f",
        INSTANT: "a time in UTC such as 2026-11-24T09:30:12.000000Z",
        HOST: "an IPv4 address such as 127.0.0.1",
    }
)
"""What text must be that a pattern allows."""
