"""Layers that lie exactly in each other are laid one on the other, from the body outwards.

Flat patterns and quick models put a pocket in the very plane of the front. Neither lies outside then: every
move of one would count as a crossing, and no contact force knows which way to push.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import cKDTree

from toile.dressing.garment.garment_mesh import GarmentMesh
from toile.geometry.arrays import Bool, Float, Int
from toile.geometry.connected import connected, first_connected
from toile.geometry.normals import area_normals
from toile.geometry.topology import triangle_topology

TOUCHING = 5e-5
"""Faces whose middle is this close to another piece lie in it [m]."""
PARALLEL = 0.9
"""Least dot product of the normals of faces that lie in each other."""
LIFT, PANEL_LIFT = 2e-3, 0.02
"""How far out the later layer starts, of a mesh and of a flat panel [m]."""


@dataclass(frozen=True)
class _Piece:
    """Faces of one garment that hang together: garment, faces, shape (k,), nodes, area [m^2]."""

    garment: int
    faces: Int
    nodes: Int
    area: float


def laid_on(meshes: list[GarmentMesh], body: Float) -> tuple[list[GarmentMesh], tuple[str, ...]]:
    """Move layers that lie in others out of them, away from the body's vertices, shape (v, 3) [m].

    Later garments lie on earlier ones, and in a garment smaller pieces on larger ones. Pieces of meshes move
    where they overlap, flat panels as a whole. Returns one sentence per piece that moved.
    """
    nodes = [_leaders(mesh) for mesh in meshes]
    places = [mesh.positions.copy() for mesh in meshes]
    pieces = [
        piece
        for index, mesh in enumerate(meshes)
        for piece in sorted(_pieces(index, mesh, nodes[index]), key=lambda piece: -piece.area)
    ]
    notes: list[str] = []
    for number, upper in enumerate(pieces):
        moved = False
        for _ in range(number):
            touched = [_touched(places, meshes, nodes, lower, upper) for lower in pieces[:number]]
            faces = np.unique(np.concatenate(touched)).astype(np.int32) if touched else np.empty(0, np.int32)
            if not len(faces):
                break
            _lift(
                meshes[upper.garment], places[upper.garment], nodes[upper.garment], upper, faces, pieces, body
            )
            moved = True
        if moved:
            mesh = meshes[upper.garment]
            panel = mesh.panel_names[int(mesh.panel[upper.faces[0]])]
            lift = PANEL_LIFT if mesh.flat else LIFT
            notes.append(
                f"garment {mesh.name}: {panel} lies exactly in another layer and starts {1e3 * lift:g} mm "
                "outside it"
            )
    if not notes:
        return meshes, ()
    return [replace(mesh, positions=place) for mesh, place in zip(meshes, places, strict=True)], tuple(notes)


def _leaders(mesh: GarmentMesh) -> Int:
    """Node of every material vertex, shape (m,): those of a texture seam are one; open seams are not."""
    leader = np.arange(len(mesh.positions), dtype=np.int32)
    if not mesh.flat and len(mesh.stitches):
        closed = (mesh.positions[mesh.stitches[:, 0]] == mesh.positions[mesh.stitches[:, 1]]).all(axis=1)
        leader = first_connected(mesh.stitches[closed], len(leader))
    return leader


def _pieces(index: int, mesh: GarmentMesh, node: Int) -> Iterator[_Piece]:
    """Yield what hangs together along edges of two faces: a piece that is sewn on is one of its own."""
    faces = node[mesh.faces]
    label = connected(triangle_topology(faces).neighbour_pairs, len(faces))
    corners = mesh.positions[mesh.faces]
    area = np.linalg.norm(area_normals(corners), axis=1)
    for number in range(int(label.max(initial=-1)) + 1):
        own = np.flatnonzero(label == number).astype(np.int32)
        yield _Piece(index, own, np.unique(faces[own]), 0.5 * float(area[own].sum()))


def _touched(
    places: list[Float], meshes: list[GarmentMesh], nodes: list[Int], lower: _Piece, upper: _Piece
) -> Int:
    """Faces of the upper piece that lie in the lower one."""
    below, above = (
        places[piece.garment][meshes[piece.garment].faces[piece.faces]] for piece in (lower, upper)
    )
    apart = np.maximum(
        below.min(axis=(0, 1)) - above.max(axis=(0, 1)), above.min(axis=(0, 1)) - below.max(axis=(0, 1))
    )
    if apart.max() > TOUCHING:
        return np.empty(0, np.int32)
    lying, _ = _lying_in(above, below)
    _, covered = _lying_in(below, above)
    return np.asarray(upper.faces[np.unique(np.concatenate([lying, covered]))], np.int32)


def _lying_in(corners: Float, other: Float) -> tuple[Int, Int]:
    """Faces, corners of shape (k, 3, 3), whose middle lies in faces of another piece, and those faces."""
    middle, centre = corners.mean(axis=1), other.mean(axis=1)
    normal, facing = _normals(corners), _normals(other)
    reach = np.linalg.norm(other - centre[:, None], axis=2).max()
    low, high = other.min(axis=(0, 1)) - TOUCHING, other.max(axis=(0, 1)) + TOUCHING
    inside = np.flatnonzero(((middle >= low) & (middle <= high)).all(axis=1))
    near = cKDTree(centre).query_ball_point(middle[inside], reach, return_sorted=True)
    mine = np.repeat(inside, [len(found) for found in near])
    if not len(mine):
        return np.empty(0, np.int64), np.empty(0, np.int64)
    theirs = np.concatenate([np.asarray(found, np.int64) for found in near if found])
    height = np.einsum("ki,ki->k", middle[mine] - centre[theirs], facing[theirs])
    close = np.abs(height) < TOUCHING
    close &= np.abs(np.einsum("ki,ki->k", normal[mine], facing[theirs])) > PARALLEL
    mine, theirs, height = mine[close], theirs[close], height[close]
    within = _within(middle[mine] - height[:, None] * facing[theirs], other[theirs], facing[theirs])
    return mine[within], theirs[within]


def _within(point: Float, corners: Float, normal: Float) -> Bool:
    """Whether points in the planes of triangles lie in them."""
    inside = np.ones(len(point), bool)
    for k in range(3):
        side = corners[:, (k + 1) % 3] - corners[:, k]
        inside &= np.einsum("ki,ki->k", np.cross(side, point - corners[:, k]), normal) >= 0.0
    return inside


def _normals(corners: Float) -> Float:
    normal = area_normals(corners)
    return np.asarray(normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300))


def _lift(
    mesh: GarmentMesh, place: Float, node: Int, piece: _Piece, faces: Int, pieces: list[_Piece], body: Float
) -> None:
    """Move a piece out where its `faces` lie in another, in place; nodes of two pieces stay."""
    normal = np.zeros((len(place), 3))
    face_normals = _normals(place[mesh.faces[piece.faces]])
    for k in range(3):
        np.add.at(normal, node[mesh.faces[piece.faces, k]], face_normals)
    moved = piece.nodes if mesh.flat else np.unique(node[mesh.faces[faces]])
    shared = [other.nodes for other in pieces if other.garment == piece.garment and other is not piece]
    if not mesh.flat and shared:
        moved = moved[~np.isin(moved, np.concatenate(shared))]
    along = normal[moved]
    if mesh.flat:
        along = np.broadcast_to(along.sum(axis=0), along.shape)
    along = along / np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-12)
    nearest = body[cKDTree(body).query(place[moved])[1]]
    outwards = 1.0 if np.einsum("ki,ki->", along, place[moved] - nearest) >= 0.0 else -1.0
    shift = np.zeros((len(place), 3))
    shift[moved] = outwards * (PANEL_LIFT if mesh.flat else LIFT) * along
    place += shift[node]
