"""An index of the runs in SQLite: a cache that may be deleted, be damaged or be behind at any time.

The directories are the truth. Before every question the days whose directory changed are looked at again, and every
row that is given out is compared with its manifest's time and size. Where the index cannot be written, or machines
quarrel about it on a file system without locks, the same question goes to an index in memory.
"""

import sqlite3
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from slidepipe.artifacts.index_tables import MEMORY, DamagedError, Tables
from slidepipe.artifacts.query import Page, Query

FILE = Path(".index") / "index.sqlite"


@dataclass(frozen=True, slots=True)
class Index:
    """Index of the store below ``root``; nothing is written where there is no store yet."""

    root: Path

    def find(self, query: Query) -> Page:
        """Find runs as they are in the store now."""
        if not (self.root / "runs").is_dir():
            return Page()
        file = self.root / FILE
        for _ in range(2):
            try:
                file.parent.mkdir(exist_ok=True)
                return self._find(str(file), query)
            except sqlite3.OperationalError as error:
                if "malformed" not in str(error):  # it is locked, or cannot be written
                    break
                self.drop()
            except (sqlite3.DatabaseError, DamagedError, ValueError):
                self.drop()
            except OSError:
                break
        return self._find(MEMORY, query)

    def rebuild(self) -> int:
        """Throw the index away and make it anew; tells how many runs there are."""
        self.drop()
        return self.find(Query(limit=0)).total

    def drop(self) -> None:
        """Throw the index away."""
        file = self.root / FILE
        for path in file.parent.glob(f"{file.name}*"):
            path.unlink(missing_ok=True)

    def _find(self, place: str, query: Query) -> Page:
        with closing(Tables(self.root / "runs", place)) as tables:
            tables.refresh()
            tables.faults()  # those that are whole again are found with the others
            found = tables.page(query.condition, query.limit)
            return Page(found.entries, found.total, tables.faults(), tables.drafts())
