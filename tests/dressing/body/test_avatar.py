"""Avatars: reading, recognition of the frame, repair, and what happens to bad files."""

from pathlib import Path

import manifold3d
import numpy as np
import pytest
import trimesh

from toile.dressing.body.avatar import Avatar, load_avatar
from toile.dressing.body.avatar_crossings import crossing_pairs
from toile.dressing.body.avatar_holes import boundary_loops, fill_loop
from toile.dressing.body.avatar_repair import repaired_surface
from toile.dressing.body.avatar_topology import join_corners, orient_faces
from toile.geometry.arrays import Float, Int
from toile.geometry.errors import InputError

ALL_BODIES = (
    "mean_all.obj mean_female.ply mean_male.ply mean_all_apart.ply f_smpl_average_A40.ply "
    "anny_child_apose.ply anny_f_apose.ply anny_f_armsup.ply anny_f_heavy_twist.ply anny_m_sit.ply "
    "anny_m_tpose.ply anny_m_walk.ply mh_child_8.ply mh_f_average.ply mh_f_heavy_short.ply "
    "mh_f_pregnant.ply mh_f_slim_tall.ply mh_m_average.ply mh_m_heavy.ply mh_m_muscular.ply mh_m_old.ply"
).split()


def capsule(height: float = 1.7, radius: float = 0.2) -> tuple[Float, Int]:
    """A closed body-sized capsule, Y up, its lowest point at y = 0."""
    mesh = trimesh.creation.capsule(height=height - 2.0 * radius, radius=radius, count=(16, 16))
    vertices = np.asarray(mesh.vertices)[:, [1, 2, 0]]
    vertices[:, 1] -= vertices[:, 1].min()
    return np.ascontiguousarray(vertices), np.ascontiguousarray(mesh.faces, dtype=np.int32)


def write(path: Path, vertices: Float, faces: Int) -> Path:
    trimesh.Trimesh(vertices, faces, process=False).export(path)
    return path


def assert_closed_and_outward(vertices: Float, faces: Int) -> None:
    half_edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]).astype(np.int64)
    forward = half_edges[:, 0] * len(vertices) + half_edges[:, 1]
    backward = half_edges[:, 1] * len(vertices) + half_edges[:, 0]
    assert len(np.unique(forward)) == len(forward)
    np.testing.assert_array_equal(np.sort(forward), np.sort(backward))
    solid = manifold3d.Manifold(
        manifold3d.Mesh64(vert_properties=vertices, tri_verts=faces.astype(np.uint64))
    )
    assert solid.status() == manifold3d.Error.NoError
    assert solid.volume() > 0.0


def volume(vertices: Float, faces: Int) -> float:
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


@pytest.mark.parametrize("extension", ["obj", "ply", "stl", "glb"])
@pytest.mark.parametrize(("unit", "metres"), [("m", 1.0), ("cm", 0.01), ("mm", 0.001)])
@pytest.mark.parametrize("up", ["y", "z"])
def test_units_and_axis_are_recognised(
    tmp_path: Path, extension: str, unit: str, metres: float, up: str
) -> None:
    vertices, faces = capsule()
    # Unlike in x, y and z, and off-centre, so that every swap and flip shows.
    vertices = vertices * (1.5, 1.0, 0.8) + (0.05, 0.0, 0.02)
    source = vertices / metres
    if up == "z":
        source = source[:, [0, 2, 1]] * (1.0, -1.0, 1.0)
    given_up = up if extension == "glb" else None
    avatar = load_avatar(write(tmp_path / f"body.{extension}", source, faces), up=given_up)
    assert avatar.up_axis == up
    assert avatar.metres_per_unit == metres
    assert any(f"Units: {unit} " in note for note in avatar.notes)
    np.testing.assert_allclose(avatar.vertices.min(axis=0), vertices.min(axis=0), atol=1e-6)
    np.testing.assert_allclose(avatar.vertices.max(axis=0), vertices.max(axis=0), atol=1e-6)
    assert len(avatar.faces) == len(faces)
    assert_closed_and_outward(avatar.vertices, avatar.faces)
    back = avatar.to_source(avatar.vertices)
    np.testing.assert_allclose(back.min(axis=0), source.min(axis=0), rtol=1e-6, atol=1e-6 / metres)
    np.testing.assert_allclose(back.max(axis=0), source.max(axis=0), rtol=1e-6, atol=1e-6 / metres)


def test_a_body_facing_the_blender_front_faces_z(tmp_path: Path) -> None:
    vertices, faces = capsule()
    vertices[:, 2] += np.where(vertices[:, 1] < 0.2, 0.1, 0.0)  # feet forward
    blender = vertices[:, [0, 2, 1]] * (1.0, -1.0, 1.0)
    avatar = load_avatar(write(tmp_path / "b.ply", blender, faces))
    feet = avatar.vertices[:, 1] < 0.2
    assert avatar.vertices[feet, 2].mean() > avatar.vertices[~feet, 2].mean() + 0.05


def test_given_units_and_axis_win(tmp_path: Path) -> None:
    vertices, faces = capsule()
    path = write(tmp_path / "doll.ply", vertices * 10.0, faces)
    avatar = load_avatar(path, units="dm", up="y")
    assert np.ptp(avatar.vertices[:, 1]) == pytest.approx(1.7, rel=1e-6)
    assert not avatar.notes


@pytest.mark.parametrize(("scale", "size"), [(0.01, "0.017 m in m"), (10.0, "17 m in m")])
def test_a_coin_and_a_tower_are_refused(tmp_path: Path, scale: float, size: str) -> None:
    vertices, faces = capsule()
    path = write(tmp_path / "odd.obj", vertices * scale, faces)
    with pytest.raises(InputError, match=rf"odd.obj.*{size}.*give its units"):
        load_avatar(path)


def test_absurd_given_units_are_refused(tmp_path: Path) -> None:
    vertices, faces = capsule()
    with pytest.raises(InputError, match="170 m large in m; give the correct units"):
        load_avatar(write(tmp_path / "cm.obj", vertices * 100.0, faces), units="m")


def test_bad_files_are_named(tmp_path: Path) -> None:
    vertices, faces = capsule()
    cases: dict[str, str] = {}
    (tmp_path / "body.fbx").write_text("x")
    cases["body.fbx"] = "FBX is a closed format; open it in Blender and export .glb"
    cases["missing.obj"] = "not found"
    (tmp_path / "empty.obj").write_text("")
    cases["empty.obj"] = "empty.obj"
    (tmp_path / "cloud.obj").write_text("v 0 0 0\nv 0 1.7 0\nv 0.2 1 0\n")
    cases["cloud.obj"] = "cloud.obj"
    trimesh.PointCloud(vertices).export(tmp_path / "cloud.ply")
    cases["cloud.ply"] = "no triangles"
    bad = vertices.copy()
    bad[7, 1] = np.nan
    write(tmp_path / "nan.ply", bad, faces)
    cases["nan.ply"] = "NaN or infinite coordinates .first: vertex 7."
    (tmp_path / "text.glb").write_text("this is no mesh")
    cases["text.glb"] = "cannot be read as a mesh"
    (tmp_path / "text.ply").write_text("this is no mesh")
    cases["text.ply"] = "cannot be read as a mesh"
    write(tmp_path / "flat.ply", np.array([[0, 0, 0], [1, 0, 0], [0, 1.7, 0.0]]), np.array([[0, 1, 2]]))
    cases["flat.ply"] = "encloses no volume"
    (tmp_path / "folder.obj").mkdir()
    cases["folder.obj"] = "not found"
    for name, message in cases.items():
        with pytest.raises(InputError, match=message) as caught:
            load_avatar(tmp_path / name)
        assert "\n" not in str(caught.value)
        assert name in str(caught.value)
    with pytest.raises(InputError, match="unknown unit 'inch'"):
        load_avatar(tmp_path / "nan.ply", units="inch")
    with pytest.raises(InputError, match="unknown up axis 'x'"):
        load_avatar(tmp_path / "nan.ply", up="x")


def test_a_clean_body_is_left_alone() -> None:
    vertices, faces = capsule()
    repaired_vertices, repaired_faces, notes = repaired_surface("body", vertices, faces)
    np.testing.assert_array_equal(repaired_vertices, vertices)
    np.testing.assert_array_equal(repaired_faces, faces)
    assert notes == ()


def test_triangle_soup_with_every_second_face_flipped_is_repaired() -> None:
    vertices, faces = capsule()
    soup = vertices[faces].reshape(-1, 3)
    soup_faces = np.arange(len(soup), dtype=np.int32).reshape(-1, 3)
    soup_faces[::2] = soup_faces[::2, ::-1]
    soup_faces = np.concatenate([soup_faces, soup_faces[5:9], [[0, 0, 1]]]).astype(np.int32)
    result, result_faces, notes = repaired_surface("soup", soup, soup_faces)
    assert len(result) == len(vertices)
    assert len(result_faces) == len(faces)
    assert_closed_and_outward(result, result_faces)
    assert volume(result, result_faces) == pytest.approx(volume(vertices, faces), rel=1e-12)
    text = " ".join(notes)
    assert "merged" in text
    assert "dropped" in text
    assert "turned outward" in text


def test_an_inside_out_body_is_turned() -> None:
    vertices, faces = capsule()
    _, turned, notes = repaired_surface("b", vertices, np.ascontiguousarray(faces[:, ::-1]))
    np.testing.assert_array_equal(np.sort(turned, axis=1), np.sort(faces, axis=1))
    assert volume(vertices, turned) > 0.0
    assert notes == (f"{len(faces)} faces were turned outward.",)


def test_holes_are_filled_and_said() -> None:
    vertices, faces = capsule()
    # A bust cut off flat at the lower end, and one missing vertex at the side (curved loop).
    faces = faces[vertices[faces, 1].min(axis=1) > 0.199]
    lowest = vertices[faces, 1].min()
    near_top = int(np.argmin(np.abs(vertices[:, 1] - 1.6)))
    faces = faces[(faces != near_top).all(axis=1)]
    result, result_faces, notes = repaired_surface("bust", vertices, faces)
    assert_closed_and_outward(result, result_faces)
    assert any(note.startswith("2 holes of") for note in notes)
    assert result[:, 1].min() == lowest


def test_flat_concave_hole_is_capped_in_its_plane() -> None:
    loop = np.array([[0, 0, 0], [2, 0, 0], [2, 2, 0], [1, 0.5, 0], [0, 2, 0.0]])
    triangles = fill_loop(loop)
    a, b, c = (loop[triangles[:, k]] for k in range(3))
    signed = 0.5 * np.cross(b - a, c - a)[:, 2]
    assert (signed > 0.0).all()
    assert signed.sum() == pytest.approx(2.5)


def test_curved_hole_gets_the_patch_of_least_area() -> None:
    # A square bent along one diagonal: of its two triangulations, one is smaller.
    loop = np.array([[0, 0, 0], [1, 0, 0.4], [1.5, 1.5, 0], [0, 1, 0.4]])
    triangles = fill_loop(loop)

    def area(faces: Int) -> float:
        a, b, c = (loop[faces[:, k]] for k in range(3))
        return float(0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())

    options = [np.array([[0, 1, 2], [0, 2, 3]]), np.array([[0, 1, 3], [1, 2, 3]])]
    assert area(triangles) == pytest.approx(min(area(option) for option in options))


def test_boundary_loops_run_so_that_caps_agree_with_the_faces() -> None:
    vertices, faces = capsule()
    opened = faces[10:]
    loops = boundary_loops(opened)
    closed = [opened]
    for loop in loops:
        patch = fill_loop(vertices[loop])
        closed.append(loop[patch])
    assert_closed_and_outward(vertices, np.concatenate(closed).astype(np.int32))


def test_a_third_face_on_an_edge_leaves_the_loops_of_the_others_whole() -> None:
    """A box with a corner of a face moved: three faces on an edge, and a hole beside it."""
    corners = np.array([(x, y, z) for x in (-0.3, 0.3) for y in (0.0, 1.6) for z in (-0.15, 0.15)])
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    whole = [face for a, b, c, d in quads for face in ((a, b, c), (a, c, d))]
    for number in range(12):
        for corner in range(3):
            for other in range(8):
                faces = np.array(whole, np.int32)
                if other in faces[number]:
                    continue
                faces[number, corner] = other
                try:
                    vertices, found, _ = repaired_surface("box", corners, faces)
                except InputError as error:
                    assert "box: the " in str(error)
                    continue
                # A cap may come to lie on an edge that two faces share already.
                ends = np.concatenate([found[:, [0, 1]], found[:, [1, 2]], found[:, [2, 0]]])
                assert sorted(map(tuple, ends.tolist())) == sorted(map(tuple, ends[:, ::-1].tolist()))
                assert volume(vertices, found) > 0.0


def test_parts_are_united_and_inner_ones_vanish() -> None:
    vertices, faces = capsule()
    ball = trimesh.creation.icosphere(subdivisions=2, radius=0.1)
    eye = np.asarray(ball.vertices) + np.array([0.0, 1.4, 0.0])  # inside
    nose = np.asarray(ball.vertices) + np.array([0.0, 1.4, 0.2])  # half outside
    count = len(vertices)
    everything = np.concatenate([vertices, eye, nose])
    ball_faces = np.asarray(ball.faces)
    all_faces = np.concatenate([faces, ball_faces[:, ::-1] + count, ball_faces + count + len(eye)])
    result, result_faces, notes = repaired_surface("parts", everything, all_faces.astype(np.int32))
    assert_closed_and_outward(result, result_faces)
    assert any("3 closed parts were united into one body" in note for note in notes)
    assert not len(crossing_pairs(result, result_faces))
    body, bump = volume(vertices, faces), volume(nose, ball_faces)
    assert body < volume(result, result_faces) < body + bump
    assert not ((np.linalg.norm(result - (0.0, 1.4, 0.0), axis=1) < 0.11).any())


def test_bodies_that_share_an_edge_come_apart() -> None:
    # Two tetrahedra on one common edge: four faces around it, paired so that each stays closed.
    vertices = np.array([[0, 0, 0], [0, 1, 0], [1, 0, 0], [1, 0, 1], [-1, 0, 0], [-1, 0, -1.0]])
    faces = np.array(
        [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2], [0, 1, 4], [0, 5, 1], [0, 4, 5], [1, 5, 4]],
        dtype=np.int32,
    )
    split, split_faces, added = join_corners(vertices, faces)
    assert added == 2
    assert not set(split_faces[:4].ravel()) & set(split_faces[4:].ravel())
    np.testing.assert_array_equal(split[split_faces], vertices[faces])


def test_orientation_follows_the_majority() -> None:
    _, faces = capsule()
    generator = np.random.default_rng(3)
    flipped = generator.random(len(faces)) < 0.3
    mixed = faces.copy()
    mixed[flipped] = mixed[flipped][:, ::-1]
    oriented, part, turned, one_sided = orient_faces(mixed)
    np.testing.assert_array_equal(oriented, np.where(flipped[:, None], mixed[:, ::-1], mixed))
    assert (part == 0).all()
    assert turned == np.count_nonzero(flipped)
    assert one_sided == -1


def test_a_moebius_strip_is_refused() -> None:
    count = 24
    angle = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    radial = np.column_stack([np.cos(angle), np.zeros(count), np.sin(angle)])
    across = np.cos(angle / 2)[:, None] * radial + np.sin(angle / 2)[:, None] * np.array([0.0, 1.0, 0.0])
    vertices = np.stack([radial - 0.3 * across, radial + 0.3 * across], axis=1).reshape(-1, 3)
    quads = []
    for k in range(count):
        a, b = 2 * k, 2 * k + 1
        c, d = (2 * k + 2, 2 * k + 3) if k < count - 1 else (1, 0)
        quads += [(a, b, c), (b, d, c)]
    with pytest.raises(InputError, match="only one side"):
        repaired_surface("strip", vertices, np.array(quads, dtype=np.int32))


def test_crossings_are_found_and_named() -> None:
    vertices, faces = capsule()
    # Push a patch of the left side through to the right side: one closed surface that crosses itself.
    patch = (vertices[:, 0] > 0.15) & (np.abs(vertices[:, 1] - 1.5) < 0.1)
    pushed = vertices.copy()
    pushed[patch, 0] = -0.3
    pushed += 1e-3 * np.random.default_rng(5).random(pushed.shape)  # no ties
    pairs = crossing_pairs(pushed, faces)
    assert len(pairs)

    def brute_force() -> set[tuple[int, int]]:
        found = set()
        for i in range(len(faces)):
            for k in range(i + 1, len(faces)):
                if not set(faces[i]) & set(faces[k]) and _cross(pushed[faces[i]], pushed[faces[k]]):
                    found.add((i, k))
        return found

    assert {tuple(pair) for pair in pairs.tolist()} == brute_force()
    result, result_faces, notes = repaired_surface("b", pushed, faces)
    np.testing.assert_array_equal(result, pushed)
    np.testing.assert_array_equal(result_faces, faces)
    assert any(f"crosses itself in {len(pairs)} pairs" in note for note in notes)


def _cross(a: Float, b: Float) -> bool:
    """Whether an edge of one triangle passes through the other: a small linear system per edge."""
    for edges, face in ((a, b), (b, a)):
        for k in range(3):
            start, end = edges[k], edges[(k + 1) % 3]
            system = np.column_stack([start - end, face[1] - face[0], face[2] - face[0]])
            if abs(np.linalg.det(system)) < 1e-15:
                continue
            t, u, v = np.linalg.solve(system, start - face[0])
            if 0.0 < t < 1.0 and u > 0.0 and v > 0.0 and u + v < 1.0:
                return True
    return False


@pytest.mark.parametrize("edges", [480, 900])
def test_a_long_curved_hole_is_filled(edges: int) -> None:
    """A tube with a flat bottom whose upper border is a wave of many edges."""
    angle = 2.0 * np.pi * np.arange(edges) / edges
    ring = np.column_stack([0.2 * np.cos(angle), np.zeros(edges), 0.15 * np.sin(angle)])
    wave = ring + np.column_stack([0.0 * angle, 1.5 + 0.05 * np.sin(3.0 * angle), 0.0 * angle])
    i, j = np.arange(edges), (np.arange(edges) + 1) % edges
    sides = np.concatenate([np.stack([i, i + edges, j], 1), np.stack([j, i + edges, j + edges], 1)])
    vertices, faces, notes = repaired_surface("tube", np.concatenate([ring, wave]), sides.astype(np.int32))
    assert_closed_and_outward(vertices, faces)
    assert len(faces) == 2 * edges + 2 * (edges - 2)
    assert volume(vertices, faces) == pytest.approx(1.5 * np.pi * 0.2 * 0.15, rel=2e-3)
    assert any(f"2 holes of {edges} to {edges} edges filled" in note for note in notes)
    assert not any("crosses itself" in note for note in notes)


def test_a_scene_of_moved_and_mirrored_parts_is_placed(tmp_path: Path) -> None:
    vertices, faces = capsule()
    mesh = trimesh.Trimesh(vertices, faces, process=False)
    mirror = np.diag([-1.0, 1.0, 1.0, 1.0])
    mirror[0, 3] = 0.2
    scene = trimesh.Scene()
    scene.add_geometry(mesh, geom_name="body")
    scene.add_geometry(mesh, geom_name="twin", transform=mirror)
    path = tmp_path / "scene.glb"
    path.write_bytes(scene.export(file_type="glb"))
    avatar = load_avatar(path)
    assert_closed_and_outward(avatar.vertices, avatar.faces)
    assert avatar.vertices[:, 0].max() == pytest.approx(0.4, abs=1e-3)
    assert any("2 closed parts were united" in note for note in avatar.notes)


def _assert_body(avatar: Avatar) -> None:
    assert_closed_and_outward(avatar.vertices, avatar.faces)
    assert avatar.metres_per_unit == 1.0
    assert avatar.up_axis == "y"
    assert 1.1 < np.ptp(avatar.vertices[:, 1]) < 2.0


@pytest.mark.parametrize("name", ["mean_all.obj", "mh_f_average.ply", "anny_m_sit.ply", "anny_m_tpose.ply"])
def test_real_bodies_load_as_they_are(data_dir: Path, name: str) -> None:
    avatar = load_avatar(data_dir / "bodies" / name)
    _assert_body(avatar)
    assert all("crosses itself" in n or "Units" in n or "Up axis" in n for n in avatar.notes)


def test_a_real_body_in_centimetres_z_up_with_a_hole(data_dir: Path, tmp_path: Path) -> None:
    body = trimesh.load_mesh(data_dir / "bodies" / "mh_f_average.ply", process=False)
    vertices = np.asarray(body.vertices)[:, [0, 2, 1]] * (100.0, -100.0, 100.0)
    faces = np.asarray(body.faces)
    vertex = int(np.argmin(np.linalg.norm(np.asarray(body.vertices) - (0.0, 1.0, 0.1), axis=1)))
    path = write(tmp_path / "blender.stl", vertices, faces[(faces != vertex).all(axis=1)])
    avatar = load_avatar(path)
    assert avatar.up_axis == "z"
    assert avatar.metres_per_unit == 0.01
    assert_closed_and_outward(avatar.vertices, avatar.faces)
    assert len(avatar.vertices) == len(vertices) - 1
    assert any(note.startswith("1 hole of") for note in avatar.notes)


@pytest.mark.slow
@pytest.mark.parametrize("name", ALL_BODIES)
def test_every_real_body_loads(data_dir: Path, name: str) -> None:
    _assert_body(load_avatar(data_dir / "bodies" / name))


def test_holes_that_touch_in_a_vertex_are_loops_of_their_own() -> None:
    """A surface whose sides are split otherwise ended in a KeyError."""
    for faces, loops in (
        ([[0, 1, 2], [0, 3, 4]], [[0, 4, 3], [0, 2, 1]]),
        ([[0, 1, 2], [0, 1, 3], [0, 1, 4], [1, 0, 5]], [[0, 4, 1, 5], [0, 3, 1], [0, 2, 1]]),
    ):
        found = boundary_loops(np.array(faces, np.int32))
        assert sorted(map(np.ndarray.tolist, found)) == sorted(loops)
