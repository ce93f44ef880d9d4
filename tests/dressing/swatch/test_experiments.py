"""Experiments on swatches of woven cloth: their curves agree with the weave, and bad input is one line."""

import csv
from pathlib import Path

import numpy as np
import pytest

from toile.dressing.cli.main import main
from toile.dressing.swatch.bias_extension import three_zones
from toile.dressing.swatch.cantilever import bend_cantilever
from toile.dressing.swatch.experiments import EXPERIMENTS
from toile.dressing.swatch.pull_out import pull_yarn_out
from toile.dressing.swatch.shear_frame import shear_in_frame
from toile.dressing.swatch.snag import snag
from toile.dressing.swatch.swatch_picture import swatch_svg
from toile.dressing.swatch.uniaxial import pull_uniaxially
from toile.dressing.weave.woven import TENSIONS, Woven, woven
from toile.geometry.errors import InputError

POPLIN = ["--yarn", "cotton:20tex", "--ends", "25", "--picks", "25"]


@pytest.fixture(scope="module")
def poplin() -> Woven:
    return woven("cotton:20tex", "cotton:20tex", ends=2500.0, picks=2500.0)


@pytest.mark.parametrize("axis", [0, 1])
def test_the_middle_of_a_swatch_stretches_as_the_curve_of_its_weave(axis: int) -> None:
    cloth = woven("cotton:20tex", "cotton:30tex", ends=2000.0, picks=2200.0)
    tensions = (10.0, 100.0)
    curve = pull_uniaxially(cloth, axis=axis, crossings=16, tensions=tensions)
    assert curve.complete
    direction = (cloth.warp, cloth.weft)[axis]
    for row, tension in zip(curve.rows, tensions, strict=True):
        expected = 100.0 * direction.curve[TENSIONS.index(tension)].strain[axis]
        assert row[1] == pytest.approx(expected, rel=0.02)


def test_shear_has_the_first_stiffness_until_yarns_touch(poplin: Woven) -> None:
    curve = shear_in_frame(poplin, crossings=6)
    angles, _, stiffness = np.array(curve.rows).T
    locking = np.degrees(poplin.locking)
    np.testing.assert_allclose(stiffness[angles < locking - 1.0], poplin.shear, rtol=1e-4)
    assert stiffness[-1] > 1.3 * poplin.shear


def test_a_strip_bends_by_the_rigidity_of_the_weave(poplin: Woven) -> None:
    curve = bend_cantilever(poplin, crossings=25)
    weight, drop, _, slope = curve.rows[0]
    overhang = 23.5 * poplin.systems[0].spacing
    gamma = weight * overhang**3 / poplin.warp.bending
    assert slope == pytest.approx(gamma / 8.0, rel=0.03)
    assert drop > 0.0


def test_a_drawn_yarn_slides_at_the_friction_of_its_crossings(poplin: Woven) -> None:
    curve = pull_yarn_out(poplin, crossings=8)
    _, force, most, sliding = curve.rows[-1]
    assert sliding >= 7.0
    assert force == pytest.approx(most, rel=0.05)


def test_floats_that_stick_stretch_less_than_yarn_that_passes() -> None:
    cloth = woven("cotton:20tex", "cotton:20tex", ends=2000.0, picks=2000.0, weave="twill")
    curve = pull_uniaxially(cloth, crossings=12, tensions=(10.0,))
    passing = 100.0 * cloth.warp.curve[TENSIONS.index(10.0)].strain[0]
    assert 0.7 * passing < curve.rows[0][1] < passing


@pytest.mark.slow
def test_a_snag_draws_yarn_in(poplin: Woven) -> None:
    curve = snag(poplin, crossings=7)
    lift, force, slid = np.array(curve.rows).T
    assert (np.diff(force) > 0.0).all()
    assert (np.diff(slid) >= 0.0).all()
    assert slid[-1] > 0.0
    assert lift[-1] == pytest.approx(0.4)


def test_three_zones_of_a_slender_strip() -> None:
    assert three_zones(100.0, 0.1, 0.3, 0.0) == pytest.approx(0.0, abs=1e-15)
    assert three_zones(100.0, 0.1, 0.3, 0.02) > three_zones(100.0, 0.1, 0.3, 0.01) > 0.0


def test_the_command_prints_and_writes_a_curve(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "bend.csv"
    assert main(["yarns", "swatch", "bend", *POPLIN, "--crossings", "9", "-o", str(path)]) == 0
    assert "bending rigidity is 2.14 uN m" in capsys.readouterr().out
    rows = list(csv.reader(path.read_text().splitlines()))
    assert rows[0] == ["weight per area [N/m2]", "drop [mm]", "reach [mm]", "drop over reach"]
    assert len(rows) == 11
    picture = path.with_suffix(".svg").read_text()
    assert picture.startswith("<svg") and picture.count("<polyline") == 4 + 9 + 1


def test_a_curve_that_stops_keeps_what_it_has(
    poplin: Woven, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("toile.engine.swatch.equilibrium.MOST_ITERATIONS", 3)
    curve = pull_uniaxially(poplin, crossings=5, tensions=(0.001, 1000.0))
    assert not curve.complete and len(curve.rows) < 2
    assert curve.notes[-1].startswith("stopped at")
    assert swatch_svg(curve).startswith("<svg")
    assert main(["yarns", "swatch", "uniaxial", *POPLIN, "--crossings", "5"]) == 3
    assert "stopped at" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["bend", *POPLIN, "--crossings", "1"], "a swatch has 4 to 200 crossings along a side, got 1"),
        (["uniaxial", *POPLIN, "--friction", "-0.1"], "friction between yarns is 0 to 2, got -0.1"),
        (["pull-out", *POPLIN, "--friction", "0"], "a yarn is drawn against friction: give one above 0"),
        (["bend", *POPLIN, "--friction", "0.3"], "yarns do not slide in bend: leave out --friction"),
        (["bend", *POPLIN, "--along", "weft"], "--along is for uniaxial"),
        (["bend", "--yarn", "cotton:200tex", "--ends", "25", "--picks", "25"], "use fewer, or a finer yarn"),
        (["bend", *POPLIN, "--weave", "knot"], "a weave is plain, twill, satin"),
    ],
)
def test_bad_input_is_one_line(options: list[str], said: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["yarns", "swatch", *options]) == 2
    error = capsys.readouterr().err.strip()
    assert said in error and "\n" not in error


def test_a_count_of_crossings_is_checked_everywhere(poplin: Woven) -> None:
    for experiment in EXPERIMENTS.values():
        with pytest.raises(InputError, match="4 to 200 crossings"):
            experiment(poplin, crossings=3)
