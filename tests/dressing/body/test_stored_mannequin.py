"""The mannequin on disk is the one that is built, and what cannot be read or written is no obstacle."""

import os
from pathlib import Path

import numpy as np
import pytest

from toile.dressing.body import stored_mannequin as module
from toile.dressing.body.avatar import Avatar
from toile.dressing.body.mannequin import mannequin
from toile.dressing.body.stored_mannequin import stored_mannequin
from toile.geometry.sources import read_sources


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


def test_other_sources_build_their_own_and_the_oldest_go(
    built: Avatar, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("TOILE_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(module, "mannequin", lambda: built)
    sources = read_sources()
    figure = "toile.dressing.body.mannequin_figure"
    for change in range(module.KEPT + 3):
        changed = sources | {figure: sources[figure] + b"#" * change}
        monkeypatch.setattr(module, "read_sources", lambda changed=changed: changed)
        stored_mannequin()
        for path in tmp_path.iterdir():
            os.utime(path, (path.stat().st_mtime - 10.0,) * 2)
        newest = module._path()
    assert newest.is_file() and len(list(tmp_path.iterdir())) == module.KEPT + 1
    monkeypatch.setattr(module, "read_sources", lambda: sources | {"toile.dressing.cli.main": b"other"})
    assert module._path().name != newest.name
    first = module._path()
    monkeypatch.setattr(module, "read_sources", lambda: sources)
    assert module._path() == first, "the command line is no part of it"


def test_a_folder_that_cannot_be_written_is_no_obstacle(
    built: Avatar, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("TOILE_CACHE_DIR", str(tmp_path / "file"))
    monkeypatch.setattr(module, "mannequin", lambda: built)
    assert equal(stored_mannequin(), built)
