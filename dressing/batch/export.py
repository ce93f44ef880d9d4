"""A batch's ledger as a table: CSV, or Parquet where pyarrow is installed."""

import csv
from collections.abc import Iterator
from itertools import chain, islice
from pathlib import Path
from typing import Any

from toile.dressing.batch.ledger import COLUMNS, rows
from toile.dressing.files.writers.atomic import replacing, writable_folder
from toile.geometry.errors import InputError

FORMATS = (".csv", ".parquet")
EXPORTED = tuple(name for name in COLUMNS if name != "seen")
AT_ONCE = 10_000
"""Rows of a Parquet file that are in memory at a time."""


def export(folder: Path, path: Path) -> int:
    """Write all rows of a batch's ledger to a .csv or .parquet file and return their number."""
    kind = path.suffix.lower()
    if kind not in FORMATS:
        raise InputError(
            f"{path}: unknown kind of table '{kind}'; use one of {', '.join(FORMATS)}", file=path
        )
    table = rows(folder)
    first = next(table, None)  # before the file is begun: the folder may be none of a batch
    every = chain([] if first is None else [first], table)
    writable_folder(path.parent)
    with replacing(path) as temporary:
        return _write_csv(temporary, every) if kind == ".csv" else _write_parquet(temporary, every)


def _write_csv(path: Path, table: Iterator[dict[str, Any]]) -> int:
    """Write a CSV file."""
    count = 0
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, EXPORTED, extrasaction="ignore", lineterminator="\n")
        writer.writeheader()
        for row in table:
            writer.writerow(row)
            count += 1
    return count


def _write_parquet(path: Path, table: Iterator[dict[str, Any]]) -> int:
    """Write a Parquet file."""
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        raise InputError(
            f"{path.suffix} needs pyarrow: pip install 'toile[parquet]', or export to .csv"
        ) from None
    kinds = {"TEXT": pyarrow.string(), "REAL": pyarrow.float64(), "INTEGER": pyarrow.int64()}
    schema = pyarrow.schema([(name, kinds[COLUMNS[name].split()[0]]) for name in EXPORTED])
    count = 0
    with pyarrow.parquet.ParquetWriter(path, schema) as writer:
        while part := list(islice(table, AT_ONCE)):
            columns = {name: [row[name] for row in part] for name in EXPORTED}
            writer.write_table(pyarrow.table(columns, schema=schema))
            count += len(part)
    return count
