"""Adaptive remeshing: sizes as asked, rest shape exact, seams whole, nothing done twice."""

from collections.abc import Callable
from dataclasses import fields, replace

import numpy as np
import pytest

from tests.remesh.cloth_samples import (
    check_surface,
    cloth,
    dart,
    euler_characteristic,
    grid_faces,
    grid_points,
    own_frames,
    panel_areas,
    random_delaunay,
    ridge,
    right_grid,
    sewn_panels,
    sphere_cap,
    uniform,
    with_pins,
)
from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.topology import triangle_topology
from toile.remesh.adapt.acceptance import Proposals
from toile.remesh.adapt.adapt import AdaptResult, adapt
from toile.remesh.adapt.mesh_in_work import MeshInWork
from toile.remesh.adapt.split import split_round
from toile.remesh.mesh.cloth_mesh import ClothMesh
from toile.remesh.sizing.edge_size import metric_aspects
from toile.remesh.sizing.packed_tensor import packed

STARTS: dict[str, Callable[[], ClothMesh]] = {
    "grid": lambda: right_grid(12),
    "random": lambda: random_delaunay(12),
    "panels": lambda: sewn_panels(6),
    "cap": lambda: sphere_cap(8),
    "dart": lambda: dart(6),
}


def longest_edge(result: AdaptResult, tensors: Float) -> float:
    """Longest edge in the metric, over all sides of all faces."""
    mesh, carried = result.mesh, result.transfer.at_vertices(tensors)
    longest = 0.0
    for k in range(3):
        p, q = mesh.faces[:, k], mesh.faces[:, k - 1]
        along = mesh.rest[q] - mesh.rest[p]
        mean = 0.5 * (carried[p] + carried[q])
        longest = max(longest, float(np.einsum("ei,eij,ej->e", along, mean, along).max()))
    return float(np.sqrt(longest))


@pytest.mark.parametrize("start", STARTS)
@pytest.mark.parametrize("size", [0.03, 0.3])
def test_result_is_a_surface_with_the_same_panels(start: str, size: float) -> None:
    mesh = STARTS[start]()
    tensors = uniform(mesh, size)
    result = adapt(mesh, tensors)
    check_surface(result.mesh)
    assert euler_characteristic(result.mesh) == euler_characteristic(mesh)
    assert np.abs(panel_areas(result.mesh) / panel_areas(mesh) - 1.0).max() < 1e-12
    if size == 0.03:
        assert result.splits > 0
        assert longest_edge(result, tensors) <= 1.0


@pytest.mark.parametrize("start", STARTS)
def test_rest_coordinates_and_positions_follow_the_transfer(start: str) -> None:
    mesh = STARTS[start]()
    result = adapt(mesh, ridge(mesh, finest=0.02, coarsest=0.2))
    transfer = result.transfer
    assert np.abs(transfer.at_vertices(mesh.rest) - result.mesh.rest).max() < 1e-15 * 8
    assert np.abs(transfer.at_nodes(mesh.positions) - result.mesh.positions).max() < 1e-15 * 8
    assert np.array_equal(result.mesh.region, mesh.region[transfer.faces])
    assert np.array_equal(result.mesh.frames, mesh.frames[transfer.faces])
    for weights in (transfer.nodes, transfer.vertices):
        assert np.abs(weights.sum(axis=1) - 1.0).max() < 1e-14


@pytest.mark.parametrize("start", ["grid", "random"])
def test_graded_anisotropic_field_gives_well_shaped_triangles(start: str) -> None:
    mesh = right_grid(24) if start == "grid" else random_delaunay(24)
    tensors = ridge(mesh)
    for _ in range(3):
        result = adapt(mesh, tensors)
        mesh, tensors = result.mesh, ridge(result.mesh)
    aspect = metric_aspects(mesh.faces, mesh.rest, packed(tensors))
    assert np.quantile(aspect, 0.001) > 0.2
    assert np.mean(aspect) > 0.75
    assert abs(mesh.rest_area.sum() - 1.0) < 1e-12


@pytest.mark.parametrize("start", STARTS)
def test_same_field_again_changes_nothing(start: str) -> None:
    mesh = STARTS[start]()
    tensors = ridge(mesh, finest=0.02, coarsest=0.2)
    first = adapt(mesh, tensors)
    again = adapt(first.mesh, first.transfer.at_vertices(tensors))
    assert (again.splits, again.flips, again.collapses) == (0, 0, 0)
    assert same(again.mesh, first.mesh)
    assert np.array_equal(again.transfer.nodes.toarray(), np.eye(len(first.mesh.positions)))


@pytest.mark.parametrize("start", STARTS)
def test_field_known_everywhere_comes_to_rest(start: str) -> None:
    mesh = STARTS[start]()
    changes = []
    for _ in range(6):
        result = adapt(mesh, ridge(mesh, finest=0.02, coarsest=0.2))
        mesh = result.mesh
        changes.append(result.splits + result.collapses + result.flips)
    assert changes[-1] == 0, changes


def same(a: ClothMesh, b: ClothMesh) -> bool:
    return all(getattr(a, entry.name).tobytes() == getattr(b, entry.name).tobytes() for entry in fields(a))


@pytest.mark.parametrize("start", STARTS)
def test_flattened_cloth_gets_its_large_triangles_back(start: str) -> None:
    mesh = STARTS[start]()
    fine = adapt(mesh, uniform(mesh, 0.02)).mesh
    coarse = adapt(fine, uniform(fine, 0.4)).mesh
    check_surface(coarse)
    assert len(fine.faces) > 8 * len(mesh.faces)
    assert len(coarse.faces) <= 1.3 * len(mesh.faces)
    assert np.abs(panel_areas(coarse) / panel_areas(mesh) - 1.0).max() < 1e-12


def test_two_runs_give_the_same_bytes() -> None:
    mesh = sewn_panels(6)
    tensors = ridge(mesh, finest=0.02, coarsest=0.2)
    one, two = adapt(mesh, tensors), adapt(mesh, tensors)
    assert same(one.mesh, two.mesh)
    assert one.transfer.nodes.data.tobytes() == two.transfer.nodes.data.tobytes()


@pytest.mark.parametrize("start", STARTS)
def test_numbering_does_not_matter_to_what_comes_out(start: str) -> None:
    mesh = STARTS[start]()
    order = np.random.default_rng(3).permutation(len(mesh.faces))
    shuffled = replace(
        mesh,
        faces=np.roll(mesh.faces[order], 1, axis=1),
        frames=mesh.frames[order],
        region=mesh.region[order],
    )
    counts = []
    for start_mesh in (mesh, shuffled):
        tensors = ridge(start_mesh, finest=0.02, coarsest=0.2)
        result = adapt(start_mesh, tensors)
        check_surface(result.mesh)
        assert longest_edge(result, tensors) <= 1.0
        assert np.abs(panel_areas(result.mesh) / panel_areas(mesh) - 1.0).max() < 1e-12
        counts.append(len(result.mesh.faces))
    assert abs(counts[0] / counts[1] - 1.0) < 0.1


@pytest.mark.parametrize("size", [0.02, 0.4])
def test_seams_stay_sewn_node_for_node(size: float) -> None:
    mesh = sewn_panels(5, blocks=3)
    result = adapt(mesh, uniform(mesh, size)).mesh
    topology = triangle_topology(result.face_nodes)
    # Only the outline has edges with one face: a split on one side of a seam alone would add others.
    ends = result.positions[topology.border_edges][..., [0, 2]]
    on_outline = [
        (np.abs(ends[..., axis] - value) < 1e-12).all(axis=1) for axis in (0, 1) for value in (0, 1)
    ]
    assert np.any(on_outline, axis=0).all()
    panels_at_corner = np.bincount(result.node)
    assert (panels_at_corner == 4).sum() == 4
    face, side = np.nonzero(topology.neighbours >= 0)
    across = topology.neighbours[face, side]
    sewn = result.region[face] != result.region[across]
    assert sewn.sum() >= 2 * 12
    inside = result.faces[face[~sewn], (side[~sewn] + 1) % 3]
    other = result.faces[across[~sewn], (topology.neighbour_sides[face, side][~sewn] + 2) % 3]
    assert np.array_equal(inside, other)


def test_two_fabrics_in_one_piece_keep_their_areas_and_share_vertices() -> None:
    flat = right_grid(12)
    mesh = replace(flat, region=(flat.rest[flat.faces].mean(axis=1)[:, 0] > 0.5).astype(np.int32))
    for size in (0.03, 0.3):
        result = adapt(mesh, uniform(mesh, size)).mesh
        check_surface(result)
        assert len(result.rest) == len(result.positions)
        assert np.abs(panel_areas(result) - 0.5).max() < 1e-12


def test_kept_and_pinned_nodes_stay_and_pinned_lines_stay_pinned() -> None:
    flat = right_grid(12)
    top = np.flatnonzero(flat.rest[:, 1] == 1.0)
    mesh = with_pins(replace(flat, positions=flat.rest), pinned=top.tolist(), kept=[80, 81])
    fine = adapt(mesh, uniform(mesh, 0.02))
    on_top = fine.mesh.rest[:, 1] == 1.0
    assert on_top.sum() > len(top)
    assert np.array_equal(fine.mesh.pinned[fine.mesh.node], on_top)
    assert np.array_equal(fine.transfer.marked_nodes(mesh.pinned), fine.mesh.pinned)
    coarse = adapt(fine.mesh, uniform(fine.mesh, 0.3))
    assert coarse.mesh.kept.sum() == 2
    assert np.array_equal(coarse.mesh.rest[coarse.mesh.kept], mesh.rest[[80, 81]])
    on_top = coarse.mesh.rest[:, 1] == 1.0
    assert 4 <= on_top.sum() <= 10
    assert np.array_equal(coarse.mesh.pinned[coarse.mesh.node], on_top)


def test_pinned_nodes_off_a_straight_line_are_never_removed() -> None:
    flat = right_grid(12)
    top = np.flatnonzero(flat.rest[:, 1] == 1.0)
    mesh = with_pins(flat, pinned=[*top.tolist(), 50], kept=[])
    result = adapt(mesh, uniform(mesh, 0.5))
    assert result.collapses > 0
    assert (result.transfer.node_indices(np.append(top, 50)) >= 0).all()


def test_frozen_edges_stay() -> None:
    flat = right_grid(8)
    chain = np.flatnonzero(flat.rest[:, 0] == 0.0).astype(np.int32)
    frozen = np.stack([chain[:-1], chain[1:]], axis=1)
    mesh = replace(flat, frozen_edges=frozen)
    for size in (0.03, 1.0):
        result = adapt(mesh, uniform(mesh, size))
        assert np.array_equal(result.mesh.frozen_edges, result.transfer.node_indices(frozen))
        edges = {tuple(edge) for edge in triangle_topology(result.mesh.face_nodes).edges.tolist()}
        assert {tuple(sorted(edge)) for edge in result.mesh.frozen_edges.tolist()} <= edges


def test_refused_flips_and_collapses_leave_only_splits() -> None:
    def refuse(positions: Float, proposals: Proposals) -> Bool:
        return np.zeros(proposals.proposal_count, bool)

    mesh = random_delaunay(10)
    tensors = ridge(mesh, finest=0.03, coarsest=0.3)
    result = adapt(mesh, tensors, refuse)
    assert result.splits > 0
    assert (result.flips, result.collapses) == (0, 0)
    assert len(result.mesh.positions) == len(mesh.positions) + result.splits


def test_proposals_describe_the_change_and_are_not_repeated() -> None:
    mesh = random_delaunay(10)
    seen: set[tuple[tuple[int, ...], ...]] = set()

    def every_other(positions: Float, proposals: Proposals) -> Bool:
        nodes = proposals.face_nodes
        assert len(np.unique(proposals.removed)) == len(proposals.removed)
        accepted = np.arange(proposals.proposal_count) % 2 == 0
        for p in range(proposals.proposal_count):
            new = proposals.triangles[proposals.owner == p]
            old = nodes[proposals.removed[proposals.removed_owner == p]]
            assert 1 <= len(new) <= len(old)
            assert set(new.ravel()) <= set(old.ravel())
            assert new.max() < len(positions)
            # The closed line around the patch is the same before and after.
            assert outline(new) == outline(old) or len(set(new.ravel())) < len(set(old.ravel()))
            if not accepted[p]:
                patch = tuple(sorted(map(tuple, new.tolist())))
                assert patch not in seen
                seen.add(patch)
        return np.asarray(accepted)

    result = adapt(mesh, uniform(mesh, 0.3), every_other)
    check_surface(result.mesh)
    assert result.collapses > 0 and len(seen) > 0


@pytest.mark.parametrize("start", STARTS)
@pytest.mark.parametrize("seed", range(4))
def test_rough_fields_and_random_refusals_leave_a_surface(start: str, seed: int) -> None:
    random = np.random.default_rng(seed)

    def moody(positions: Float, proposals: Proposals) -> Bool:
        return np.asarray(random.random(proposals.proposal_count) < 0.7)

    mesh = STARTS[start]()
    for _ in range(3):
        factors = random.normal(size=(len(mesh.rest), 3, 3)) * 10.0
        tensors = factors @ factors.transpose(0, 2, 1) + np.eye(3)
        result = adapt(mesh, tensors, moody)
        check_surface(result.mesh)
        assert euler_characteristic(result.mesh) == euler_characteristic(mesh)
        assert np.abs(panel_areas(result.mesh) / panel_areas(mesh) - 1.0).max() < 1e-12
        assert longest_edge(result, tensors) <= 1.0
        mesh = result.mesh


def outline(triangles: Int) -> set[tuple[int, int]]:
    """Directed sides without a reverse."""
    sides = {(int(t[k]), int(t[(k + 1) % 3])) for t in triangles for k in range(3)}
    return {side for side in sides if side[::-1] not in sides}


def test_one_triangle_splits_at_its_longest_edge() -> None:
    mesh = cloth(np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]]))
    result = adapt(mesh, uniform(mesh, 1.2))
    assert result.splits == 1
    assert np.array_equal(result.mesh.rest[3], [0.5, 0.5, 0.0])
    assert result.transfer.faces.tolist() == [0, 0]
    check_surface(result.mesh)


def test_one_triangle_never_vanishes() -> None:
    mesh = cloth(np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]]))
    assert same(adapt(mesh, uniform(mesh, 100.0)).mesh, mesh)


def test_two_triangles_flip_to_the_shorter_diagonal_in_the_metric() -> None:
    rest = np.array([[0.0, 0, 0], [1, 0, 0], [1.4, 1, 0], [0.4, 1, 0]])
    mesh = cloth(rest, np.array([[0, 1, 2], [0, 2, 3]]))
    result = adapt(mesh, uniform(mesh, 2.0))
    assert (result.flips, result.splits, result.collapses) == (1, 0, 0)
    assert {frozenset(face) for face in result.mesh.faces.tolist()} == {
        frozenset({0, 1, 3}),
        frozenset({1, 2, 3}),
    }
    sheared = np.zeros((4, 3, 3))
    sheared[:, :2, :2] = np.array([[1.0, 0.9], [0.9, 1.0]]) / 16
    assert adapt(mesh, sheared).flips == 1
    sheared[:, 0, 1] = sheared[:, 1, 0] = -0.9 / 16
    assert adapt(mesh, sheared).flips == 0


def test_closed_surface_of_few_faces_survives() -> None:
    """An octahedron may lose no more nodes than a closed surface can."""
    rest = np.array([[1.0, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [0, -1, 0], [0, 0, -1]])
    faces = np.array(
        [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]], np.int32
    )
    mesh = cloth(rest, faces, frames=own_frames(rest, faces))
    fine = adapt(mesh, uniform(mesh, 0.2)).mesh
    coarse = adapt(fine, uniform(fine, 50.0)).mesh
    check_surface(coarse)
    assert len(fine.faces) > 100
    assert len(coarse.faces) == 8
    assert euler_characteristic(coarse) == 2


def test_edges_of_three_faces_stay() -> None:
    rest = np.concatenate([grid_points(4, 4), [[0.5, 0.5, 0.0]]])
    faces = np.concatenate([grid_faces(4, 4), [[0, 6, 25]]]).astype(np.int32)
    mesh = cloth(rest, faces)
    topology = triangle_topology(mesh.face_nodes)
    assert topology.edge_face_count.max() == 3
    for size in (0.05, 1.0):
        result = adapt(mesh, uniform(mesh, size))
        counts = triangle_topology(result.mesh.face_nodes).edge_face_count
        assert (counts == 3).sum() == 1 and counts.max() == 3


def test_splits_beside_an_edge_of_three_faces_end_however_long_its_other_sides_are() -> None:
    """Three gathered panels on one seam: the edge that stays is as long as the longest of its sides."""
    lengths = np.array([0.5, 0.5, 3.0])
    rest = np.zeros((9, 3))
    rest[1::3, 0], rest[2::3, 0], rest[2::3, 1] = lengths, 0.5 * lengths, lengths
    node = np.array([0, 1, 2, 0, 1, 3, 0, 1, 4], np.int32)
    mesh = cloth(rest, np.arange(9, dtype=np.int32).reshape(3, 3), node=node, positions=rest[[0, 1, 2, 5, 8]])
    work, rounds = MeshInWork.start(mesh, uniform(mesh, 0.7)), 0
    while split_round(work)[0]:
        rounds += 1
        assert rounds < 20
    assert np.abs(work.finish(mesh)[0].rest_area.sum() - mesh.rest_area.sum()) < 1e-12
    assert adapt(mesh, uniform(mesh, 0.7)).splits > 0


def test_wrong_shape_of_tensors_is_named() -> None:
    mesh = right_grid(2)
    with pytest.raises(ValueError, match=r"tensors must have shape \(9, 3, 3\), got \(9, 2, 2\)"):
        adapt(mesh, np.zeros((9, 2, 2)))
