"""How messages show values."""

import re
from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from types import MappingProxyType

UNITS = MappingProxyType(
    {
        "kg": "kg",
        "m": "m",
        "s": "s",
        "ns": "ns",
        "rad": "rad",
        "n": "N",
        "hz": "Hz",
        "ppm": "ppm",
        "n_m": "N m",
        "m_s": "m/s",
        "m_s2": "m/s^2",
        "rad_s": "rad/s",
        "rad_s2": "rad/s^2",
        "rad_s3": "rad/s^3",
    }
)
"""What the end of a key says of the unit of its value."""
_ENDING = re.compile(f"_({'|'.join(UNITS)})$")


def unit_of(key: str) -> str:
    """Unit that a key names at its end; empty where it names none.

    Examples
    --------
    >>> unit_of("joint_torque_n_m"), unit_of("mass_kg"), unit_of("name")
    ('N m', 'kg', '')
    """
    ending = _ENDING.search(key)
    return UNITS[ending[1]] if ending else ""


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


def nearest(asked: str, names: Mapping[str, str]) -> str:
    """Name that may have been meant, as the end of a message, each shown as it is mapped to; empty where none is near.

    Examples
    --------
    >>> nearest("robst", {"robust": "experiments/robust.yaml"})
    '; did you mean experiments/robust.yaml?'
    """
    near = get_close_matches(asked, names, n=1)
    return f"; did you mean {names[near[0]]}?" if near else ""


def instead(asked: str, names: Sequence[str]) -> str:
    """What there is where a name is not there, for a message.

    Examples
    --------
    >>> instead("nolab", ["loopback", "wam"])
    'there are loopback, wam'
    >>> instead("robst", ["robust"])
    'there is robust; did you mean robust?'
    """
    if not names:
        return "there are none"
    meant = nearest(asked, {name: name for name in names})
    return f"there {'is' if len(names) == 1 else 'are'} {one_of(names, 8)}{meant}"
