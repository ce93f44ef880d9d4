"""Garment files of other formats: registered readers, chosen by extension; clashes are errors."""

from pathlib import Path

import pytest

import toile
from tests.dressing.pattern.test_built_in_patterns import BODY
from tests.dressing.pattern.test_register_draft import bow_tie, square
from toile.dressing.garment import readers
from toile.dressing.run.garment_source import checked_source


@pytest.fixture(autouse=True)
def own_register(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(readers, "_READERS", dict(readers._READERS))


def read(path: Path) -> toile.Pattern:
    assert path.is_file()
    return square(BODY)


def test_a_registered_extension_is_a_source(tmp_path: Path) -> None:
    file = tmp_path / "apron.PDS"
    file.write_text("0")
    with pytest.raises(toile.InputError, match=r"unknown garment format '\.PDS'; use \.json, \.dxf"):
        checked_source(toile.Garment(file))

    toile.register_reader(".pds", read)
    toile.register_reader(".PDS", read)

    checked_source(toile.Garment(file))
    assert readers.read_garment(file) == square(BODY)


def test_garmentcode_is_read_as_before(tmp_path: Path) -> None:
    file = tmp_path / "square.json"
    toile.write_garmentcode(square(BODY), file)
    assert readers.read_garment(file) == square(BODY)


@pytest.mark.parametrize("suffix", [".json", ".obj", ".NPZ"])
def test_an_extension_that_is_taken_is_an_error(suffix: str) -> None:
    with pytest.raises(toile.InputError, match="have a reader already"):
        toile.register_reader(suffix, read)


@pytest.mark.parametrize("suffix", ["", ".", "dxf", ".a/b", ".tar.gz"])
def test_what_is_no_extension_is_an_error(suffix: str) -> None:
    with pytest.raises(toile.InputError, match="is no file extension"):
        toile.register_reader(suffix, read)


def test_what_a_reader_returns_is_checked(tmp_path: Path) -> None:
    file = tmp_path / "tie.dxf"
    file.write_text("0")
    toile.register_reader(".dxf", lambda path: bow_tie(BODY))
    with pytest.raises(toile.InputError, match="panel 'square' crosses itself"):
        readers.read_garment(file)
    toile.register_reader(".svg", lambda path: None)  # type: ignore[arg-type, return-value]
    with pytest.raises(TypeError, match=r"the reader of '\.svg' returned NoneType"):
        readers.read_garment(file.with_suffix(".svg"))
