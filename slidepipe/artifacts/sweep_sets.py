"""What a sweep sets: ``key=value`` for all worlds, ``key=[a, b]`` for a grid, ``key=low..high`` drawn for each."""

import itertools
import re
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from slidepipe.artifacts.strict_yaml import parse_text
from slidepipe.errors import InputError

_RANGE = re.compile(r"\s*(\S+?)\s*\.\.\s*(\S+)\s*")


@dataclass(frozen=True, slots=True)
class Drawn:
    """Key that is drawn evenly between two ends for each world."""

    key: str
    low: float
    high: float


@dataclass(frozen=True, slots=True)
class Listed:
    """Key that takes each of some values, as YAML text."""

    key: str
    values: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class SweepSets:
    """Everything that a sweep sets, in the order in which it was given."""

    fixed: tuple[str, ...]
    listed: tuple[Listed, ...]
    drawn: tuple[Drawn, ...]

    def settings(self) -> list[tuple[str, ...]]:
        """Every combination of the lists, as overrides.

        Examples
        --------
        >>> read_sets(["friction=[0.3, 0.4]", "lab.seed=7"]).settings()
        [('lab.seed=7', 'friction=0.3'), ('lab.seed=7', 'friction=0.4')]
        """
        choices = [[f"{one.key}={value}" for value in one.values] for one in self.listed]
        return [(*self.fixed, *chosen) for chosen in itertools.product(*choices)]

    def draw(self, seed: int, index: int) -> tuple[str, ...]:
        """Overrides of one world: the same for the same seed and index, wherever and whenever it is drawn.

        Examples
        --------
        >>> read_sets(["lab.friction=0.3..0.5"]).draw(1, 0) == read_sets(["lab.friction=0.3..0.5"]).draw(1, 0)
        True
        """
        shares = np.random.default_rng([seed, index]).random(len(self.drawn))
        return tuple(
            f"{one.key}={float(one.low + (one.high - one.low) * share)!r}"
            for one, share in zip(self.drawn, shares, strict=True)
        )


def read_sets(sets: Iterable[str]) -> SweepSets:
    """Read the ``--set`` options of a sweep.

    Raises
    ------
    InputError
        There is no ``=``, a list is empty or no YAML, or the ends of a range are not two growing numbers.
    """
    fixed: list[str] = []
    listed: list[Listed] = []
    drawn: list[Drawn] = []
    for text in sets:
        key, equals, value = text.partition("=")
        key = key.strip()
        if not equals or not key:
            raise InputError(f"--set {text}: must read key=value, key=[value, value] or key=low..high")
        span = _RANGE.fullmatch(value)
        if span:
            drawn.append(_drawn(key, span, text))
        elif value.strip().startswith("["):
            listed.append(Listed(key, _values(value, text)))
        else:
            fixed.append(text)
    return SweepSets(tuple(fixed), tuple(listed), tuple(drawn))


def _drawn(key: str, span: re.Match[str], text: str) -> Drawn:
    try:
        low, high = float(span[1]), float(span[2])
    except ValueError:
        raise InputError(f"--set {text}: the ends of a range must be two numbers, low..high") from None
    if not (np.isfinite(low) and np.isfinite(high) and low < high):
        raise InputError(f"--set {text}: a range must grow from low to high")
    return Drawn(key, low, high)


def _values(value: str, text: str) -> tuple[str, ...]:
    try:
        values = parse_text(value, "value")
    except InputError as error:
        raise InputError(f"--set {text}: {error}") from None
    if not isinstance(values, list) or not values:
        raise InputError(f"--set {text}: a list must have one value or more")
    return tuple(_yaml(one) for one in values)


def _yaml(value: object) -> str:
    """Value as YAML text on one line."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, list):
        return f"[{', '.join(_yaml(one) for one in value)}]"
    return value if isinstance(value, str) else repr(value)
