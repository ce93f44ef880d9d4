"""Garments with fields: what is written comes back, in every format."""

import importlib.util
from pathlib import Path

import meshio
import numpy as np
import pytest

import toile
from toile.dressing.files.meshio_file import read_mesh_file
from toile.dressing.files.surface_check import checked_surface
from toile.dressing.files.writers.field_mesh import FORMATS, FieldMesh, checked_formats, write_field_mesh
from toile.dressing.run.scene_file import load_scene
from toile.geometry.errors import InputError

needs_h5py = pytest.mark.skipif(
    importlib.util.find_spec("h5py") is None, reason="h5py is not installed (pip install 'toile[xdmf]')"
)
EVERY = [pytest.param(name, marks=needs_h5py if name == "xdmf" else ()) for name in FORMATS]
WITH_FIELDS = [entry for entry in EVERY if entry.values[0] != "inp"]
# Two squares sewn along an edge: six nodes, eight material vertices.
POSITIONS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0.5], [2, 1, 0.5]]) / 3.0
FACES = np.array([[0, 1, 2], [0, 2, 3], [1, 4, 5], [1, 5, 2]], dtype=np.int32)
UV = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [5, 0], [6, 0], [6, 1], [5, 1]]) / 7.0
UV_FACES = np.array([[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]], dtype=np.int32)
PANEL = np.array([0, 0, 1, 1], dtype=np.int32)
STRAIN = np.array([[0.01, -0.02], [0.03, 0.04], [0.05, 0.06], [1.0 / 3.0, 0.08]])
MESH = FieldMesh(
    positions=POSITIONS, faces=FACES, uv=UV, uv_faces=UV_FACES, panel=PANEL,
    panel_names=("left front", '2 "back"'), strain=STRAIN,
)  # fmt: skip


@pytest.mark.parametrize("kind", EVERY)
def test_the_surface_comes_back_sewn(kind: str, tmp_path: Path) -> None:
    path = write_field_mesh(tmp_path / f"a.{kind}", MESH)
    surface, notes = read_mesh_file(path, "the garment")
    assert np.abs(surface.positions[surface.faces] - POSITIONS[FACES]).max() < 1e-15
    assert np.array_equal(surface.panel, PANEL)
    assert notes == ()
    sewn = checked_surface(path, surface)
    assert len(sewn.positions) == len(POSITIONS)
    assert [entry.name for entry in tmp_path.iterdir()] == [path.name]


@pytest.mark.parametrize("kind", WITH_FIELDS)
def test_fields_come_back(kind: str, tmp_path: Path) -> None:
    path = write_field_mesh(tmp_path / f"a.{kind}", MESH)
    read = getattr(meshio, {"msh": "gmsh"}.get(kind, kind)).read(path)
    assert np.array_equal(read.cells_dict["triangle"], UV_FACES)
    assert np.array_equal(read.point_data["uv"], np.column_stack([UV, np.zeros(8)]))
    node = read.point_data["node"].astype(int)
    assert np.array_equal(POSITIONS[node], read.points)
    assert np.array_equal(node[UV_FACES], FACES)
    assert np.array_equal(read.cell_data["panel"][0], PANEL)
    assert np.array_equal(read.cell_data["strain_warp"][0], STRAIN[:, 0])
    assert np.array_equal(read.cell_data["strain_weft"][0], STRAIN[:, 1])
    surface = read_mesh_file(path, "the garment").surface
    assert np.array_equal(surface.uv[surface.uv_faces], UV[UV_FACES])


@pytest.mark.parametrize(
    ("kind", "names"), [("msh", ("left front", "2 'back'")), ("inp", ("left_front", "panel_2__back_"))]
)
def test_panels_keep_names(kind: str, names: tuple[str, ...], tmp_path: Path) -> None:
    surface = read_mesh_file(write_field_mesh(tmp_path / f"a.{kind}", MESH), "the garment").surface
    assert surface.panel_names == names


def test_abaqus_gets_shells_on_sewn_nodes(tmp_path: Path) -> None:
    path = write_field_mesh(tmp_path / "a.inp", MESH)
    assert "*ELEMENT, TYPE=S3" in path.read_text()
    read = meshio.abaqus.read(path)
    assert np.array_equal(read.points, POSITIONS)
    assert np.array_equal(read.cells_dict["triangle"], FACES)


@pytest.mark.parametrize("kind", EVERY)
def test_the_same_garment_gives_the_same_bytes(kind: str, tmp_path: Path) -> None:
    (tmp_path / "b").mkdir()
    first, second = (write_field_mesh(folder / f"a.{kind}", MESH) for folder in (tmp_path, tmp_path / "b"))
    assert first.read_bytes() == second.read_bytes()


def test_formats_are_checked_before_anything_is_draped(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shirt = toile.Garment("tshirt")
    assert toile.Scene(garments=[shirt], formats=["vtu", "inp", "vtu"]).formats == ("vtu", "inp")
    with pytest.raises(InputError, match="formats: unknown format 'vtux'; did you mean 'vtu'"):
        toile.Scene(garments=[shirt], formats=["vtux"])
    monkeypatch.setattr("toile.dressing.files.writers.field_mesh.find_spec", lambda _: None)
    with pytest.raises(InputError, match=r"xdmf needs h5py \(pip install 'toile\[xdmf\]'\)"):
        checked_formats(["xdmf"])
    path = tmp_path / "scene.toml"
    path.write_text('formats = ["msh", "vtk"]\n[[garment]]\nsource = "tshirt"\n')
    assert load_scene(path).formats == ("msh", "vtk")
    path.write_text('quality = "preview"\nformats = ["png"]\n[[garment]]\nsource = "tshirt"\n')
    with pytest.raises(InputError, match=r"scene\.toml.*formats: unknown format 'png'; known are: vtu"):
        load_scene(path)
