"""Garments that start inside the body, with all of a piece."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

from toile.dressing.body.avatar import Avatar
from toile.dressing.body.dress_form import DressForm
from toile.dressing.garment.inside_body import faces_inside
from toile.dressing.garment.mesh_garment import read_mesh_garment
from toile.dressing.pattern.sewing_edges import SewingEdges
from toile.dressing.run.load_garment import load_garment
from toile.dressing.run.resolved_scene import resolve
from toile.dressing.run.scene import Garment, Scene
from toile.geometry.errors import InputError


def ball() -> Avatar:
    shape = trimesh.creation.icosphere(subdivisions=3, radius=0.3)
    return Avatar(name="ball", vertices=np.asarray(shape.vertices), faces=np.asarray(shape.faces, np.int32))


def write(path: Path, *rings: tuple[float, float, float]) -> Path:
    """Write rings of a radius and height, at a place along y, as one garment."""
    parts = [
        trimesh.creation.cylinder(radius=radius, height=height, cap=False, sections=24).apply_transform(
            trimesh.transformations.rotation_matrix(np.pi / 2.0, [1.0, 0.0, 0.0])
        ).apply_translation([0.0, place, 0.0])
        for radius, height, place in rings
    ]  # fmt: skip
    trimesh.util.concatenate(parts).export(path)
    return path


@pytest.mark.parametrize(
    ("rings", "share"),
    [
        ([(0.2, 0.1, 0.0)], 1.0),
        ([(0.4, 0.1, 0.0)], 0.0),
        ([(0.2, 0.8, 0.0)], 0.0),
        ([(0.4, 0.1, 0.0), (0.1, 0.1, 0.1)], 0.5),
    ],
)
def test_only_pieces_that_nowhere_come_out(
    rings: list[tuple[float, float, float]], share: float, tmp_path: Path
) -> None:
    mesh = read_mesh_garment(write(tmp_path / "rings.ply", *rings), units="m", up="y")
    assert len(faces_inside(mesh, ball())) == share * len(mesh.faces)


def test_the_message_names_garment_and_faces(tmp_path: Path) -> None:
    mesh = trimesh.load_mesh(write(tmp_path / "rings.ply", (0.4, 0.1, 0.0), (0.1, 0.1, 0.1)), process=False)
    path = tmp_path / "rings.npz"
    count = len(mesh.faces)
    np.savez(path, vertices=mesh.vertices, faces=mesh.faces, polygon=100 + np.arange(count))
    (garment,) = resolve(Scene(garments=[Garment(path)])).garments
    with pytest.raises(InputError, match="'rings' has a piece that starts inside the body") as caught:
        load_garment(garment, DressForm(ball()), SewingEdges(0.05, 0.05))
    assert set(caught.value.faces) == set(range(100 + count // 2, 100 + count))
