"""The ledger of a batch: one SQLite file with a row per job, correct at every moment."""

import json
import sqlite3
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import closing
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from toile.dressing.batch.outcome import FIGURES, Outcome
from toile.geometry.errors import InputError

NAME = "ledger.sqlite"
FORMAT = 1
COLUMNS = {
    "name": "TEXT PRIMARY KEY",
    "state": "TEXT NOT NULL",
    "failure_class": "TEXT NOT NULL DEFAULT ''",
    "message": "TEXT NOT NULL DEFAULT ''",
    "avatar": "TEXT NOT NULL",
    "garments": "TEXT NOT NULL",
    "fabrics": "TEXT NOT NULL",
    "quality": "TEXT NOT NULL",
    "attempts": "INTEGER NOT NULL DEFAULT 0",
    "wall_seconds": "REAL",
    "cpu_seconds": "REAL",
    "peak_memory": "INTEGER",
    **{name: kind for name, (kind, _) in FIGURES.items()},
    "published": "INTEGER NOT NULL DEFAULT 0",
    "started": "REAL",
    "ended": "REAL",
    "version": "TEXT NOT NULL DEFAULT ''",
    "fingerprint": "TEXT NOT NULL",
    "inputs": "TEXT NOT NULL",
    "settings": "TEXT NOT NULL",
    "seen": "INTEGER NOT NULL",
}
"""Columns and their types: the job, its outcome, what it used, its input."""
OUTCOME_COLUMNS = (
    "state", "failure_class", "message", "version", "published", "wall_seconds", "cpu_seconds", "peak_memory",
)  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Entry:
    """Entry about a job before it runs; settings and inputs as plain data."""

    name: str
    avatar: str
    garments: str
    fabrics: str
    quality: str
    fingerprint: str
    inputs: dict[str, str]
    settings: dict[str, Any]


class Ledger:
    """A batch's ledger, open for writing: the one process that runs the batch writes it."""

    def __init__(self, folder: Path) -> None:
        """Open or begin the ledger of a folder. Raises InputError if it is of another format or damaged."""
        self._connection = _connect(folder / NAME, "rwc")
        try:
            self._connection.execute("PRAGMA journal_mode = WAL")
            # Commits survive the end of the process; after a power cut, folders tell what the ledger lost.
            self._connection.execute("PRAGMA synchronous = NORMAL")
            columns = ", ".join(f'"{name}" {kind}' for name, kind in COLUMNS.items())
            with self._connection:
                self._connection.execute(f"CREATE TABLE IF NOT EXISTS jobs ({columns})")
                self._connection.execute(
                    "CREATE TABLE IF NOT EXISTS batch (id INTEGER PRIMARY KEY, started REAL, ended REAL, "
                    "pid INTEGER, total INTEGER)"
                )
                self._connection.execute("CREATE INDEX IF NOT EXISTS by_state ON jobs (state, failure_class)")
                if not self._connection.execute("PRAGMA user_version").fetchone()[0]:
                    self._connection.execute(f"PRAGMA user_version = {FORMAT}")
        except sqlite3.DatabaseError as error:
            if isinstance(error, sqlite3.OperationalError):
                raise
            raise InputError(
                f"{folder / NAME}: is not the ledger of a batch ({error}); move it away", file=folder / NAME
            ) from None
        _check_format(self._connection, folder)

    def begin_run(self, pid: int, total: int | None) -> None:
        """Note that a batch starts; jobs that an earlier one left running are pending again."""
        with self._connection:
            self._connection.execute("UPDATE jobs SET state = 'pending' WHERE state = 'running'")
            cursor = self._connection.execute(
                "INSERT INTO batch (started, pid, total) VALUES (?, ?, ?)", (time.time(), pid, total)
            )
        self._run = cursor.lastrowid

    def end_run(self) -> None:
        """Note that the batch has ended."""
        with self._connection:
            self._connection.execute("UPDATE jobs SET state = 'pending' WHERE state = 'running'")
            self._connection.execute("UPDATE batch SET ended = ? WHERE id = ?", (time.time(), self._run))

    def row(self, name: str) -> dict[str, Any] | None:
        """Return the row of a job, None if there is none."""
        found = self._connection.execute("SELECT * FROM jobs WHERE name = ?", (name,)).fetchone()
        return None if found is None else dict(found)

    def see(self, name: str) -> None:
        """Note that a job is part of this run. Raises InputError if it was seen in it before."""
        with self._connection:
            changed = self._connection.execute(
                "UPDATE jobs SET seen = ? WHERE name = ? AND seen <> ?", (self._run, name, self._run)
            ).rowcount
        if not changed:
            raise InputError(f"two jobs are named '{name}'; give each a name of its own", field="name")

    def register(self, entry: Entry) -> None:
        """Note a job, in place of what is known of one of that name."""
        row = self.row(entry.name)
        if row is not None and row["seen"] == self._run:
            raise InputError(f"two jobs are named '{entry.name}'; give each a name of its own", field="name")
        values = asdict(entry) | {
            "inputs": json.dumps(entry.inputs),
            "settings": json.dumps(entry.settings),
            "state": "pending",
            "seen": self._run,
        }
        names = ", ".join(values)
        marks = ", ".join("?" * len(values))
        with self._connection:
            self._connection.execute(
                f"INSERT OR REPLACE INTO jobs ({names}) VALUES ({marks})", tuple(values.values())
            )

    def start(self, name: str) -> int:
        """Note that a job starts; return the number of this attempt."""
        with self._connection:
            found = self._connection.execute(
                "UPDATE jobs SET state = 'running', attempts = attempts + 1, started = ? WHERE name = ? "
                "RETURNING attempts",
                (time.time(), name),
            ).fetchone()
        return int(found[0])

    def put_back(self, name: str) -> None:
        """Note that a job has not run after all."""
        with self._connection:
            self._connection.execute("UPDATE jobs SET state = 'pending' WHERE name = ?", (name,))

    def end(self, name: str, outcome: Outcome) -> None:
        """Record the outcome of a job."""
        values = {column: getattr(outcome, column) for column in OUTCOME_COLUMNS}
        values |= {column: outcome.figures.get(column) for column in FIGURES} | {"ended": time.time()}
        assignments = ", ".join(f"{column} = ?" for column in values)
        with self._connection:
            self._connection.execute(
                f"UPDATE jobs SET {assignments} WHERE name = ?", (*values.values(), name)
            )

    def close(self) -> None:
        """Close the file."""
        self._connection.close()


@dataclass(frozen=True, kw_only=True)
class Standing:
    """State of a batch.

    Attributes
    ----------
    states, failures
        Jobs by state, and failed ones by class.
    total
        Jobs in all, where the batch knew it.
    running
        (name, time since its start [s]) of the jobs under way.
    active
        Whether a batch runs; False also if it was killed.
    seconds, finished
        Time since the present or last run began (until it ended) [s], and jobs that have ended in it.
    """

    states: Counter[str]
    failures: Counter[str]
    total: int | None
    running: list[tuple[str, float]]
    active: bool
    seconds: float
    finished: int


def standing(folder: Path, *, active: bool) -> Standing:
    """Return the state of the batch in a folder, also while it runs."""
    with closing(_reading(folder)) as connection:
        states = Counter(dict(connection.execute("SELECT state, count(*) FROM jobs GROUP BY state")))
        failures = Counter(
            dict(
                connection.execute(
                    "SELECT failure_class, count(*) FROM jobs WHERE state = 'failed' GROUP BY failure_class"
                )
            )
        )
        now = time.time()
        running = [
            (name, now - started)
            for name, started in connection.execute(
                "SELECT name, started FROM jobs WHERE state = 'running' ORDER BY started"
            )
        ]
        last = connection.execute("SELECT * FROM batch ORDER BY id DESC LIMIT 1").fetchone()
        began = now if last is None else last["started"]
        until = now if last is None or active or last["ended"] is None else last["ended"]
        (finished,) = connection.execute("SELECT count(*) FROM jobs WHERE ended >= ?", (began,)).fetchone()
    return Standing(
        states=states,
        failures=failures,
        total=None if last is None else last["total"],
        running=running if active else [],
        active=active,
        seconds=until - began,
        finished=finished,
    )


def rows(folder: Path) -> Iterator[dict[str, Any]]:
    """Yield the rows of a batch's ledger, in the order of their names."""
    with closing(_reading(folder)) as connection:
        for row in connection.execute("SELECT * FROM jobs ORDER BY name"):
            yield dict(row)


def _reading(folder: Path) -> sqlite3.Connection:
    """Open a ledger for reading. Raises InputError if there is none."""
    path = folder / NAME
    if not path.is_file():
        raise InputError(
            f"{folder}: there is no batch here (no {NAME}); give the folder of toile batch -o", file=folder
        )
    connection = _connect(path, "ro")
    try:
        _check_format(connection, folder)
    except sqlite3.DatabaseError as error:
        connection.close()
        raise InputError(f"{path}: cannot be read ({error})", file=path) from None
    return connection


def _check_format(connection: sqlite3.Connection, folder: Path) -> None:
    """Raise InputError if a ledger is of another format than this version's."""
    (found,) = connection.execute("PRAGMA user_version").fetchone()
    if found != FORMAT:
        raise InputError(
            f"{folder / NAME}: has format {found}, this version of toile knows {FORMAT}; use another folder",
            file=folder / NAME,
        )


def _connect(path: Path, mode: str) -> sqlite3.Connection:
    """Return a connection to a file whose rows have names."""
    connection = sqlite3.connect(f"{path.absolute().as_uri()}?mode={mode}", uri=True, timeout=10.0)
    connection.row_factory = sqlite3.Row
    return connection
