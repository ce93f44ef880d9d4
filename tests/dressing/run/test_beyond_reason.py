"""Garments that fall, and cloth that grows: failures of their own, with their place and exit code."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.dressing.garment.mesh_parts import octahedron, read, tube
from toile.collide.audit import Crossings
from toile.dressing.body.mannequin import mannequin
from toile.dressing.cli.main import main
from toile.dressing.garment.fabrics import fabrics
from toile.dressing.run.dress import dress
from toile.dressing.run.scene import Garment, Scene
from toile.dressing.wear.assemble_cloth import assemble_cloth
from toile.dressing.wear.watch import FRAMES_DOWN, Watch, area_ratios, strained_places
from toile.engine.cloth.cloth import Cloth
from toile.engine.drape.plan import Frame
from toile.geometry.arrays import Float

NONE = np.empty((0, 2), np.int32)


@pytest.fixture
def ring(tmp_path: Path) -> tuple[Cloth, Watch]:
    mesh = read(tmp_path, tube())
    body = np.random.default_rng(1).uniform((-0.2, 0.0, -0.2), (0.2, 1.7, 0.2), (4000, 3))
    return assemble_cloth([(mesh, fabrics()["cotton-poplin"])], []), Watch(body, [mesh])


def frame(cloth: Cloth, positions: Float, index: int = 3) -> Frame:
    return Frame(
        index=index, step=10 * index, phase="settling", cloth=replace(cloth, positions=positions), contacts=0,
        rms_motion=0.1, peak_motion=0.1, crossings=Crossings(NONE, NONE),
    )  # fmt: skip


def test_cloth_that_grows_stops_the_drape(ring: tuple[Cloth, Watch]) -> None:
    cloth, watch = ring
    assert watch.see(frame(cloth, cloth.positions)) and watch.at_end(cloth) is None
    grown = cloth.positions * (1.8, 1.0, 1.8)
    assert area_ratios(replace(cloth, positions=grown), 1) == pytest.approx(1.8)
    assert watch.see(frame(cloth, grown)), "less than three times its area: a moment's stretch"
    failure = watch.at_end(replace(cloth, positions=grown))
    assert failure is not None and failure.kind == "overstretched"
    assert not watch.see(frame(cloth, cloth.positions * (1.8, 1.8, 1.8)))
    assert watch.failure is not None and watch.failure.kind == "overstretched"
    assert "3.24 times what was cut" in watch.failure.message and "dirty: part0" in watch.failure.where


def test_strains_over_half_are_named(ring: tuple[Cloth, Watch], tmp_path: Path) -> None:
    cloth, _ = ring
    mesh = read(tmp_path, tube())
    assert strained_places(cloth, [mesh]) == ()
    stretched = cloth.positions.copy()
    stretched[cloth.positions[:, 1] > 1.23, 1] += 0.013
    (place,) = strained_places(replace(cloth, positions=stretched), [mesh])
    assert place.percent == pytest.approx(65.0, abs=1.0) and place.faces == 80
    assert place.where.startswith("garment dirty: part0, near (")


def test_a_ring_that_comes_down_off_the_body_has_fallen(ring: tuple[Cloth, Watch]) -> None:
    cloth, watch = ring
    assert watch.see(frame(cloth, cloth.positions))
    assert all(watch.see(frame(cloth, cloth.positions - (0.0, 0.25, 0.0))) for _ in range(9)), (
        "still on the hip"
    )
    fallen = cloth.positions - np.array([0.0, 0.9, 0.0])
    seen = [watch.see(frame(cloth, fallen)) for _ in range(FRAMES_DOWN)]
    assert seen == [True] * (FRAMES_DOWN - 1) + [False]
    assert watch.failure is not None and watch.failure.kind == "fell_off"
    assert "its top came down by 0.90 m" in watch.failure.message


def test_a_sheet_beside_the_body_falls_to_the_floor(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    quads = "".join(f"v {0.02 * i - 0.1} {0.9 + 0.02 * j} 0.3\n" for i in range(6) for j in range(6))
    quads += "".join(
        f"f {6 * i + j + 1} {6 * i + j + 7} {6 * i + j + 8} {6 * i + j + 2}\n"
        for i in range(5)
        for j in range(5)
    )
    (tmp_path / "sheet.obj").write_text(quads)
    options = ["--garment", str(tmp_path / "sheet.obj"), "--quality", "preview", "-o", str(tmp_path / "out")]
    assert main(["dress", *options, "--quiet"]) == 4
    assert "fell off the body" in capsys.readouterr().err
    floor = mannequin().vertices[:, 1].min()
    lines = (tmp_path / "out" / "sheet.obj").read_text().splitlines()
    heights = np.array([float(line.split()[2]) for line in lines if line.startswith("v ")])
    assert heights.min() == pytest.approx(floor, abs=2e-3), "the floor has caught it"


def test_buttons_do_not_explode(tmp_path: Path) -> None:
    """A tube that hangs from its upper edge: its cloth keeps its area and its buttons their shape."""
    buttons = [octahedron((0.0, 0.66 + 0.08 * number, 0.305), 0.008) for number in range(2)]
    vertices, faces = tube()
    read(tmp_path, (vertices - np.array([0.0, 0.4, 0.0]), faces), *buttons)
    garment = Garment(tmp_path / "dirty.obj", pins=tuple(range(480, 520)))
    result = dress(Scene(garments=[garment], quality="preview"))
    assert result.status == "converged"
    facts = result.report["garments"][0]
    assert facts["area_m2"] == pytest.approx(facts["cut_area_m2"], rel=0.01)
    worn = result.garments[0]
    for number, button in enumerate(buttons):
        own = np.unique(worn.faces[worn.panel == number + 1])
        assert len(own) == 6
        size = np.linalg.norm(worn.positions[own, None] - worn.positions[None, own], axis=2)
        meant = np.linalg.norm(button[0][:, None] - button[0][None], axis=2)
        assert np.sort(size.ravel()) == pytest.approx(np.sort(meant.ravel()), abs=1e-9)
        middle = worn.positions[own].mean(axis=0)
        assert np.hypot(middle[0], middle[2]) == pytest.approx(0.305, abs=2e-3), "it sits on the tube"
        assert middle[1] == pytest.approx(0.66 + 0.08 * number, abs=2e-3)
