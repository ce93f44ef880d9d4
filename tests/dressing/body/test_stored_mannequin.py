"""The mannequin on disk is the one that is built, and what cannot be read or written is no obstacle."""

from pathlib import Path

import numpy as np
import pytest

from toile.dressing.body import stored_mannequin as module
from toile.dressing.body.avatar import Avatar
from toile.dressing.body.mannequin import mannequin
from toile.dressing.body.stored_mannequin import stored_mannequin


@pytest.fixture(scope="module")
def built() -> Avatar:
    return mannequin()


def refuse() -> Avatar:
    raise AssertionError("it was built again")


def equal(one: Avatar, other: Avatar) -> bool:
    assert one.vertices.dtype == other.vertices.dtype and one.faces.dtype == other.faces.dtype
    assert one.name == other.name and one.notes == other.notes
    return np.array_equal(one.vertices, other.vertices) and np.array_equal(one.faces, other.faces)


def test_it_is_built_once_and_read_afterwards(
    built: Avatar, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("TOILE_CACHE_DIR", str(tmp_path / "new"))
    monkeypatch.setattr(module, "mannequin", lambda: built)
    assert equal(stored_mannequin(), built)
    (stored,) = (tmp_path / "new").iterdir()
    monkeypatch.setattr(module, "mannequin", refuse)
    assert equal(stored_mannequin(), built)
    stored.write_bytes(stored.read_bytes()[:1000])
    monkeypatch.setattr(module, "mannequin", lambda: built)
    assert equal(stored_mannequin(), built)
    monkeypatch.setattr(module, "mannequin", refuse)
    assert equal(stored_mannequin(), built)


def test_other_libraries_build_their_own(
    built: Avatar, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("TOILE_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(module, "mannequin", lambda: built)
    for release in ("1", "2"):
        monkeypatch.setattr(module, "version", lambda name, release=release: release)
        stored_mannequin()
    assert len(list(tmp_path.iterdir())) == 2


def test_a_folder_that_cannot_be_written_is_no_obstacle(
    built: Avatar, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("TOILE_CACHE_DIR", str(tmp_path / "file"))
    monkeypatch.setattr(module, "mannequin", lambda: built)
    assert equal(stored_mannequin(), built)
