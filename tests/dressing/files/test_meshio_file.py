"""Mesh formats read by meshio: kinds of cells, panels, texture, and files that are no meshes."""

import importlib.util
from collections.abc import Callable
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
import trimesh

import toile
from toile.dressing.files.meshio_file import FORMATS, read_mesh_file
from toile.dressing.garment.mesh_garment import read_mesh_garment
from toile.dressing.run.scene import MannequinSize
from toile.dressing.run.scene_avatar import load_scene_avatar
from toile.geometry.arrays import Float
from toile.geometry.errors import InputError

SQUARE = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
needs_h5py = pytest.mark.skipif(
    importlib.util.find_spec("h5py") is None, reason="h5py is not installed (pip install 'toile[xdmf]')"
)
EVERY = [pytest.param(name, marks=needs_h5py if name == ".xdmf" else ()) for name in FORMATS]


def written(path: Path, points: Float, cells: Any, **data: Any) -> Path:
    """Write a mesh as a program that uses meshio does."""
    options = {".xdmf": {"data_format": "XML"}, ".msh": {"file_format": "gmsh22"}}.get(path.suffix, {})
    meshio.write(path, meshio.Mesh(points, cells, **data), **options)
    return path


def area(path: Path) -> Float:
    surface = read_mesh_file(path, "the mesh").surface
    a, b, c = surface.positions[surface.faces].transpose(1, 0, 2)
    return np.asarray(0.5 * np.cross(b - a, c - a).sum(axis=0))


def volume(path: Path) -> float:
    surface = read_mesh_file(path, "the mesh").surface
    a, b, c = surface.positions[surface.faces].transpose(1, 0, 2)
    return float(np.einsum("ti,ti->t", a, np.cross(b, c)).sum() / 6.0)


@pytest.mark.parametrize("extension", EVERY)
def test_triangles_come_back_as_they_were(extension: str, tmp_path: Path) -> None:
    ball = trimesh.creation.icosphere(2)
    points = np.asarray(ball.vertices) / 3.0
    surface, notes = read_mesh_file(
        written(tmp_path / f"a{extension}", points, [("triangle", ball.faces)]), "the body"
    )
    assert np.abs(surface.positions - points).max() < 1e-15
    assert np.array_equal(surface.faces, ball.faces)
    assert surface.panel_names == ("garment",)
    assert len(surface.uv) == 0
    assert notes == ()


@pytest.mark.parametrize("binary", [True, False])
@pytest.mark.parametrize("version", ["2.2", "4.1"])
def test_versions_of_gmsh(version: str, binary: bool, tmp_path: Path) -> None:
    mesh = meshio.Mesh(
        SQUARE, [("quad", [[0, 1, 2, 3]])],
        point_data={} if version == "2.2" else {"gmsh:dim_tags": np.array([[2, 1]] * 4)},
        cell_data={"gmsh:physical": [np.array([5])], "gmsh:geometrical": [np.array([1])]},
        field_data={"FRONT": np.array([5, 2])},
    )  # fmt: skip
    meshio.gmsh.write(tmp_path / "a.msh", mesh, fmt_version=version, binary=binary)
    assert area(tmp_path / "a.msh") == pytest.approx([0.0, 0.0, 1.0])
    assert read_mesh_file(tmp_path / "a.msh", "the garment").surface.panel_names == ("FRONT",)


@pytest.mark.parametrize("extension", EVERY)
def test_mixed_cells_are_triangulated_and_lines_left_out(extension: str, tmp_path: Path) -> None:
    points = np.vstack([SQUARE, np.array([[2.0, 0, 0], [2, 1, 0], [3, 0, 0]])])
    cells = [("line", [[0, 1], [1, 2]]), ("quad", [[0, 1, 2, 3], [1, 4, 5, 2]]), ("triangle", [[4, 6, 5]])]
    path = written(tmp_path / f"a{extension}", points, cells)
    surface, notes = read_mesh_file(path, "the body")
    assert len(surface.faces) == 5
    assert area(path) == pytest.approx([0.0, 0.0, 2.5])
    assert surface.file_face.tolist() == [2, 2, 3, 3, 4]
    assert notes == ("Cells without area were left out: 2 of kind line.",)


@pytest.mark.parametrize("extension", [".vtu", ".vtk"])
def test_polygons_are_triangulated(extension: str, tmp_path: Path) -> None:
    angle = np.arange(6) * np.pi / 3.0
    points = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(6)])
    vtk = tmp_path / "hexagon.vtk"
    lines = ["# vtk DataFile Version 4.2", "hexagon", "ASCII", "DATASET UNSTRUCTURED_GRID", "POINTS 6 double"]
    lines += [" ".join(map(repr, row)) for row in points.tolist()]
    vtk.write_text("\n".join([*lines, "CELLS 1 7", "6 0 1 2 3 4 5", "CELL_TYPES 1", "7", ""]))
    path = vtk if extension == ".vtk" else written(tmp_path / "a.vtu", points, meshio.vtk.read(vtk).cells)
    assert len(read_mesh_file(path, "the body").surface.faces) == 4
    assert area(path) == pytest.approx([0.0, 0.0, 1.5 * np.sqrt(3.0)])


CUBE = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]])
SOLIDS = {
    "tetra": ([[0, 1, 3, 4]], 1 / 6, 4),
    "hexahedron": ([[0, 1, 2, 3, 4, 5, 6, 7]], 1.0, 12),
    "wedge": ([[0, 1, 3, 4, 5, 7]], 0.5, 8),
    "pyramid": ([[0, 1, 2, 3, 4]], 1 / 3, 6),
}


@pytest.mark.parametrize("extension", [".vtu", ".msh"])
@pytest.mark.parametrize("kind", SOLIDS)
def test_volume_cells_give_their_surface_facing_outwards(kind: str, extension: str, tmp_path: Path) -> None:
    cells, size, faces = SOLIDS[kind]
    path = written(tmp_path / f"a{extension}", CUBE, [(kind, cells)])
    surface, notes = read_mesh_file(path, "the body")
    assert volume(path) == pytest.approx(size)
    assert len(surface.faces) == faces
    assert "Volume cells were read by their surface." in notes


def test_faces_between_volume_cells_and_listed_twice_are_left_out(tmp_path: Path) -> None:
    """Two cells of one cube each, with the skin of the first listed as quads too, and a flap of its own."""
    points = np.vstack([CUBE, CUBE[[1, 2, 5, 6]] + [1.0, 0, 0], np.array([[0.0, 0, 2], [1, 0, 2]])])
    cells = [
        ("quad", [[0, 1, 5, 4], [4, 5, 13, 12]]),
        ("hexahedron", [[0, 1, 2, 3, 4, 5, 6, 7], [1, 8, 9, 2, 5, 10, 11, 6]]),
    ]
    path = written(tmp_path / "a.vtu", points, cells)
    surface = read_mesh_file(path, "the body").surface
    assert len(surface.faces) == 2 * (10 + 1)
    assert sorted(set(surface.file_face.tolist())) == [1, 2, 3]
    flap = surface.file_face == 1
    assert np.array_equal(np.unique(surface.faces[flap]), [4, 5, 12, 13])


def test_curved_cells_are_read_by_their_corners(tmp_path: Path) -> None:
    points = np.vstack([SQUARE[:3], np.array([[0.5, 0, 0], [1, 0.5, 0], [0.5, 0.5, 0]])])
    surface, notes = read_mesh_file(
        written(tmp_path / "a.vtu", points, [("triangle6", [[0, 1, 2, 3, 4, 5]])]), "the body"
    )
    assert surface.faces.tolist() == [[0, 1, 2]]
    assert notes == ("Curved cells were read by their corners: triangle6.",)


def test_quads_with_a_doubled_corner_are_triangles(tmp_path: Path) -> None:
    path = written(tmp_path / "a.inp", SQUARE, [("quad", [[0, 1, 2, 2], [0, 2, 3, 3]])])
    assert len(read_mesh_file(path, "the body").surface.faces) == 2
    assert area(path) == pytest.approx([0.0, 0.0, 1.0])


def test_points_in_a_plane_get_a_third_coordinate(tmp_path: Path) -> None:
    path = tmp_path / "a.inp"
    path.write_text("*NODE\n1, 0, 0\n2, 1, 0\n3, 0, 1\n*ELEMENT, TYPE=CPS3\n1, 1, 2, 3\n")
    assert read_mesh_file(path, "the body").surface.positions.shape == (3, 3)


def test_panels_of_element_sets_physical_surfaces_and_cell_data(tmp_path: Path) -> None:
    two = [("triangle", [[0, 1, 2], [0, 2, 3]])]
    all_cells, front = [np.array([0, 1])], [np.array([1])]
    abaqus = written(tmp_path / "a.inp", SQUARE, two, cell_sets={"FRONT": front, "ALL": all_cells})
    tags = {"gmsh:physical": [np.array([3, 7])], "gmsh:geometrical": [np.array([1, 1])]}
    groups = {"ALL": np.array([3, 2]), "FRONT": np.array([7, 2])}
    gmsh = tmp_path / "a.msh"
    meshio.gmsh.write(gmsh, meshio.Mesh(SQUARE, two, field_data=groups, cell_data=tags), fmt_version="2.2")
    for path in (abaqus, gmsh):
        surface = read_mesh_file(path, "the garment").surface
        assert [surface.panel_names[index] for index in surface.panel] == ["ALL", "FRONT"]
    path = written(tmp_path / "a.vtu", SQUARE, two, cell_data={"panel": [np.array([4, 2])]})
    surface = read_mesh_file(path, "the garment").surface
    assert [surface.panel_names[index] for index in surface.panel] == ["panel_4", "panel_2"]


def test_texture_coordinates_give_the_warp(tmp_path: Path) -> None:
    cells = [("triangle", [[0, 1, 2], [0, 2, 3]])]
    turned = SQUARE[:, [1, 0, 2]] * [1.0, -1.0, 0.0]
    plain = read_mesh_garment(written(tmp_path / "a.vtu", SQUARE, cells))
    textured = read_mesh_garment(written(tmp_path / "b.vtu", SQUARE, cells, point_data={"UV": turned}))
    # Warp is dX/dv: up without texture, and here along -x.
    assert np.allclose(plain.rest_corners[0, 2] - plain.rest_corners[0, 1], [1.0, 0.0])
    assert np.allclose(textured.rest_corners[0, 1] - textured.rest_corners[0, 0], [-1.0, 0.0])
    assert np.allclose(textured.uv, turned[:, :2])


BAD = {
    "no.vtu": ("<VTKFile", "cannot be read as .vtu"),
    "no.vtk": ("hello", "cannot be read as .vtk (Illegal VTK header)"),
    "no.msh": ("hello", "cannot be read as .msh"),
    "poly.vtk": (
        "# vtk DataFile Version 4.2\nx\nASCII\nDATASET POLYDATA\nPOINTS 0 float\n",
        "cannot be read as .vtk (Only VTK 'UNSTRUCTURED_GRID'",
    ),
    "short.vtk": (
        "# vtk DataFile Version 4.2\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 3 float\n0 0 0 1 0 0\nCELLS",
        "cannot be read as .vtk",
    ),
    "none.inp": ("*HEADING\n", "holds no points in space"),
    "type.inp": ("*NODE\n1, 0, 0, 0\n*ELEMENT, TYPE=XX\n1, 1\n", "Element type not available: XX"),
    "gone.inp": ("*NODE\n1, 0, 0, 0\n*ELEMENT, TYPE=S3\n1, 1, 2, 3\n", "cannot be read as .inp"),
    "line.inp": ("*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n*ELEMENT, TYPE=T3D2\n1, 1, 2\n", "holds no surface"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_files_are_named_with_what_to_do(
    name: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    text, message = BAD[name]
    (tmp_path / name).write_text(text)
    with pytest.raises(InputError) as error:
        read_mesh_file(tmp_path / name, "the body")
    said = str(error.value)
    assert said.startswith(f"{tmp_path / name}: ")
    assert message in said
    assert "export the body" in said
    assert "\n" not in said
    assert capfd.readouterr() == ("", "")


def test_bad_cells_are_named(tmp_path: Path) -> None:
    cells = [("line", [[0, 1]]), ("triangle", [[0, 1, 2], [0, 2, 9]])]
    with pytest.raises(InputError, match="cell 2 refers to a point that does not exist"):
        read_mesh_file(written(tmp_path / "a.vtu", SQUARE, cells), "the body")
    path = written(tmp_path / "b.vtu", SQUARE, [("VTK_LAGRANGE_TRIANGLE", [[0, 1, 2]])])
    with pytest.raises(InputError, match="cells of kind 'VTK_LAGRANGE_TRIANGLE', which are not read"):
        read_mesh_file(path, "the body")


def test_files_that_need_a_missing_library_say_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.xdmf"
    path.write_text("<Xdmf/>")

    def read(_: str) -> None:
        raise ModuleNotFoundError("No module named 'h5py'", name="h5py")

    monkeypatch.setattr(meshio.xdmf, "read", read)
    with pytest.raises(InputError, match=r"\.xdmf files need h5py .*or export the body as \.vtu"):
        read_mesh_file(path, "the body")


def test_what_meshio_prints_and_ends_becomes_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "a.vtu").write_text("x")

    def read(_: str) -> None:
        print("about to end")
        raise SystemExit(1)

    monkeypatch.setattr(meshio.vtu, "read", read)
    with pytest.raises(InputError, match="cannot be read as"):
        read_mesh_file(tmp_path / "a.vtu", "the body")
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("extension", EVERY)
def test_bodies_are_read_in_their_units_with_notes(extension: str, tmp_path: Path) -> None:
    body = trimesh.creation.capsule(height=1.4, radius=0.15)
    cells = [("line", [[0, 1]]), ("triangle", body.faces)]
    path = written(tmp_path / f"body{extension}", 1000.0 * np.asarray(body.vertices), cells)
    avatar = toile.load_avatar(path)
    assert (avatar.metres_per_unit, avatar.up_axis) == (0.001, "z")
    assert np.ptp(avatar.vertices[:, 1]) == pytest.approx(np.ptp(body.vertices[:, 2]))
    assert avatar.notes[0].startswith("Cells without area were left out: 1 of kind")


def test_a_garment_of_a_vtu_file_is_dressed(fake_drape: Callable[..., Any], tmp_path: Path) -> None:
    """In centimetres, with two panels: units are recognised on the body, the panels keep their place."""
    fake = fake_drape()
    body = load_scene_avatar(MannequinSize())
    waist = np.array([0.0, 1.0, 0.0])
    tube = trimesh.creation.cylinder(radius=0.3, height=0.4, sections=24, cap=False)
    points = 100.0 * (np.asarray(tube.vertices)[:, [1, 2, 0]] + waist)
    panel = np.arange(len(tube.faces)) % 2
    path = written(tmp_path / "tube.vtu", points, [("triangle", tube.faces)], cell_data={"panel": [panel]})
    result = toile.dress(
        toile.Scene(avatar=body, garments=[toile.Garment(path)], remesh=False, formats=["vtu"]),
        tmp_path / "out",
    )
    assert result.status == "converged"
    ((mesh, _),) = fake.calls[0][1]
    assert mesh.panel_names == ("panel_0", "panel_1")
    assert np.allclose(mesh.positions.min(axis=0), points.min(axis=0) / 100.0)
    assert np.allclose(mesh.positions.max(axis=0), points.max(axis=0) / 100.0)
    again = read_mesh_garment(tmp_path / "out" / "tube.vtu")
    assert np.array_equal(again.faces, mesh.faces)
    assert np.array_equal(again.positions, mesh.positions)
