"""Which runs are asked for, and what is answered."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from slidepipe.artifacts.entry import Entry


@dataclass(frozen=True, slots=True)
class Condition:
    """A condition in SQL and the values of its question marks."""

    text: str
    values: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Query:
    """Runs for which everything holds that is given; times are those of the end of a run.

    Attributes
    ----------
    states : tuple of str
        Any of these.
    since, until : str, optional
        UTC as in the manifest, or the beginning of such a time; ``until`` itself is left out.
    begins : str, optional
        Beginning of the run's id, or of its random part.
    limit : int, optional
        Only so many, those that finished last.
    """

    experiment: str | None = None
    stage: str | None = None
    states: tuple[str, ...] = ()
    recipe: str | None = None
    since: str | None = None
    until: str | None = None
    begins: str | None = None
    limit: int | None = None

    @property
    def condition(self) -> Condition:
        """What must hold, in SQL."""
        parts = list(self._parts())
        text = " AND ".join(["fault IS NULL", *(part.text for part in parts)])
        return Condition(text, tuple(value for part in parts for value in part.values))

    def _parts(self) -> Iterator[Condition]:
        for text, value in (
            ("experiment = ?", self.experiment),
            ("stage = ?", self.stage),
            ("recipe = ?", self.recipe),
            ("finished >= ?", self.since),
            ("finished < ?", self.until),
        ):
            if value is not None:
                yield Condition(text, (value,))
        if self.states:
            yield Condition(f"state IN ({', '.join('?' * len(self.states))})", self.states)
        if self.begins is not None:
            ends = self.begins + "\x7f"
            yield Condition(
                "(run >= ? AND run < ? OR random >= ? AND random < ?)", (self.begins, ends, self.begins, ends)
            )


@dataclass(frozen=True, slots=True)
class Page:
    """Runs that were asked for, the earliest finished first.

    Attributes
    ----------
    total : int
        How many there are, shown or not.
    damaged : tuple of Entry
        Runs that cannot be read, whatever was asked for.
    drafts : tuple of Path
        Staging directories: of runs in the making, or of processes that were killed.
    """

    entries: tuple[Entry, ...] = ()
    total: int = 0
    damaged: tuple[Entry, ...] = ()
    drafts: tuple[Path, ...] = ()
