"""Fixtures shared by all tests."""

import os
from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def data_dir() -> Path:
    """Folder of real bodies and patterns; tests that need it are skipped where it is missing."""
    default = Path(__file__).resolve().parents[2] / "shared" / "data"
    folder = Path(os.environ.get("TOILE_DATA", default))
    if not folder.is_dir():
        pytest.skip(f"no real bodies and patterns at {folder} (set TOILE_DATA)")
    return folder
