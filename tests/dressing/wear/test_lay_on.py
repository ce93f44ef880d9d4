"""Layers that lie exactly in each other are laid one on the other."""

from pathlib import Path

import numpy as np
import pytest

from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.dressing.garment.mesh_garment import read_mesh_garment
from toile.dressing.garment.pattern_mesh import mesh_pattern
from toile.dressing.pattern.pattern import Edge, Panel, Pattern
from toile.dressing.run.dress import dress
from toile.dressing.run.scene import Garment, Scene
from toile.dressing.wear.lay_on import LIFT, PANEL_LIFT, laid_on


def sheet(low: tuple[float, float], size: tuple[float, float], steps: int, first: int = 0) -> str:
    """Quads of a rectangle in front of the mannequin's chest, as OBJ; `first` vertices stand before it."""
    lines = [
        f"v {low[0] + size[0] * i / steps} {low[1] + size[1] * j / steps} 0.25"
        for i in range(steps + 1) for j in range(steps + 1)
    ]  # fmt: skip
    row = steps + 1
    for i in range(steps):
        for j in range(steps):
            corner = first + i * row + j + 1
            lines.append(f"f {corner} {corner + row} {corner + row + 1} {corner + 1}")
    return "\n".join(lines) + "\n"


BODY = np.random.default_rng(1).uniform((-0.2, 0.0, -0.1), (0.2, 1.7, 0.1), (500, 3))
FRONT, POCKET = sheet((-0.25, 0.9), (0.5, 0.5), 10), ((-0.1, 1.0), (0.13, 0.15), 4)


def meshes(folder: Path, **texts: str) -> list[GarmentMesh]:
    for name, text in texts.items():
        (folder / f"{name}.obj").write_text(text)
    return [read_mesh_garment(folder / f"{name}.obj", edge_length=0.03) for name in texts]


def test_a_pocket_in_the_plane_of_the_front_moves_outside_it(tmp_path: Path) -> None:
    both = f"g front\n{FRONT}g pocket\n{sheet(*POCKET, first=121)}"
    (mesh,), notes = laid_on(meshes(tmp_path, shirt=both), BODY)
    pocket = np.unique(mesh.faces[mesh.panel == 1])
    front = np.unique(mesh.faces[mesh.panel == 0])
    assert mesh.positions[pocket, 2] == pytest.approx(0.25 + LIFT, abs=1e-12)
    assert np.all(mesh.positions[front, 2] == 0.25)
    assert notes == ("garment shirt: pocket lies exactly in another layer and starts 2 mm outside it",)
    # Of two garments the later one lies outside, also where it is the larger.
    (inner, outer), _ = laid_on(meshes(tmp_path, pocket=sheet(*POCKET), front=FRONT), BODY)
    assert np.all(inner.positions[:, 2] == 0.25)
    assert 0 < np.count_nonzero(np.isclose(outer.positions[:, 2], 0.25 + LIFT)) < len(outer.positions)


def test_layers_that_only_touch_or_lie_apart_stay(tmp_path: Path) -> None:
    beside = f"g front\n{FRONT}g side\n{sheet((0.25, 0.95), (0.2, 0.3), 4, first=121)}"
    for texts in ({"shirt": beside}, {"front": FRONT, "later": FRONT.replace(" 0.25\n", " 0.2501\n")}):
        before = meshes(tmp_path, **texts)
        after, notes = laid_on(before, BODY)
        assert not notes and all(a is b for a, b in zip(after, before, strict=True))


def test_a_flat_panel_moves_as_a_whole() -> None:
    def panel(name: str, half: float, y: float) -> Panel:
        corners = ((-half, -half), (half, -half), (half, half), (-half, half))
        edges = tuple(Edge(i, (i + 1) % 4) for i in range(4))
        return Panel(name=name, vertices=corners, edges=edges, translation=(0.0, y, 0.3))

    pattern = Pattern(
        name="shirt", panels=(panel("pocket", 0.07, 1.1), panel("front", 0.25, 1.15)), stitches=()
    )
    (mesh,), notes = laid_on([mesh_pattern(pattern, edge_length=0.04)], BODY)
    pocket = np.unique(mesh.faces[mesh.panel == 0])
    assert mesh.positions[pocket, 2] == pytest.approx(0.3 + PANEL_LIFT)
    assert np.all(np.delete(mesh.positions, pocket, axis=0)[:, 2] == 0.3)
    assert "pocket lies exactly in another layer" in notes[0]


def test_front_and_pocket_hang_without_crossing(tmp_path: Path) -> None:
    """Both hang by their upper edges; the pocket ends outside the front everywhere."""
    (tmp_path / "front.obj").write_text(FRONT)
    (tmp_path / "pocket.obj").write_text(sheet(*POCKET))
    garments = [
        Garment(tmp_path / "front.obj", pins=tuple(range(10, 121, 11))),
        Garment(tmp_path / "pocket.obj", pins=tuple(range(4, 25, 5))),
    ]
    result = dress(Scene(garments=garments, quality="preview", edge_length=0.03, remesh=False))
    assert result.status == "converged"
    assert result.report["intersections"] == {"avatar": 0, "self": 0, "worst_frame": 0}
    front, pocket = (garment.positions for garment in result.garments)
    for x, y, z in pocket:
        nearest = np.argmin(np.hypot(front[:, 0] - x, front[:, 1] - y))
        assert z > front[nearest, 2]
