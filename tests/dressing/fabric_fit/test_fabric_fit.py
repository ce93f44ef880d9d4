"""Fabrics from measurements: synthetic curves give back their parameters, units are what they say."""

import json
import tomllib
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

import toile
from toile.dressing.cli.main import main
from toile.dressing.fabric_fit.cusick_fit import bending_from_drape
from toile.dressing.fabric_fit.estimate import line_through_origin
from toile.dressing.fabric_fit.fast import read_fast
from toile.dressing.fabric_fit.kes import read_kes
from toile.dressing.fabric_fit.u3m import read_u3m
from toile.dressing.fabric_fit.units import quantity
from toile.dressing.run.scene_file import load_scene
from toile.engine.cloth.fabric import Fabric
from toile.geometry.errors import InputError

TRUE = toile.fabric("wool-worsted")
GF = 9.80665e-3


def loop(most: float) -> np.ndarray:
    """Points of a cycle of loading: up, down to minus the most, and back."""
    quarter = np.linspace(0.0, most, 12)
    return np.concatenate([quarter, quarter[-2::-1], -quarter[1:], -quarter[-2::-1]])


def kes_csv(path: Path) -> Path:
    """Curves as the instruments give them, with friction and noise."""
    noise = np.random.default_rng(3)
    rows = ["# weight = 168 g/m2", "# thickness = 0.40 mm", "test,direction,x,y"]
    for direction, stiffness in (("warp", TRUE.stretch_warp), ("weft", TRUE.stretch_weft)):
        for x in np.linspace(0.1, 3.0, 30):
            force = stiffness * 0.01 * x / (GF / 0.01)
            rows.append(f"tensile,{direction},{x},{force * (1.0 + 0.01 * noise.standard_normal())}")
        angles = loop(4.0)
        turning = np.sign(np.diff(angles, prepend=-1.0))
        forces = TRUE.shear * np.tan(np.radians(angles)) / (GF / 0.01) + 0.4 * turning
        rows += [f"shear,{direction},{x},{y}" for x, y in zip(angles, forces, strict=True)]
    for direction in ("warp", "weft", "bias"):
        curvature = loop(2.5)
        turning = np.sign(np.diff(curvature, prepend=-1.0))
        moment = getattr(TRUE, f"bending_{direction}") * 100.0 * curvature / GF + 0.02 * turning
        rows += [f"bending,{direction},{x},{y}" for x, y in zip(curvature, moment, strict=True)]
    path.write_text("\n".join(rows))
    return path


def test_synthetic_kes_curves_give_back_their_fabric(tmp_path: Path) -> None:
    measured = read_kes(kes_csv(tmp_path / "twill.csv"))
    for name, estimate in measured.values.items():
        true = getattr(TRUE, name)
        assert estimate.value == pytest.approx(true, rel=0.02), name
        assert abs(estimate.value - true) <= 3.0 * estimate.error + 1e-12, name
        assert estimate.error < 0.06 * true, name
    assert measured.values.keys() == {
        "areal_density", "thickness", "stretch_warp", "stretch_weft", "shear", "bending_warp", "bending_weft",
        "bending_bias",
    }  # fmt: skip
    assert len(measured.curves) == 7


def test_command_writes_a_table_that_scenes_read_and_a_picture(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    kes, table, picture = kes_csv(tmp_path / "twill.csv"), tmp_path / "twill.toml", tmp_path / "twill.svg"
    options = ["--kes", str(kes), "--name", 'my "twill"', "-o", str(table), "--picture", str(picture)]
    assert main(["fabric", "fit", *options]) == 0
    said = capsys.readouterr().out
    assert "bending_warp   5.6 +- " in said
    assert "KES bending, warp: 45 points" in said
    scene = tmp_path / "scene.toml"
    garment = 'default_fabric = "my \\"twill\\""\n[[garment]]\nsource = "tshirt"\n'
    scene.write_text(garment + table.read_text())
    read = load_scene(scene).fabrics['my "twill"']
    assert read.stretch_warp == pytest.approx(TRUE.stretch_warp, rel=0.02)
    assert ElementTree.fromstring(picture.read_bytes()).tag.endswith("svg")
    assert tomllib.loads(table.read_text())["fabric"]['my "twill"']["areal_density"] == pytest.approx(0.168)


@pytest.mark.parametrize(
    ("text", "kind", "value"),
    [
        ("1 gf.cm2/cm", "bending rigidity", 98.0665e-6),
        ("1 gf·cm²/cm", "bending rigidity", 98.0665e-6),
        ("1 mN.mm", "bending rigidity", 1e-6),
        ("1 µN m", "bending rigidity", 1e-6),
        ("100 mg cm", "bending rigidity", 9.80665e-6),
        ("1 gf/(cm.deg)", "shear stiffness", 56.188),
        ("1 gf/cm·deg", "shear stiffness", 56.188),
        ("2 gf/cm", "force per width", 1.96133),
        ("1e3", "mass per area", 1.0),
        ("4.4 oz/yd2", "mass per area", 0.14919),
        ("42mm", "length", 0.042),
    ],
)
def test_units(text: str, kind: str, value: float) -> None:
    default = {"mass per area": "g/m2"}.get(kind, "")
    assert quantity(text, kind, default) == pytest.approx(value, rel=1e-4)


@pytest.mark.parametrize(
    ("text", "kind", "message"),
    [
        ("3 gf/cm", "bending rigidity", "'gf/cm' is no unit of bending rigidity; use one of gf.cm2/cm"),
        ("soft", "length", "'soft' is no length: write a number and a unit"),
    ],
)
def test_a_unit_of_another_kind_is_refused(text: str, kind: str, message: str) -> None:
    with pytest.raises(InputError, match=message.replace(".", r"\.")):
        quantity(text, kind, "mm")


def test_kes_figures(tmp_path: Path) -> None:
    path = tmp_path / "figures.toml"
    path.write_text(
        'weight = 168\nthickness = "0.4 mm"\n[warp]\nEMT = 4.0\nWT = "12 gf.cm/cm2"\nB = 0.06\nG = 0.7\n'
        '[weft]\nEMT = 6\nB = "5 uN.m"\nG = 0.5\n'
    )
    values = read_kes(path).values
    assert values["stretch_warp"].value == pytest.approx(2.0 * 12.0 * 0.980665 / 0.04**2)
    assert values["stretch_weft"].value == pytest.approx(500.0 * 0.980665 / 0.06)
    assert values["bending_warp"].value == pytest.approx(0.06 * 98.0665e-6)
    assert values["bending_weft"].value == pytest.approx(5e-6)
    assert values["shear"].value == pytest.approx(0.6 * 56.188, rel=1e-4)
    assert values["shear"].error > 0.1 * 56.0


def test_fast_figures(tmp_path: Path) -> None:
    path = tmp_path / "fast.toml"
    path.write_text("weight = 168\nT2 = 0.4\nEB5 = 3.5\n[warp]\nC = 15\nE5 = 0.2\nE20 = 0.8\nE100 = 4.0\n")
    values = read_fast(path).values
    # FAST: B = W c^3 9.81e-6 [uN m], G = 123 / EB5 [N/m].
    assert values["bending_warp"].value == pytest.approx(168 * 15**3 * 9.81e-12, rel=1e-3)
    assert values["shear"].value == pytest.approx(123 / 3.5)
    assert values["stretch_warp"].value == pytest.approx(98.0665 / 0.04, rel=1e-3)
    path.write_text("weight = 168\nEB6 = 3.5\n")
    with pytest.raises(InputError, match="not 'EB6'"):
        read_fast(path)


def test_cantilever_and_bias(capsys: pytest.CaptureFixture[str]) -> None:
    options = ["--cantilever", "40mm", "3.2 cm", "--weight", "150 g/m2", "--like", "cotton-poplin"]
    assert main(["fabric", "fit", *options]) == 0
    said = capsys.readouterr().out
    warp, weft = 0.15 * 9.80665 * 0.02**3 * 1e6, 0.15 * 9.80665 * 0.016**3 * 1e6
    bias = 4.0 / (warp**-0.5 + weft**-0.5) ** 2
    assert f"bending_warp   {warp:.4g} +- {0.06 * warp:.2g} uN.m" in said
    assert f"bending_bias   {bias:.4g} +- " in said
    assert "stretch_warp   2800 N/m  (that of cotton-poplin)" in said
    assert main(["fabric", "fit", "--cantilever", "40", "32", "--weight", "150"]) == 2
    assert "the measurements lack thickness, stretch_warp" in capsys.readouterr().err
    assert main(["fabric", "fit", "--cantilever", "40", "32"]) == 2
    assert "needs the --weight" in capsys.readouterr().err


def test_bending_by_drape_coefficient() -> None:
    """A drape whose coefficient is a known function of the rigidity."""

    def drape(fabric: Fabric) -> float:
        return float(100.0 / (1.0 + (8e-6 / fabric.bending_warp) ** 0.6))

    said: list[str] = []
    found = bending_from_drape(TRUE, 70.0, drape, said.append)
    exact = 8e-6 * (70.0 / 30.0) ** (1.0 / 0.6)
    assert found["bending_warp"].value == pytest.approx(exact, rel=0.06)
    assert abs(found["bending_warp"].value - exact) < found["bending_warp"].error
    ratio = TRUE.bending_weft / TRUE.bending_warp
    assert found["bending_weft"].value == pytest.approx(ratio * found["bending_warp"].value)
    assert len(said) <= 7
    with pytest.raises(InputError, match="between 0 and 100"):
        bending_from_drape(TRUE, 120.0, drape, said.append)
    with pytest.raises(InputError, match="no bending between"):
        bending_from_drape(TRUE, 99.9, drape, said.append)


def test_u3m_with_a_file_of_physics_beside_it(tmp_path: Path) -> None:
    def run(stiffness: float) -> dict[str, object]:
        strain = np.linspace(0.0, 0.1, 20)
        force = stiffness * strain * 0.04 / GF
        pairs = np.column_stack((8.0 * (1.0 + strain), 0.5 + force)).ravel().tolist()
        return {"S2": {"width": 4, "length": 8.0, "samplesTree": [pairs]}}

    raw = {"L": run(90.0), "W": run(60.0), "B": run(70.0), "M": 300.0}
    (tmp_path / "raw.json").write_text(json.dumps({"raw_data": raw, "schema": "1.1", "custom": None}))
    physics = {"weight": 290, "thickness": 0.7, "devices": {"fab": "raw.json"}}
    path = tmp_path / "knit.u3m"
    path.write_text(json.dumps({"schema": "1.1", "material": {"physics": physics}}))
    values = read_u3m(path).values
    assert values["stretch_warp"].value == pytest.approx(90.0)
    assert values["stretch_weft"].value == pytest.approx(60.0)
    assert values["shear"].value == pytest.approx(1.0 / (4.0 / 70.0 - 1.0 / 90.0 - 1.0 / 60.0))
    assert values["areal_density"].value == pytest.approx(0.3)
    assert values["thickness"].value == pytest.approx(7e-4)
    path.write_text("{}")
    with pytest.raises(InputError, match="holds no weight"):
        read_u3m(path)


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ("tensile,bias,1,2", "line 2: direction of tensile is one of warp, weft, got 'bias'"),
        ("pull,warp,1,2", "line 2: test is one of tensile, shear, bending"),
        ("shear,warp,1,much", "line 2: y must be a number, got 'much'"),
        ("shear,warp,1,2", "has 1 points; give 4 or more"),
    ],
)
def test_faults_of_curves_are_named(lines: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "bad.csv"
    path.write_text("test,direction,x,y\n" + lines)
    with pytest.raises(InputError, match=message):
        read_kes(path)


def test_bend_of_a_curve_is_part_of_its_uncertainty() -> None:
    x = np.linspace(0.0, 0.1, 40)
    slope, error = line_through_origin(x, 100.0 * x + 3000.0 * x**2)
    assert 100.0 < slope < 400.0
    assert error > 30.0
    assert line_through_origin(x, 100.0 * x) == pytest.approx((100.0, 0.0), abs=1e-6)
