"""A few mutated inputs of every kind; `python -m tests.fuzz` tries more."""

from pathlib import Path

import pytest

from tests.fuzz.fuzz import fuzz
from tests.fuzz.readers import READERS, valid_files

COUNT = 100
SLOW = {
    "dxf": 20,
    "svg": 15,
    "seams": 15,
    "measurements": 15,
    "dirty": 20,
    "placed": 40,
    "vrm": 30,
    "usd": 40,
}
"""Inputs of readers that do more than read: all of them together take seconds."""


@pytest.mark.parametrize("name", READERS)
def test_broken_inputs_are_refused_in_one_line(name: str, tmp_path: Path) -> None:
    assert [finding.what for finding in fuzz(name, SLOW.get(name, COUNT), tmp_path)] == []


@pytest.mark.parametrize("name", READERS)
def test_what_is_mutated_is_valid(name: str, tmp_path: Path) -> None:
    """Every input is read in at least one way."""
    for suffix, data in valid_files(name):
        path = tmp_path / f"a{suffix}"
        path.write_bytes(data)
        results = []
        for read in READERS[name].reads:
            try:
                results.append(read(path))
            except ValueError:
                continue
        assert any(result is not None for result in results)
