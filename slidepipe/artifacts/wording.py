"""How messages show values."""

from collections.abc import Mapping, Sequence


def describe(value: object) -> str:
    """Value as a message shows it: numbers and text as they are, at most 60 characters."""
    if value is None:
        return "nothing"
    if isinstance(value, Mapping):
        return "a mapping"
    if isinstance(value, Sequence) and not isinstance(value, str):
        return "a list"
    text = str(value).lower() if isinstance(value, bool) else repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."


def one_of(candidates: Sequence[str], limit: int = 5) -> str:
    """Names for a message, the first few of them.

    Examples
    --------
    >>> one_of(["a", "b", "c"], limit=2)
    'a, b and 1 more'
    """
    shown = ", ".join(candidates[:limit])
    return shown if len(candidates) <= limit else f"{shown} and {len(candidates) - limit} more"
