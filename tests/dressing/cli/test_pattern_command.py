"""`toile pattern`: what it prints, its picture, and GarmentCode out of drawn patterns."""

from pathlib import Path
from xml.etree import ElementTree

import pytest

from toile.dressing.cli.main import main
from toile.dressing.pattern.drafts import built_in_names
from toile.dressing.pattern.garmentcode import read_garmentcode

SAMPLES = Path(__file__).parents[1] / "pattern" / "drawn" / "samples"


@pytest.fixture
def teagan(tmp_path: Path) -> Path:
    path = tmp_path / "teagan.svg"
    path.write_bytes((SAMPLES / "freesewing_teagan_34.svg").read_bytes())
    return path


def test_a_drawn_pattern_is_shown_with_numbers_lengths_and_seams(
    teagan: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    picture = teagan.with_name("shown.svg")
    assert main(["pattern", str(teagan), "-o", str(picture)]) == 0
    said = capsys.readouterr().out
    assert "sewn  sleeve.2 = front~.2 + back.2" in said and "half on the fold" in said
    texts = ["".join(e.itertext()) for e in ElementTree.parse(picture).iter() if e.tag.endswith("text")]
    assert {"0: 26.6 cm", "5: fold", "sleeve (pair)", "1: sleeve.2 = front~.2 + back.2"} <= set(texts)


def test_a_drawn_pattern_becomes_garmentcode(teagan: Path) -> None:
    out = teagan.with_name("teagan_specification.json")
    assert main(["pattern", str(teagan), "-o", str(out)]) == 0
    pattern = read_garmentcode(out)
    assert sorted(panel.name for panel in pattern.panels) == ["back", "front", "sleeve", "sleeve~"]
    assert {panel.role for panel in pattern.panels} == {"torso", "sleeve"}
    assert pattern.panel("sleeve").roll_radius == pytest.approx(1.12 * 0.32536 / 6.28319, rel=1e-3)


def test_a_pattern_with_stitches_is_shown(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["patterns", "--write", str(tmp_path)]) == 0
    for name in built_in_names():
        picture = tmp_path / f"{name}.svg"
        assert main(["pattern", str(tmp_path / f"{name}_specification.json"), "-o", str(picture)]) == 0
        ElementTree.parse(picture)
    assert "sewn  front.1 - back." in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["none.dxf"], "no such pattern file"),
        (["README.md"], "not a pattern file"),
        (["freesewing_teagan_34.svg", "-o", "x.pdf"], "write a picture"),
        (["synthetic_clo_english_teagan.dxf"], "--allowance 10mm"),
        (["synthetic_accumark_astm_teagan.dxf", "--size", "99"], "the sizes are 34, 42"),
        (["own_tee_valentina_aama_r12.dxf"], "--pattern-units"),
        (["own_tee_valentina_aama_r12.dxf", "--allowance", "10"], "has no unit"),
    ],
)
def test_faults_are_one_line(arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["pattern", str(SAMPLES / arguments[0]), *arguments[1:]]) == 2
    error = capsys.readouterr().err
    assert said in error and error.count("\n") == 1


def test_an_open_question_stops_a_drape_before_anything_is_computed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "aaron.svg"
    path.write_bytes((SAMPLES / "freesewing_aaron_34.svg").read_bytes())
    assert main(["dress", "--garment", str(path), "-o", str(tmp_path / "out"), "--quiet"]) == 2
    error = capsys.readouterr().err
    assert "what is sewn is not sure" in error and "aaron.seams.toml" in error
