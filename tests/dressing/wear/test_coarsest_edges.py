"""Meshes stay fine enough for the garment's size and for what it lies on."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

import toile
from tests.dressing.wear.test_lay_on import sheet
from toile.dressing.garment.mesh_garment import read_mesh_garment
from toile.dressing.run.quality import quality_preset
from toile.dressing.wear.coarsest_edges import fitting_sizing, starts_as_sheet

RADIUS = 0.3


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A ball, 0.3 m in radius, and a sheet of half a metre above it."""
    folder = tmp_path_factory.mktemp("sheet")
    ball = trimesh.creation.icosphere(subdivisions=3, radius=RADIUS)
    ball.apply_translation([0.0, RADIUS, 0.0])
    ball.export(folder / "ball.ply")
    text = sheet((-0.25, -0.25), (0.5, 0.5), 10)
    rows = [line.split() for line in text.splitlines()]
    (folder / "sheet.obj").write_text(
        "\n".join(f"v {row[1]} 0.62 {row[2]}" if row[0] == "v" else " ".join(row) for row in rows) + "\n"
    )
    return folder


@pytest.mark.parametrize("edge_length", [0.06, 0.1])
def test_a_sheet_lies_round_on_a_ball_in_edges_of_any_length(folder: Path, edge_length: float) -> None:
    ball = toile.AvatarFile(path=folder / "ball.ply", units="m", up="y")
    result = toile.dress(
        toile.Scene(garments=folder / "sheet.obj", avatar=ball, edge_length=edge_length, ground=False)
    )
    garment = result.garments[0]
    assert result.status == "converged"
    assert len(garment.faces) > 40, "two rigid triangles lie on the ball like a board"
    # The corners of a board lie 0.6 m high; those of cloth hang down beside the ball.
    assert garment.positions[:, 1].min() < 0.5
    assert np.linalg.norm(garment.positions - [0.0, RADIUS, 0.0], axis=1).max() < 1.25 * RADIUS


def test_large_garments_keep_the_longest_edges_of_their_quality(folder: Path) -> None:
    standard = quality_preset("standard")
    sizing = standard.sizing(standard.edge_length)
    mesh = read_mesh_garment(folder / "sheet.obj", edge_length=0.06)
    ball = trimesh.load(folder / "ball.ply")
    vertices, faces = np.asarray(ball.vertices), np.asarray(ball.faces, np.int32)
    assert starts_as_sheet(mesh)
    found = fitting_sizing(sizing, [mesh], vertices, faces)
    # On a ball an edge turns by its length over the radius.
    assert found is not None and found.size_max == pytest.approx(0.5 * RADIUS, rel=0.01)
    tube = trimesh.creation.cylinder(radius=0.4, height=1.0, sections=24)
    tube.export(folder / "tube.obj")
    worn = read_mesh_garment(folder / "tube.obj", edge_length=0.1)
    assert fitting_sizing(sizing, [worn], vertices, faces) == sizing
    assert fitting_sizing(None, [mesh], vertices, faces) is None
