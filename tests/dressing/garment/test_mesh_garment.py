from pathlib import Path

import numpy as np
import pytest
import trimesh

from toile.dressing.body.avatar import Avatar
from toile.dressing.garment.mesh_garment import read_mesh_garment
from toile.dressing.garment.mesh_subdivision import subdivide
from toile.geometry.arrays import Float
from toile.geometry.errors import InputError

# A tent of two panels: 3-D vertices are shared, texture vertices are not.
TENT = """\
v 0 1 0
v 0 1 1
v 1 0 0
v 1 0 1
v -1 0 0
v -1 0 1
vt 0 0
vt 1 0
vt 0 1.4
vt 1 1.4
vt 3 0
vt 4 0
vt 3 1.4
vt 4 1.4
g right
f 1/1 2/2 4/4 3/3
g left
f 2/6 1/5 5/7 6/8
"""


def write(folder: Path, text: str, name: str = "tent.obj") -> Path:
    path = folder / name
    path.write_text(text)
    return path


def body() -> Avatar:
    box = trimesh.creation.box((0.5, 1.7, 0.3))
    return Avatar(
        name="box",
        vertices=np.add(box.vertices, (0.0, 0.85, 0.0)),
        faces=np.array(box.faces, dtype=np.int32),
    )


def tube(radius: float, height: float) -> trimesh.Trimesh:
    """A tube of 24 quads around the z axis."""
    turn = 2.0 * np.pi * np.arange(24) / 24
    ring = radius * np.column_stack([np.cos(turn), np.sin(turn), np.zeros(24)])
    i, j = np.arange(24), (np.arange(24) + 1) % 24
    faces = np.concatenate([np.column_stack([i, j, j + 24]), np.column_stack([i, j + 24, i + 24])])
    return trimesh.Trimesh(np.concatenate([ring, np.add(ring, (0.0, 0.0, height))]), faces, process=False)


def edge_lengths(corners: Float) -> Float:
    return np.asarray(np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2))


def test_nodes_stay_shared_across_texture_seams(tmp_path: Path) -> None:
    tent = read_mesh_garment(write(tmp_path, TENT))
    assert len(tent.positions) == 8
    assert not tent.flat
    assert tent.panel_names == ("right", "left")
    assert tent.panel.tolist() == [0, 0, 1, 1]
    assert len(tent.stitches) == 2
    joined = tent.positions[tent.stitches]
    assert np.array_equal(joined[:, 0], joined[:, 1])


def test_rest_shape_is_isometric_and_warp_follows_v(tmp_path: Path) -> None:
    tent = read_mesh_garment(write(tmp_path, TENT))
    corners = tent.positions[tent.faces]
    assert np.allclose(edge_lengths(corners), edge_lengths(tent.rest_corners), atol=1e-14)
    flat = tent.rest_corners
    area = flat[:, 1, 0] * flat[:, 2, 1] - flat[:, 1, 1] * flat[:, 2, 0]
    assert (area > 0.0).all()
    # v runs down the slope, u along the ridge: warp coordinates follow v up to scale.
    v = tent.uv[tent.faces][..., 1]
    warp = flat[..., 0] - flat[:, :1, 0]
    assert np.allclose(warp, (v - v[:, :1]) * np.sqrt(2.0) / 1.4)


def test_without_uv_the_warp_is_vertical(tmp_path: Path) -> None:
    wall = write(tmp_path, "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n")
    mesh = read_mesh_garment(wall)
    y = mesh.positions[mesh.faces][..., 1]
    assert np.allclose(mesh.rest_corners[..., 0], y - y[:, :1])
    assert not mesh.uv.any()
    assert len(mesh.stitches) == 0


@pytest.mark.parametrize("extension", [".ply", ".glb"])
def test_vertices_split_by_exporters_grow_together(tmp_path: Path, extension: str) -> None:
    soup = tube(0.3, 0.6).triangles.reshape(-1, 3)
    path = tmp_path / f"tube{extension}"
    trimesh.Trimesh(soup, np.arange(len(soup)).reshape(-1, 3), process=False).export(path)
    welded = read_mesh_garment(path)
    assert len(welded.positions) == 48
    assert len(welded.faces) == 48


@pytest.mark.parametrize("height", [3.0, 100.0])
def test_a_mesh_of_wrong_units_is_not_split_for_ever(tmp_path: Path, height: float) -> None:
    """A sliver and a wall of kilometres."""
    path = write(tmp_path, f"v 0 0 0\nv 100000 0 0\nv 100000 {height} 0\nf 1 2 3\n", "wall.obj")
    with pytest.raises(InputError, match=r"garment 'wall': the mesh is 1e\+05 m large.*units") as caught:
        read_mesh_garment(path, units="m", edge_length=0.01)
    assert caught.value.file == path and caught.value.garment == "wall"


def test_concave_quads_are_split_inside(tmp_path: Path) -> None:
    dart = "v 0 0 0\nv 2 0 0\nv 0.5 0.5 0\nv 0 2 0\nf 1 2 3 4\nf 4 3 2 1\n"
    one = read_mesh_garment(write(tmp_path, dart.replace("f 4 3 2 1\n", "")))
    normals = np.cross(*np.moveaxis(np.diff(one.positions[one.faces], axis=1), 1, 0))
    assert (normals[:, 2] > 0.0).all()


def test_inconsistent_winding_follows_the_majority(tmp_path: Path) -> None:
    strip = "".join(f"v {i} {j} 0\n" for i in range(5) for j in range(2))
    quads = [f"f {2 * i + 1} {2 * i + 3} {2 * i + 4} {2 * i + 2}\n" for i in range(4)]
    quads[2] = "f 6 8 7 5\n"
    mesh = read_mesh_garment(write(tmp_path, strip + "".join(quads)))
    normals = np.cross(*np.moveaxis(np.diff(mesh.positions[mesh.faces], axis=1), 1, 0))
    assert (normals[:, 2] > 0.0).all()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "no faces"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\n", "no faces"),
        ("v 1e300 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", r"vertex 0 lies 1e\+300 m from the origin"),
        ("v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "1 vertices are not finite"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "line 4: index 9 of 3"),
        ("v 0 0 0\nv 1 0 x\n", "line 2"),
        ("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "no face has an area"),
    ],
)
def test_bad_meshes_name_the_faces(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        read_mesh_garment(write(tmp_path, text))
    assert "\n" not in str(caught.value)


def test_moebius_strip_is_refused(tmp_path: Path) -> None:
    count, lines = 24, []
    for i in range(count):
        turn = 2.0 * np.pi * i / count
        for side in (-0.2, 0.2):
            radius = 1.0 + side * np.cos(turn / 2)
            lines.append(f"v {radius * np.cos(turn)} {side * np.sin(turn / 2)} {radius * np.sin(turn)}\n")
    for i in range(count - 1):
        lines.append(f"f {2 * i + 1} {2 * i + 2} {2 * i + 4} {2 * i + 3}\n")
    lines.append(f"f {2 * count - 1} {2 * count} 1 2\n")
    with pytest.raises(InputError, match="Moebius"):
        read_mesh_garment(write(tmp_path, "".join(lines)))


def test_units_and_axes_are_those_that_fit_the_body(tmp_path: Path) -> None:
    shape = tube(0.35, 0.5)
    shape.apply_translation((0.0, 0.0, 0.65))
    shape.apply_scale(100.0)
    path = tmp_path / "tube.obj"
    shape.export(path, include_normals=False)
    placed = read_mesh_garment(path, avatar=body())
    assert np.allclose(placed.positions.mean(axis=0), (0.0, 0.9, 0.0), atol=0.02)
    given = read_mesh_garment(path, avatar=body(), units="cm", up="z")
    assert np.array_equal(given.positions, placed.positions)
    with pytest.raises(InputError, match="unknown unit 'inch'"):
        read_mesh_garment(path, units="inch")


def test_subdivision_keeps_the_surface_and_the_angles(tmp_path: Path) -> None:
    tent = read_mesh_garment(write(tmp_path, TENT))
    fine = read_mesh_garment(write(tmp_path, TENT), edge_length=0.05)
    corners = fine.positions[fine.faces]
    assert edge_lengths(corners).max() <= 1.4 * 0.05
    area = 0.5 * np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    assert area.sum() == pytest.approx(2.0 * np.sqrt(2.0))
    assert fine.minimum_angle >= 0.5 * tent.minimum_angle
    # Every inner edge has two faces: no hanging nodes.
    node = np.unique(fine.positions, axis=0, return_inverse=True)[1].ravel()[fine.faces]
    ends = np.sort(np.stack([node, np.roll(node, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    edges, counts = np.unique(ends, axis=0, return_counts=True)
    assert counts.max() == 2
    assert len(np.unique(node)) - len(edges) + len(fine.faces) == 1  # Euler number of a disc


def test_subdivision_leaves_short_edges_alone() -> None:
    positions = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    faces = np.array([[0, 1, 2]], dtype=np.int32)
    node = np.arange(3, dtype=np.int32)
    result = subdivide(positions, positions[:, :2], node, faces, longest=2.0)
    assert np.array_equal(result[3], faces)


def test_real_garments(data_dir: Path) -> None:
    for path in sorted((data_dir / "garments").glob("*.obj")):
        mesh = read_mesh_garment(path)
        corners = mesh.positions[mesh.faces]
        assert np.allclose(edge_lengths(corners), edge_lengths(mesh.rest_corners), atol=1e-12), path
