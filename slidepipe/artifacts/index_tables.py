"""The tables of the index: days, whose directories tell when something changed, and runs."""

import json
import os
import sqlite3
import tempfile
import zlib
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from slidepipe.artifacts.entry import MANIFEST, Entry, Stamp, read_entry
from slidepipe.artifacts.query import Condition, Page
from slidepipe.artifacts.run_id import STAGING, day_of

MEMORY = ":memory:"
VERSION = 1
"""Of the tables; an index of another version is thrown away."""
SETTLED_NS = 3_000_000_000
"""A directory that changed less long ago is looked at again: its clock may be too coarse to tell the next change."""
WAIT_S = 5.0
BATCH = 2000
"""Runs that are read before they are written: who is killed while the index is made loses no more than these."""
_TABLES = f"""
BEGIN IMMEDIATE;
CREATE TABLE IF NOT EXISTS days (day TEXT PRIMARY KEY, changed_ns INTEGER, settled INTEGER, runs INTEGER, drafts TEXT);
CREATE TABLE IF NOT EXISTS runs (
    run TEXT PRIMARY KEY, random TEXT, day TEXT, stage TEXT, experiment TEXT, state TEXT, recipe TEXT, started TEXT,
    finished TEXT, fault TEXT, more TEXT, modified_ns INTEGER, size INTEGER, inode INTEGER, crc INTEGER
) WITHOUT ROWID;
CREATE INDEX IF NOT EXISTS by_random ON runs (random);
CREATE INDEX IF NOT EXISTS by_day ON runs (day);
CREATE INDEX IF NOT EXISTS by_time ON runs (finished, run, fault, experiment, stage, state);
CREATE INDEX IF NOT EXISTS by_recipe ON runs (recipe);
CREATE INDEX IF NOT EXISTS by_fault ON runs (finished, run) WHERE fault IS NOT NULL;
PRAGMA user_version = {VERSION};
COMMIT;
"""
_INSERT = "INSERT OR REPLACE INTO runs VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)"
_COLUMNS = "run, day, stage, experiment, state, recipe, started, finished, fault, more, modified_ns, size, inode"


class DamagedError(Exception):
    """The index does not hold what was written."""


@dataclass(frozen=True, slots=True)
class _Row:
    entry: Entry
    stamp: Stamp


class Tables:
    """An open index over the directory that holds the days; ``place`` is a file, or :data:`MEMORY`."""

    def __init__(self, runs: Path, place: str) -> None:
        self._runs, self._place = runs, place
        self._database = sqlite3.connect(place, timeout=WAIT_S, isolation_level=None)
        self._database.execute("PRAGMA synchronous = OFF")
        (version,) = self._database.execute("PRAGMA user_version").fetchone()
        if version == 0:
            self._database.executescript(_TABLES)
        elif version != VERSION:
            raise DamagedError(f"version {version}")

    def close(self) -> None:
        """Let the file go."""
        self._database.close()

    def refresh(self) -> None:
        """Look again at every day whose directory changed."""
        known = {day: (changed, settled) for day, changed, settled in self._days()}
        there = {path.name: path for path in self._runs.iterdir() if path.is_dir()}
        for day in known.keys() - there.keys():
            self._forget(day)
        for day, path in sorted(there.items()):
            changed_ns = path.stat().st_mtime_ns
            if known.get(day) != (changed_ns, 1):
                self._look(path, changed_ns)

    def page(self, condition: Condition, limit: int | None) -> Page:
        """Runs that a condition holds for; rows whose manifest looks otherwise by now are read again before."""
        while True:
            rows = self._rows(condition, limit)
            changed = [row.entry.directory for row in rows if _stamp(row.entry.directory) != row.stamp]
            if not changed:
                break
            self._renew(changed)
        total = len(rows) if limit is None else self._count(condition)
        return Page(tuple(row.entry for row in rows), total)

    def faults(self) -> tuple[Entry, ...]:
        """Runs that cannot be read."""
        return self.page(Condition("fault IS NOT NULL"), None).entries

    def drafts(self) -> tuple[Path, ...]:
        """Directories of runs that are in the making, or whose process was killed."""
        days = self._database.execute("SELECT day, drafts FROM days WHERE drafts != '[]' ORDER BY day").fetchall()
        return tuple(self._runs / day / name for day, names in days for name in json.loads(names))

    def _days(self) -> Iterable[tuple[str, int, int]]:
        """Days with when they changed and whether that is long ago; a day that lacks rows counts as never seen."""
        return self._database.execute(
            "SELECT day, changed_ns, settled FROM days"
            " WHERE runs = (SELECT count(*) FROM runs WHERE runs.day = days.day)"
        ).fetchall()

    def _count(self, condition: Condition) -> int:
        text = f"SELECT count(*) FROM runs WHERE {condition.text}"  # noqa: S608  # its text is our own
        (count,) = self._database.execute(text, condition.values).fetchone()
        return int(count)

    def _rows(self, condition: Condition, limit: int | None) -> list[_Row]:
        text = (
            f"SELECT {_COLUMNS}, crc FROM runs WHERE {condition.text}"  # noqa: S608  # its text is our own
            " ORDER BY finished DESC, run DESC LIMIT ?"
        )
        found = self._database.execute(text, (*condition.values, -1 if limit is None else limit)).fetchall()
        return [self._row(*values) for values in reversed(found)]

    def _row(self, *values: object) -> _Row:
        *columns, crc = values
        if crc != _crc(columns):
            raise DamagedError("a row does not match its checksum")
        run, day, stage, experiment, state, recipe, started, finished, fault, more, *stamp = columns
        seed, inputs, results = json.loads(str(more))
        return _Row(
            Entry(
                run=str(run),
                directory=self._runs / str(day) / str(run),
                stage=str(stage),
                experiment=str(experiment),
                state=str(state),
                recipe=str(recipe),
                started=str(started),
                finished=str(finished),
                seed=seed,
                inputs=tuple(inputs),
                results=tuple(results),
                fault=None if fault is None else str(fault),
            ),
            Stamp(*(int(str(part)) for part in stamp)),
        )

    def _look(self, path: Path, changed_ns: int) -> None:
        """Make a day's rows what its directory holds; it was last changed at ``changed_ns`` before."""
        settled = self._now_ns() - changed_ns > SETTLED_NS
        names = os.listdir(path)  # noqa: PTH208  # a tenth of the time
        there = {name for name in names if day_of(name) == path.name}
        drafts = json.dumps(sorted(name for name in names if day_of(name.removeprefix(STAGING)) and name not in there))
        known = {run for (run,) in self._database.execute("SELECT run FROM runs WHERE day = ?", (path.name,))}
        self._remove(known - there)
        new = sorted(there - known)
        for start in range(0, len(new), BATCH):
            self._renew([path / name for name in new[start : start + BATCH]])
        with self._transaction():
            (count,) = self._database.execute("SELECT count(*) FROM runs WHERE day = ?", (path.name,)).fetchone()
            row = (path.name, changed_ns, int(settled and count == len(there)), count, drafts)
            self._database.execute("INSERT OR REPLACE INTO days VALUES (?, ?, ?, ?, ?)", row)

    def _renew(self, directories: list[Path]) -> None:
        """Read runs again; a run that is gone is forgotten."""
        rows, gone = [], []
        for directory in directories:
            stamp = _stamp(directory)  # before the file is read: a change meanwhile is seen the next time
            entry = read_entry(directory)
            if entry is None:
                gone.append(directory.name)
            else:
                rows.append(_values(entry, stamp))
        self._remove(gone)
        with self._transaction():
            self._database.executemany(_INSERT, rows)

    def _forget(self, day: str) -> None:
        with self._transaction():
            self._database.execute("DELETE FROM runs WHERE day = ?", (day,))
            self._database.execute("DELETE FROM days WHERE day = ?", (day,))

    def _remove(self, names: Iterable[str]) -> None:
        gone = [(name,) for name in names]
        if gone:
            with self._transaction():
                self._database.executemany("DELETE FROM runs WHERE run = ?", gone)

    def _transaction(self) -> sqlite3.Connection:
        self._database.execute("BEGIN IMMEDIATE")
        return self._database

    def _now_ns(self) -> int:
        """Read the file system's own clock, which on a shared one is another machine's."""
        if self._place == MEMORY:
            return 0
        with tempfile.NamedTemporaryFile(dir=Path(self._place).parent, prefix=".clock-") as probe:
            probe.write(b"0")
            probe.flush()
            return os.fstat(probe.fileno()).st_mtime_ns


def _stamp(directory: Path) -> Stamp:
    try:
        return Stamp.of(directory / MANIFEST)
    except OSError:
        return Stamp(0, 0, 0)


def _values(entry: Entry, stamp: Stamp) -> tuple[object, ...]:
    more = json.dumps([entry.seed, entry.inputs, entry.results])
    day = entry.directory.parent.name
    columns = [
        *(entry.run, day, entry.stage, entry.experiment, entry.state, entry.recipe, entry.started, entry.finished),
        *(entry.fault, more, stamp.modified_ns, stamp.size, stamp.inode),
    ]
    return entry.run, entry.run.partition("-")[2], *columns[1:], _crc(columns)


def _crc(columns: Iterable[object]) -> int:
    return zlib.crc32(repr(list(columns)).encode())
