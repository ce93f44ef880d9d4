"""What adapting may never change, counted and measured without the code under test."""

from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import connected_components

from toile.geometry.arrays import Bool, Float, Int
from toile.remesh.adapt.adapt import AdaptResult
from toile.remesh.adapt.momentum import Motion, with_momentum_of
from toile.remesh.mesh.cloth_mesh import ClothMesh


class Sides(NamedTuple):
    """Edges between nodes, in order, and all sides of faces, face by face.

    Attributes
    ----------
    edges
        Lower and higher node, shape (e, 2).
    counts
        Sides per edge, shape (e,).
    edge
        Edge of every side, shape (3t,).
    forward
        True for sides that run from the lower to the higher node, shape (3t,).
    ends
        Material vertices of every side, at the lower and at the higher node, shape (3t, 2).
    """

    edges: Int
    counts: Int
    edge: Int
    forward: Bool
    ends: Int


def sides_of(mesh: ClothMesh) -> Sides:
    ends = np.stack([mesh.faces, mesh.faces[:, [1, 2, 0]]], axis=2).reshape(-1, 2)
    nodes = mesh.node[ends]
    forward = nodes[:, 0] <= nodes[:, 1]
    ends = np.where(forward[:, None], ends, ends[:, ::-1])
    edges, edge, counts = np.unique(mesh.node[ends], axis=0, return_inverse=True, return_counts=True)
    return Sides(edges, counts.astype(np.int32), edge.ravel().astype(np.int32), forward, ends)


def check_surface(mesh: ClothMesh) -> None:
    """A consistently oriented surface of proper faces, in which every side has a partner or is a border."""
    nodes, sides = mesh.face_nodes, sides_of(mesh)
    assert (nodes != nodes[:, [1, 2, 0]]).all()
    assert len(np.unique(np.sort(nodes, axis=1), axis=0)) == len(nodes)
    assert sides.counts.max() <= 2
    assert len(np.unique(2 * sides.edge + sides.forward)) == len(sides.edge)
    check_arrays(mesh)


def check_arrays(mesh: ClothMesh) -> None:
    """All rows are in use, of the right type and finite, and no face is inverted."""
    assert mesh.rest_area.min() > 0.0
    assert np.array_equal(np.unique(mesh.node), np.arange(len(mesh.positions)))
    assert np.array_equal(np.unique(mesh.faces), np.arange(len(mesh.rest)))
    assert np.isfinite(mesh.rest).all() and np.isfinite(mesh.positions).all()
    for whole in (mesh.node, mesh.faces, mesh.region, mesh.frozen_edges):
        assert whole.dtype == np.int32 and whole.flags.c_contiguous
    for real in (mesh.rest, mesh.frames, mesh.positions):
        assert real.dtype == np.float64 and real.flags.c_contiguous


def check_change(before: ClothMesh, result: AdaptResult) -> None:
    """Whatever the mesh was, its shape, its lines, its marks and its data are what they were."""
    after, transfer = result.mesh, result.transfer
    assert len(after.positions) == len(before.positions) + result.splits - result.collapses
    check_transfer(before, result)
    old, new = sides_of(before), sides_of(after)
    patch = coplanar_patches(before, old)
    same_sums(patch, before.rest_area, patch[transfer.faces], after.rest_area)
    same_sums(before.region, before.rest_area, after.region, after.rest_area)
    assert abs(after.rest_area.sum() / before.rest_area.sum() - 1.0) < 1e-12
    check_lines(before, old, patch, after, new, patch[transfer.faces])
    assert topology(before, old) == topology(after, new)
    check_marks(before, old, result, new)
    mass, new_mass = lumped_mass(before), lumped_mass(after)
    assert abs(new_mass.sum() / mass.sum() - 1.0) < 1e-12


def check_transfer(before: ClothMesh, result: AdaptResult) -> None:
    """Nodes and material vertices are averages of old ones, each side of a seam of its own."""
    after, transfer = result.mesh, result.transfer
    scale = np.abs(before.rest).max() + np.abs(before.positions).max()
    assert np.abs(transfer.at_vertices(before.rest) - after.rest).max() < 1e-13 * scale
    assert np.abs(transfer.at_nodes(before.positions) - after.positions).max() < 1e-13 * scale
    assert np.array_equal(after.region, before.region[transfer.faces])
    assert np.array_equal(after.frames, before.frames[transfer.faces])
    for weights in (transfer.nodes, transfer.vertices):
        assert weights.data.min() >= 0.0
        assert np.abs(weights.sum(axis=1) - 1.0).max() < 1e-14
    node_of = csr_array((np.ones(len(before.node)), (np.arange(len(before.node)), before.node)))
    apart = transfer.vertices @ node_of - csr_array(transfer.nodes[after.node])
    assert not np.abs(apart.data).any()
    alive = transfer.new_node >= 0
    assert np.array_equal(transfer.new_node[alive], np.arange(alive.sum()))
    assert np.array_equal(after.positions[transfer.new_node[alive]], before.positions[alive])


def check_lines(
    before: ClothMesh, old: Sides, patch: Int, after: ClothMesh, new: Sides, new_patch: Int
) -> None:
    """Borders, seams and creases are as long as before on each side: no side has lost its partner."""
    for first, second in zip(line_sides(before, old, patch), line_sides(after, new, new_patch), strict=True):
        length, new_length = side_lengths(before, old), side_lengths(after, new)
        same_sums(
            np.repeat(patch, 3)[first], length[first], np.repeat(new_patch, 3)[second], new_length[second]
        )


def line_sides(mesh: ClothMesh, sides: Sides, patch: Int) -> tuple[Bool, Bool, Bool, Bool]:
    """Sides on borders, seams, creases between patches and tangles, shape (3t,) each."""
    count = sides.counts[sides.edge]
    knot = sides.edges[sides.edge, 0] == sides.edges[sides.edge, 1]
    other, partner = partners(sides)
    seam, crease = np.zeros((2, len(sides.edge)), bool)
    seam[other] = (sides.ends[other] != sides.ends[partner]).any(axis=1)
    seam[other] |= mesh.region[other // 3] != mesh.region[partner // 3]
    crease[other] = ~seam[other] & (patch[other // 3] != patch[partner // 3])
    return (count == 1) & ~knot, seam, crease, (count > 2) | knot


def partners(sides: Sides) -> tuple[Int, Int]:
    """Pairs of sides of edges that have two, both ways round."""
    order = np.argsort(sides.edge, kind="stable")
    start = np.cumsum(sides.counts) - sides.counts
    start = start[(sides.counts == 2) & (sides.edges[:, 0] != sides.edges[:, 1])]
    one, two = order[start], order[start + 1]
    return np.concatenate([one, two]), np.concatenate([two, one])


def coplanar_patches(mesh: ClothMesh, sides: Sides) -> Int:
    """Number of the flat piece of rest space that every face lies in, shape (t,)."""
    one, two = partners(sides)
    t, u = one // 3, two // 3
    inner = (sides.ends[one] == sides.ends[two]).all(axis=1) & (mesh.region[t] == mesh.region[u])
    normal = np.cross(mesh.frames[..., 0], mesh.frames[..., 1])
    flat = np.linalg.norm(np.cross(normal[t], normal[u]), axis=1) < 1e-7
    flat &= np.einsum("ki,ki->k", normal[t], normal[u]) > 0.0
    joined = inner & flat
    return components(t[joined], u[joined], len(mesh.faces))


def components(one: Int, two: Int, count: int) -> Int:
    graph = coo_array((np.ones(len(one)), (one, two)), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1], np.int32)


def side_lengths(mesh: ClothMesh, sides: Sides) -> Float:
    return np.asarray(np.linalg.norm(mesh.rest[sides.ends[:, 1]] - mesh.rest[sides.ends[:, 0]], axis=1))


def same_sums(label: Int, values: Float, new_label: Int, new_values: Float) -> None:
    count = int(max(label.max(initial=0), new_label.max(initial=0))) + 1
    old = np.bincount(label, weights=values, minlength=count)
    new = np.bincount(new_label, weights=new_values, minlength=count)
    assert np.abs(new - old).max() <= 1e-12 * np.abs(old).max(), np.abs(new - old).max()


def topology(mesh: ClothMesh, sides: Sides) -> tuple[int, int, int, list[int], list[int]]:
    """Euler characteristic of nodes and of material vertices, pieces, tangles, fans of pinched nodes."""
    nodes, count, fans = mesh.face_nodes, len(mesh.positions), fan_counts(mesh, sides)
    vertex_edges = np.unique(np.sort(mesh.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0)
    return (
        count - len(sides.edges) + len(nodes),
        len(mesh.rest) - len(vertex_edges) + len(nodes),
        int(components(sides.edges[:, 0], sides.edges[:, 1], count).max()) + 1,
        sorted(sides.counts[(sides.counts > 2) | (sides.edges[:, 0] == sides.edges[:, 1])].tolist()),
        sorted(fans[fans != 1].tolist()),
    )


def fan_counts(mesh: ClothMesh, sides: Sides) -> Int:
    """How many fans of faces, joined across edges of two faces, meet at every node, shape (n,)."""
    one, two = partners(sides)
    corner_node = mesh.face_nodes.ravel()
    left, right = [], []
    for end in (0, 1):
        node = sides.edges[sides.edge[one], end]
        left.append(_corner_at(corner_node, one // 3, node))
        right.append(_corner_at(corner_node, two // 3, node))
    fan = components(np.concatenate(left), np.concatenate(right), len(corner_node))
    first = np.unique(fan, return_index=True)[1]
    return np.asarray(np.bincount(corner_node[first], minlength=len(mesh.positions)))


def _corner_at(corner_node: Int, face: Int, node: Int) -> Int:
    at = corner_node.reshape(-1, 3)[face] == node[:, None]
    return np.asarray(3 * face + at.argmax(axis=1))


def check_marks(before: ClothMesh, old: Sides, result: AdaptResult, new: Sides) -> None:
    """Kept nodes, corners, ends of frozen edges and pins off straight rows are there; pins do not spread."""
    after, transfer = result.mesh, result.transfer
    corner = corners(before, old)
    must_stay = before.kept | corner
    must_stay[before.frozen_edges.ravel()] = True
    must_stay |= before.pinned & ~on_any_line(before, old)
    assert (transfer.new_node[must_stay] >= 0).all()
    stayed = transfer.new_node >= 0
    assert np.array_equal(after.kept[transfer.new_node[stayed]], before.kept[stayed])
    assert after.kept.sum() == before.kept.sum()
    assert np.array_equal(after.pinned[transfer.new_node[stayed]], before.pinned[stayed])
    assert np.array_equal(transfer.marked_nodes(before.pinned), after.pinned)
    check_pinned_rows(before.positions[before.pinned & ~stayed], after, new)
    assert np.array_equal(after.frozen_edges, transfer.new_node[before.frozen_edges])
    edges = {tuple(edge) for edge in new.edges.tolist()}
    assert {tuple(edge) for edge in np.sort(after.frozen_edges, axis=1).tolist()} <= edges


def check_pinned_rows(gone: Float, after: ClothMesh, new: Sides) -> None:
    """Places of pinned nodes that were removed lie on edges between pinned nodes."""
    border, seam, _, _ = line_sides(after, new, coplanar_patches(after, new))
    ends = after.node[new.ends[border | seam]]
    start, end = after.positions[ends[after.pinned[ends].all(axis=1)].T]
    for place in gone:
        around = np.linalg.norm(place - start, axis=1) + np.linalg.norm(place - end, axis=1)
        assert (around / np.linalg.norm(end - start, axis=1)).min(initial=np.inf) < 1.0 + 1e-9


def on_any_line(mesh: ClothMesh, sides: Sides) -> Bool:
    border, seam, _, tangle = line_sides(mesh, sides, coplanar_patches(mesh, sides))
    on_line = np.zeros(len(mesh.positions), bool)
    on_line[mesh.node[sides.ends[border | seam | tangle]].ravel()] = True
    return on_line


def corners(mesh: ClothMesh, sides: Sides) -> Bool:
    """Nodes where lines end, meet or turn by more than a millionth, shape (n,)."""
    kinds = line_sides(mesh, sides, coplanar_patches(mesh, sides))
    on_line = np.logical_or.reduce(kinds)
    lines: dict[int, set[int]] = {}
    out: dict[int, list[int]] = {}
    for edge, ends in zip(sides.edge[on_line].tolist(), sides.ends[on_line].tolist(), strict=True):
        for here, there in (ends, ends[::-1]):
            lines.setdefault(int(mesh.node[here]), set()).add(edge)
            out.setdefault(here, []).append(there)
    result = np.zeros(len(mesh.positions), bool)
    for node, edges in lines.items():
        result[node] = len(edges) != 2
    for here, ahead in out.items():
        along = mesh.rest[ahead] - mesh.rest[here]
        along /= np.linalg.norm(along, axis=1)[:, None]
        result[mesh.node[here]] |= len(ahead) >= 2 and float(np.abs(along - along[0]).max()) < 1e-6
        straight = np.minimum(
            np.linalg.norm(along - along[0], axis=1), np.linalg.norm(along + along[0], axis=1)
        )
        result[mesh.node[here]] |= float(straight.max()) > 1e-6
    return result


def lumped_mass(mesh: ClothMesh) -> Float:
    third = np.repeat(0.2 * mesh.rest_area / 3.0, 3)
    return np.asarray(np.bincount(mesh.face_nodes.ravel(), weights=third, minlength=len(mesh.positions)))


def check_momentum(before: ClothMesh, result: AdaptResult, velocities: Float) -> None:
    """Linear and angular momentum of every piece of cloth can be kept to 1e-10."""
    after, transfer = result.mesh, result.transfer
    sides = sides_of(before)
    piece = components(sides.edges[:, 0], sides.edges[:, 1], len(before.positions))
    new_piece = np.rint(transfer.at_nodes(piece.astype(float))).astype(np.int32)
    old = Motion(before.positions, velocities, lumped_mass(before), piece)
    new = Motion(after.positions, transfer.at_nodes(velocities), lumped_mass(after), new_piece)
    new = new._replace(velocities=with_momentum_of(old, new))
    for number in range(int(piece.max()) + 1):
        was, now = _momenta(old, number), _momenta(new, number)
        assert np.abs(now - was).max() < 1e-10 * max(_momentum_scale(old, number), 1e-300)


def _momenta(motion: Motion, piece: int) -> Float:
    here = motion.component == piece
    momentum = motion.mass[here, None] * motion.velocities[here]
    return np.concatenate([momentum.sum(axis=0), np.cross(motion.positions[here], momentum).sum(axis=0)])


def _momentum_scale(motion: Motion, piece: int) -> float:
    here = motion.component == piece
    momentum = motion.mass[here] * np.linalg.norm(motion.velocities[here], axis=1)
    return float((momentum * (1.0 + np.linalg.norm(motion.positions[here], axis=1))).sum())
