"""Numbers at the vertices of garment files, from which fields are painted."""

from pathlib import Path

import meshio
import numpy as np
import pytest

from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.dressing.garment.mesh_garment import read_mesh_garment
from toile.geometry.errors import InputError
from toile.studies.scenes.flat_meshes import mesh

POINTS, FACES = mesh("random", 0.6, 0.4, 0.1)
PLACES = np.column_stack([POINTS, 0.05 * np.sin(5.0 * POINTS[:, 0])])
WETNESS = 0.2 + POINTS[:, 0] - 0.5 * POINTS[:, 1]


def write_ply(path: Path) -> None:
    rows = "\n".join(
        f"{x:.17g} {y:.17g} {z:.17g} {w:.17g}" for (x, y, z), w in zip(PLACES, WETNESS, strict=True)
    )
    faces = "\n".join(f"3 {a} {b} {c}" for a, b, c in FACES)
    axes = "".join(f"property double {name}\n" for name in ("x", "y", "z", "wet"))
    path.write_text(
        f"ply\nformat ascii 1.0\nelement vertex {len(PLACES)}\n{axes}element face {len(FACES)}\n"
        f"property list uchar int vertex_indices\nend_header\n{rows}\n{faces}\n"
    )


def write_vtu(path: Path) -> None:
    data = {"wet": WETNESS, "three": np.zeros((len(PLACES), 3))}
    meshio.Mesh(PLACES, [("triangle", FACES)], point_data=data).write(path)


def write_npz(path: Path) -> None:
    np.savez(path, vertices=PLACES, faces=FACES, field_wet=WETNESS)


def read(path: Path, edge_length: float) -> GarmentMesh:
    return read_mesh_garment(path, units="m", up="y", edge_length=edge_length, attributes=("wet",))


@pytest.mark.parametrize("edge_length", [0.2, 0.04])
@pytest.mark.parametrize(
    ("name", "write"), [("a.ply", write_ply), ("a.vtu", write_vtu), ("a.npz", write_npz)]
)
def test_attributes_of_vertices(tmp_path: Path, name: str, write: object, edge_length: float) -> None:
    """They are linear here, in the coordinates in which the file is refined."""
    assert callable(write)
    write(tmp_path / name)
    garment = read(tmp_path / name, edge_length)
    assert list(garment.attributes) == ["wet"]
    x, y = garment.positions[:, 0], garment.positions[:, 1]
    assert garment.attributes["wet"] == pytest.approx(0.2 + x - 0.5 * y, abs=1e-9)
    assert (len(garment.positions) > len(PLACES)) == (edge_length < 0.1)


def test_an_attribute_that_is_not_there_is_named(tmp_path: Path) -> None:
    write_ply(tmp_path / "a.ply")
    with pytest.raises(InputError, match=r"attribute 'wit'.*did you mean 'wet'"):
        read_mesh_garment(tmp_path / "a.ply", units="m", up="y", attributes=("wit",))


def test_an_array_of_another_length_is_refused(tmp_path: Path) -> None:
    np.savez(tmp_path / "a.npz", vertices=PLACES, faces=FACES, field_wet=WETNESS[1:])
    with pytest.raises(InputError, match=r"`field_wet` has .* rows, but `vertices` has"):
        read(tmp_path / "a.npz", 0.2)
