"""Sewing pattern to garment mesh: placement, sides of the fabric, seams, rest shapes."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.dressing.garment.pattern_mesh import corner_angles, mesh_pattern
from toile.dressing.pattern.garmentcode import read_garmentcode
from toile.dressing.pattern.pattern import Edge, Panel, Pattern, Quadratic, Stitch
from toile.geometry.arrays import Float, Int
from toile.geometry.errors import InputError


def loop(*vertices: tuple[float, float], name: str = "p", labels: dict[int, str] | None = None) -> Panel:
    count = len(vertices)
    edges = tuple(Edge(i, (i + 1) % count, None, (labels or {}).get(i, "")) for i in range(count))
    return Panel(name=name, vertices=vertices, edges=edges)


def front_and_back(*, right_wrong: bool = False, back_height: float = 0.3) -> Pattern:
    """A front (counter-clockwise) and a back (clockwise) of 20 cm width, sewn along x = 0.2."""
    front = replace(
        loop((0, 0), (0.2, 0), (0.2, 0.3), (0, 0.3), name="front", labels={2: "neck"}),
        translation=(0.0, 1.0, 0.2),
    )
    back = replace(
        loop((0, 0), (0, back_height), (0.2, back_height), (0.2, 0), name="back", labels={1: "neck"}),
        translation=(0.0, 1.0, -0.2),
    )
    stitches = (Stitch("front", 1, "back", 2, right_wrong),)
    return Pattern(name="tabard", panels=(front, back), stitches=stitches)


def areas(mesh: GarmentMesh) -> Float:
    """Signed rest area of each face [m^2]."""
    a, b, c = mesh.rest_corners.transpose(1, 0, 2)
    ab, ac = b - a, c - a
    return np.asarray(0.5 * (ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0]))


def test_sides_placement_and_rest_shape() -> None:
    mesh = mesh_pattern(front_and_back(), edge_length=0.02)
    corners = mesh.positions[mesh.faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (normal[mesh.panel == 0, 2] > 0.0).all()
    assert (normal[mesh.panel == 1, 2] < 0.0).all()
    area = areas(mesh)
    assert area.min() > 0.0
    assert area.sum() == pytest.approx(0.12)
    assert mesh.positions[:, :2] == pytest.approx(mesh.uv + np.array([0.0, 1.0]))
    assert set(mesh.positions[:, 2].round(12)) == {0.2, -0.2}
    assert mesh.panel_names == ("front", "back")
    assert mesh.flat
    assert mesh.minimum_angle == pytest.approx(np.degrees(corner_angles(mesh.rest_corners)).min())
    assert mesh.minimum_angle > 30.0
    # The rest shape is the placed shape: same edge lengths, warp = world y here.
    assert mesh.rest_corners[..., 0] == pytest.approx(corners[..., 1] - 1.0)


def test_weft_runs_left_seen_from_the_right_side() -> None:
    mesh = mesh_pattern(front_and_back(), edge_length=0.05)
    x = mesh.positions[mesh.faces][..., 0]
    front = mesh.panel == 0
    assert mesh.rest_corners[front, :, 1] == pytest.approx(-x[front])
    assert mesh.rest_corners[~front, :, 1] == pytest.approx(x[~front])


@pytest.mark.parametrize("degrees", [30.0, 90.0, -45.0])
def test_warp_angle(degrees: float) -> None:
    """The warp coordinate grows along a direction so far counter-clockwise of the drawing's +y."""
    pattern = front_and_back()
    pattern = replace(pattern, panels=tuple(replace(p, warp_degrees=degrees) for p in pattern.panels))
    mesh = mesh_pattern(pattern, edge_length=0.05)
    angle = np.radians(degrees)
    warp = np.array([-np.sin(angle), np.cos(angle)])
    assert mesh.rest_corners[..., 0] == pytest.approx(mesh.uv[mesh.faces] @ warp)
    assert areas(mesh).min() > 0.0


@pytest.mark.parametrize("right_wrong", [False, True])
def test_stitch_direction(right_wrong: bool) -> None:
    mesh = mesh_pattern(front_and_back(right_wrong=right_wrong), edge_length=0.02)
    assert len(mesh.stitches) == 16
    a, b = mesh.uv[mesh.stitches[:, 0]], mesh.uv[mesh.stitches[:, 1]]
    assert (a[:, 0] == 0.2).all() and (b[:, 0] == 0.2).all()
    assert b[:, 1] == pytest.approx(0.3 - a[:, 1] if right_wrong else a[:, 1])
    assert set(mesh.panel[np.isin(mesh.faces, mesh.stitches[:, 0]).any(axis=1)]) == {0}
    assert (mesh.seam == 0).all()
    assert mesh.seam_names == ("front.1 - back.2",)


def test_gathers_take_the_count_of_the_longer_edge() -> None:
    mesh = mesh_pattern(front_and_back(back_height=0.6), edge_length=0.02)
    assert len(mesh.stitches) == 31
    a, b = mesh.uv[mesh.stitches[:, 0], 1], mesh.uv[mesh.stitches[:, 1], 1]
    assert b == pytest.approx(2.0 * a)
    assert mesh.minimum_angle > 25.0


def test_held_vertices() -> None:
    mesh = mesh_pattern(front_and_back(), edge_length=0.02)
    assert list(mesh.held) == ["neck"]
    held = mesh.held["neck"]
    assert held.dtype == np.int32
    assert np.array_equal(held, np.flatnonzero(mesh.uv[:, 1] == 0.3))


def test_roles_of_panels_and_edges() -> None:
    plain = front_and_back()
    front = plain.panels[0]
    edges = tuple(replace(edge, role="collar" if edge.label else None) for edge in front.edges)
    pattern = replace(plain, panels=(replace(front, role="torso", edges=edges), *plain.panels[1:]))
    mesh = mesh_pattern(pattern, edge_length=0.02)
    assert mesh.panel_roles == ("torso", *[None] * (len(plain.panels) - 1))
    assert list(mesh.edges) == ["collar"]
    on_front = np.unique(mesh.faces[mesh.panel == 0])
    assert np.array_equal(mesh.edges["collar"], np.intersect1d(mesh.held["neck"], on_front))


def test_dart_leaves_out_its_tip() -> None:
    panel = loop((0, 0), (0.09, 0), (0.1, 0.1), (0.11, 0), (0.2, 0), (0.2, 0.2), (0, 0.2))
    pattern = Pattern(name="dart", panels=(panel,), stitches=(Stitch("p", 1, "p", 2),))
    mesh = mesh_pattern(pattern, edge_length=0.01)
    a, b = mesh.uv[mesh.stitches[:, 0]], mesh.uv[mesh.stitches[:, 1]]
    assert len(mesh.stitches) == 11
    assert b == pytest.approx(a * [-1.0, 1.0] + [0.2, 0.0])
    assert not (a == [0.1, 0.1]).all(axis=1).any()
    assert (mesh.stitches[:, 0] != mesh.stitches[:, 1]).all()


def test_corner_pairs_are_made_once() -> None:
    """Two neighbouring edges sewn to two neighbouring edges share the pair at their common corner."""
    front = loop((0, 0), (0.2, 0), (0.2, 0.1), (0.2, 0.2), (0, 0.2), name="front")
    back = loop((0, 0), (0, 0.2), (0.2, 0.2), (0.2, 0.1), (0.2, 0), name="back")
    stitches = (Stitch("front", 1, "back", 3), Stitch("front", 2, "back", 2))
    mesh = mesh_pattern(Pattern(name="two", panels=(front, back), stitches=stitches), edge_length=0.02)
    assert np.bincount(mesh.seam).tolist() == [6, 5]
    assert len(np.unique(np.sort(mesh.stitches, axis=1), axis=0)) == 11


def test_negligible_edges_shrink_to_a_vertex() -> None:
    front = loop((0, 0), (0.2, 0), (0.2, 0.001), (0.2, 0.2), (0, 0.2), name="front")
    back = loop((0, 0), (0, 0.2), (0.2, 0.2), (0.2, 0.001), (0.2, 0), name="back")
    stitches = (Stitch("front", 1, "back", 3), Stitch("front", 2, "back", 2))
    pattern = Pattern(name="tiny", panels=(front, back), stitches=stitches)
    mesh = mesh_pattern(pattern, edge_length=0.02)
    assert np.bincount(mesh.seam).tolist() == [1, 10]
    assert mesh.minimum_angle > 30.0
    fine = mesh_pattern(pattern, edge_length=0.004)
    assert np.bincount(fine.seam).tolist() == [2, 50]
    # Never so many that no panel is left.
    small = Pattern(name="small", panels=(loop((0, 0), (0.01, 0), (0.01, 0.01)),), stitches=())
    assert len(mesh_pattern(small, edge_length=1.0).faces) == 1


def test_bad_input() -> None:
    with pytest.raises(InputError, match="edge_length"):
        mesh_pattern(front_and_back(), edge_length=0.0)
    deep = loop((0, 0), (0.2, 0), (0.2, 0.2), (0.1, 0.05))
    # The bulge of edge 0 runs over the corner between edges 2 and 3.
    edges = (replace(deep.edges[0], curve=Quadratic((0.5, 0.9))), *deep.edges[1:])
    crossing = Pattern(name="x", panels=(replace(deep, edges=edges),), stitches=())
    with pytest.raises(InputError, match="panel 'p' crosses itself at edges 0 and 2"):
        mesh_pattern(crossing, edge_length=0.02)


def test_same_input_same_bytes() -> None:
    one, two = (mesh_pattern(front_and_back(), edge_length=0.02) for _ in range(2))
    for name in ("positions", "uv", "faces", "rest_corners", "stitches"):
        assert getattr(one, name).tobytes() == getattr(two, name).tobytes()


def sewn_nodes(mesh: GarmentMesh) -> Int:
    """Node of every vertex once all stitches are closed."""
    count = len(mesh.positions)
    links = coo_matrix((np.ones(len(mesh.stitches)), mesh.stitches.T), (count, count))
    return np.asarray(connected_components(links)[1])


def edge_uses(faces: Int) -> Int:
    """Triangles per edge, one entry for every edge."""
    edges = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    return np.asarray(np.unique(edges, axis=0, return_counts=True)[1])


def border_edge_count(faces: Int) -> int:
    return int((edge_uses(faces) == 1).sum())


def test_every_real_pattern_becomes_a_garment(data_dir: Path) -> None:
    paths = [
        *sorted(data_dir.glob("patterns/*_specification.json")),
        *sorted(data_dir.glob("reference/*_spec*.json")),
    ]
    smallest = []
    for path in paths:
        pattern = read_garmentcode(path)
        mesh = mesh_pattern(pattern, edge_length=0.03)
        assert areas(mesh).min() > 0.0
        assert np.isfinite(mesh.positions).all()
        smallest.append(np.degrees(corner_angles(mesh.rest_corners)).min(axis=1))
        # Outwards: fronts look to +z, backs to -z.
        corners = mesh.positions[mesh.faces]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        for panel in range(len(mesh.panel_names)):
            own = mesh.panel == panel
            z = corners[own, :, 2].mean()
            assert normal[own, 2].sum() * z > -0.2 * abs(z) * np.linalg.norm(normal[own].sum(axis=0))
        # Sewn up, no triangle has collapsed, none coincide and no edge has three.
        faces = sewn_nodes(mesh)[mesh.faces]
        assert (faces != np.roll(faces, 1, axis=1)).all()
        assert len(np.unique(np.sort(faces, axis=1), axis=0)) == len(faces)
        assert edge_uses(faces).max() == 2
    angle = np.concatenate(smallest)
    assert np.percentile(angle, 1) > 34.0
    assert np.median(angle) > 53.0
    # What is left below 20 degrees sits in pattern corners that are that sharp.
    assert (angle < 20.0).sum() < 5e-4 * len(angle)


@pytest.mark.parametrize("name", ["fitted_top_darts__mean_female", "gathered_skirt__mean_all",
                                  "lapel_shirt__mean_male", "tshirt__mean_all"])  # fmt: skip
def test_against_garmentcodes_own_mesh(name: str, data_dir: Path) -> None:
    """Twin: GarmentCode's mesher at 1 cm, which merges the seams that ours leaves open."""
    folder = data_dir / "patterns"
    if not (folder / "boxmesh_reference").is_dir():
        pytest.skip("no reference meshes beside the patterns")
    theirs = np.load(folder / "boxmesh_reference" / f"{name}_boxmesh.npz")
    mesh = mesh_pattern(read_garmentcode(folder / f"{name}_specification.json"), edge_length=0.01)
    uv, corners = theirs["uv_cm"].astype(float) / 100.0, theirs["face_uv"]
    ab, ac = uv[corners[:, 1]] - uv[corners[:, 0]], uv[corners[:, 2]] - uv[corners[:, 0]]
    their_area = 0.5 * np.abs(ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0]).sum()
    assert areas(mesh).sum() == pytest.approx(their_area, rel=1e-5)
    assert len(mesh.positions) == pytest.approx(len(uv), rel=0.08)
    assert len(mesh.faces) == pytest.approx(len(theirs["faces"]), rel=0.08)
    # Sewn up, both have as many border edges: same segments, same seams.
    ours = border_edge_count(sewn_nodes(mesh)[mesh.faces])
    assert ours == border_edge_count(theirs["faces"])
