"""`toile measure`: the seven measurements in centimetres, and a picture of where."""

from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from toile.dressing.body.mannequin import mannequin
from toile.dressing.body.measure import measure
from toile.dressing.body.write_body import body_bytes
from toile.dressing.cli.main import main
from toile.dressing.pictures.measure_picture import measure_picture, named_measurements
from toile.dressing.pictures.preview import PreviewMesh, render_front

SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture
def body(tmp_path: Path) -> Path:
    """The mannequin as a file."""
    path = tmp_path / "body.obj"
    path.write_bytes(body_bytes(mannequin(height=1.80), ".obj"))
    return path


def test_measurements_and_picture(body: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    picture = tmp_path / "new" / "where.svg"
    assert main(["measure", str(body), "-o", str(picture)]) == 0
    said = capsys.readouterr().out.splitlines()
    values = {line.split()[0]: float(line.split()[1]) for line in said[:-1]}
    assert list(values) == ["height", "shoulder", "arm", "chest", "waist", "hip", "inseam"]
    assert values["height"] == pytest.approx(180.0, abs=0.2)
    assert values["waist"] < values["hip"]
    root = ElementTree.fromstring(picture.read_bytes())
    shown = ["".join(text.itertext()) for text in root.iter(f"{SVG}text")]
    assert sorted(shown) == sorted(f"{name} {value:.1f} cm" for name, value in values.items())


def test_tapes_lie_where_the_body_is() -> None:
    avatar = mannequin()
    measured = measure(avatar)
    root = ElementTree.fromstring(measure_picture(avatar, measured))
    pixels, project = render_front(
        [PreviewMesh(positions=avatar.vertices, faces=avatar.faces, colour=(0.8, 0.7, 0.6))], 900
    )
    crown, floor = project(np.array([[0.0, measured.height, 0.0], [0.0, 0.0, 0.0]]))[:, 1]
    for name in ("chest", "waist", "hip"):
        share = getattr(measured, f"{name}_height") / measured.height
        level = floor + share * (crown - floor)
        rows = [float(line.attrib["y1"]) for line in root.iter(f"{SVG}line")]
        assert min(abs(row - level) for row in rows) < 12.0
    assert pixels.shape[0] == 900
    assert named_measurements(measured)["chest"] == pytest.approx(92.0, abs=2.0)


def test_bodies_that_cannot_be_measured_and_other_pictures(
    body: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["measure", str(body), "-o", str(tmp_path / "where.png")]) == 2
    assert "the picture is an .svg file" in capsys.readouterr().err
    assert main(["measure", str(tmp_path / "nobody.obj")]) == 2
    assert "nobody.obj: avatar file not found" in capsys.readouterr().err


def test_a_sitting_body_is_refused(data_dir: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["measure", str(data_dir / "bodies/anny_m_sit.ply")]) == 2
    assert "does not stand" in capsys.readouterr().err


def test_body_is_read_as_told(body: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Front and parts are given alike to measure, patterns and dress."""
    lines = body.read_text().replace("\nf ", "\ng skin\nf ", 1)
    count = sum(line.startswith("v ") for line in lines.splitlines())
    lines += "".join(f"v {x} {y} -0.4\n" for x, y in ((-0.3, 0.9), (0.3, 0.9), (0.0, 1.4)))
    lines += f"v 0 1.2 -0.6\ng bag\nf {count + 1} {count + 2} {count + 3}\n"
    for a, b in ((1, 2), (2, 3), (3, 1)):
        lines += f"f {count + b} {count + a} {count + 4}\n"
    path = tmp_path / "bag.obj"
    path.write_text(lines)
    assert main(["measure", str(path), "--without", "bag"]) == 0
    without = capsys.readouterr().out
    assert main(["measure", str(path), "--only", "skin", "--front=z", "--up", "y", "--units", "m"]) == 0
    assert capsys.readouterr().out == without
    for command in (["measure", str(path)], ["patterns", "--write", str(tmp_path), "--avatar", str(path)]):
        assert main([*command, "--without", "hat"]) == 2
        assert "bag.obj: has no part 'hat'; it has skin, bag" in capsys.readouterr().err
    assert (
        main(["dress", "--avatar", str(path), "--garment", "tshirt", "--front", "up", "-o", str(tmp_path)])
        == 2
    )
    assert "unknown front 'up'; give the axis that the body faces" in capsys.readouterr().err
