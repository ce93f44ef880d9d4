"""Fabrics from yarns: what they weigh and resist, as texts, tables and pictures, and what is refused."""

import math
import re
import tomllib
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from toile.dressing.cli.main import main
from toile.dressing.garment.fabrics import fabrics, invalid_field
from toile.dressing.run.scene_file import load_scene
from toile.dressing.weave.fibres import FIBRES
from toile.dressing.weave.weave_picture import weave_svg
from toile.dressing.weave.woven import TENSIONS, Woven, woven
from toile.dressing.weave.yarn import read_yarn
from toile.geometry.errors import InputError


def cloth(yarn: str, ends: float, picks: float, weave: str = "plain") -> Woven:
    return woven(yarn, yarn, ends=100.0 * ends, picks=100.0 * picks, weave=weave)


@pytest.mark.parametrize(
    "text", ["cotton:20tex", "cotton:200dtex", "cotton:180den", "cotton:29.525Ne", "cotton:50Nm", "20tex"]
)
def test_counts_are_read_in_every_unit(text: str) -> None:
    assert read_yarn(text).linear_density == pytest.approx(20e-6, rel=1e-6)


def test_a_yarn_bends_as_its_fibres_do() -> None:
    cotton = FIBRES["cotton"]
    diameter = math.sqrt(4.0 * cotton.fineness / (math.pi * cotton.density))
    one = cotton.modulus * cotton.density * math.pi * diameter**4 / 64.0
    assert read_yarn("cotton:20tex").bending == pytest.approx(one * 20e-6 / cotton.fineness, rel=1e-12)


@pytest.mark.parametrize(
    ("yarn", "ends", "picks", "weave", "preset", "mass"),
    [
        ("cotton:20tex", 25, 25, "plain", "cotton-poplin", 0.10),
        ("wool:50tex", 20, 18, "twill", "wool-worsted", 0.21),
        ("cotton:100tex", 14, 12, "plain", "canvas", 0.10),
        ("cotton:85tex", 26, 17, "3/1", "denim-12oz", 0.10),
    ],
)
def test_cloth_from_typical_counts_is_near_its_kind(
    yarn: str, ends: float, picks: float, weave: str, preset: str, mass: float
) -> None:
    """Counts are typical of a kind, not those of the measured cloth; nothing is fitted."""
    found, measured = cloth(yarn, ends, picks, weave).fabric("made"), fabrics()[preset]
    assert invalid_field(found) is None
    assert found.areal_density == pytest.approx(measured.areal_density, rel=mass)
    own = math.sqrt(found.bending_warp * found.bending_weft)
    other = math.sqrt(measured.bending_warp * measured.bending_weft)
    # A lower bound: fibres that twist, size and finish hold together bend up to nine times as hard.
    assert 0.1 < own / other < 1.2
    stiffness = math.sqrt(found.stretch_warp * found.stretch_weft)
    assert 0.1 < stiffness / math.sqrt(measured.stretch_warp * measured.stretch_weft) < 10.0


def test_curves_stiffen_towards_straight_yarns() -> None:
    found = cloth("cotton:20tex", 25, 25)
    curve = found.fabric("made").stretch_curve_warp
    assert [tension for _, tension in curve] == list(TENSIONS)
    slopes = [(b[1] - a[1]) / (b[0] - a[0]) for a, b in pairwise(curve)]
    assert slopes == sorted(slopes)
    assert curve[-1][0] < found.warp.crimp + TENSIONS[-1] * 0.4e-3 / found.systems[0].yarn.stiffness
    assert curve[0][1] / curve[0][0] == pytest.approx(found.warp.stiffness, rel=0.02)


def test_yarns_lock_where_neighbours_touch() -> None:
    found = cloth("cotton:20tex", 25, 25)
    assert math.cos(found.locking) == pytest.approx(found.systems[0].yarn.width / 0.4e-3)


def test_shear_of_a_grid_of_beams() -> None:
    """A square grid whose crossings do not turn: two beams of length L bend by F p L^3/(12 k_b) over p."""
    found = cloth("cotton:20tex", 25, 25)
    own = found.systems[0]
    assert found.shear == pytest.approx(6.0 * own.yarn.bending / own.length**3, rel=1e-12)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"warp": "coton:20tex"}, "cotton"),
        ({"warp": "cotton:0tex"}, "greater than zero"),
        ({"warp": "cotton:20"}, "FIBRE:COUNT"),
        ({"warp": "cotton:20kg"}, "tex, dtex, den, Ne or Nm"),
        ({"warp": "cotton:0.02tex"}, "1 to 5,000 tex"),
        ({"ends": 9000.0}, "warp yarns are 0.167 mm wide, and 90 ends per centimetre leave 0.111 mm"),
        ({"picks": 9000.0}, "weft yarns are 0.167 mm wide"),
        ({"ends": 0.0}, "ends must be 1 to 100"),
        ({"weave": "velvet"}, "a weave is plain, twill, satin"),
        ({"warp_wave": 1.5}, "warp_wave is a share"),
    ],
)
def test_what_cannot_be_woven_is_refused(change: dict[str, object], message: str) -> None:
    asked: dict[str, object] = {
        "warp": "cotton:20tex",
        "weft": "cotton:20tex",
        "ends": 2500.0,
        "picks": 2500.0,
    }
    with pytest.raises(InputError, match=re.escape(message)):
        woven(**{**asked, **change})  # type: ignore[arg-type]


def test_a_weave_in_which_a_yarn_falls_out_is_refused() -> None:
    with pytest.raises(InputError, match="weft yarn of this weave never changes sides"):
        woven(
            "20tex",
            "20tex",
            ends=2500.0,
            picks=2500.0,
            weave=np.array([[True, True, False], [True, False, True]]),
        )


def test_the_command_prints_and_writes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "twill.toml"
    command = ["fabric", "weave", "--yarn", "wool:50tex", "--ends", "20", "--picks", "18", "--weave", "twill"]
    assert main([*command, "--name", "suiting", "-o", str(out)]) == 0
    text = capsys.readouterr().out
    assert "areal density" in text
    assert "Nothing is fitted" in text
    table = tomllib.loads(out.read_text())["fabric"]["suiting"]
    made = cloth("wool:50tex", 20, 18, "twill").fabric("suiting")
    assert table["bending_warp"] == pytest.approx(made.bending_warp, rel=1e-5)
    assert table["stretch_curve_warp"][3] == pytest.approx(made.stretch_curve_warp[3], rel=1e-5)
    root = ElementTree.fromstring(out.with_suffix(".svg").read_text())
    assert root.tag.endswith("svg")


def test_a_command_that_cannot_says_so_in_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["fabric", "weave", "--yarn", "hemp:20tex", "--ends", "20", "--picks", "18"]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_the_picture_shows_the_repeat() -> None:
    found = cloth("cotton:20tex", 25, 25)
    drawn = weave_svg(found)
    # Both yarns at 8 x 8 crossings, and the white ground.
    assert drawn.count("<rect") == 2 * 64 + 1
    assert weave_svg(found) == drawn


def test_a_scene_names_a_fabric_by_its_yarn(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    yarn = 'yarn = { warp = "20tex", ends_per_cm = 25, picks_per_cm = 25, fibre = "cotton" }'
    path.write_text(
        f'[[garment]]\nsource = "tshirt"\nfabric = "mine"\n[fabric.mine]\n{yarn}\nfriction_body = 0.2\n'
    )
    made = load_scene(path).fabrics["mine"]
    expected = cloth("cotton:20tex", 25, 25).fabric("mine")
    assert made == replace(expected, friction_body=0.2)


@pytest.mark.parametrize(
    ("yarn", "message"),
    [
        ('{ warp = "20tex", ends_per_cm = 25 }', "yarn lacks picks_per_cm"),
        ('{ warp = "20tex", ends_per_cm = 25, picks_per_cm = "x" }', "picks_per_cm of yarn must be a number"),
        ('{ warp = "20tex", ends_per_cm = 25, picks_per_cm = 95 }', "weft yarns are 0.167 mm wide"),
        ('{ warp = "20tex", ends = 25, picks_per_cm = 95 }', "ends_per_cm"),
    ],
)
def test_a_scene_with_an_impossible_weave_says_where(yarn: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(f'[[garment]]\nsource = "tshirt"\nfabric = "mine"\n[fabric.mine]\nyarn = {yarn}\n')
    with pytest.raises(InputError, match=re.escape(message)) as error:
        load_scene(path)
    assert "scene.toml, line 5" in str(error.value)
