"""Cloth to remesh, metrics to remesh it to, and what every mesh must be."""

from dataclasses import replace

import numpy as np
from scipy.spatial import Delaunay

from toile.geometry.arrays import Float, Int
from toile.geometry.topology import triangle_topology
from toile.remesh.mesh.cloth_mesh import ClothMesh

FLAT_FRAME = np.array([[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]])


def cloth(
    rest: Float,
    faces: Int,
    *,
    node: Int | None = None,
    positions: Float | None = None,
    frames: Float | None = None,
    region: Int | None = None,
) -> ClothMesh:
    """A mesh with nothing kept or pinned; flat, of one region and lying at its rest place unless told."""
    places = rest if positions is None else positions
    return ClothMesh(
        rest=rest,
        node=np.arange(len(rest), dtype=np.int32) if node is None else node.astype(np.int32),
        faces=faces.astype(np.int32),
        frames=np.tile(FLAT_FRAME, (len(faces), 1, 1)) if frames is None else frames,
        region=np.zeros(len(faces), np.int32) if region is None else region.astype(np.int32),
        positions=places,
        kept=np.zeros(len(places), bool),
        pinned=np.zeros(len(places), bool),
        frozen_edges=np.empty((0, 2), np.int32),
    )


def grid_faces(columns: int, rows: int) -> Int:
    corner = np.arange((columns + 1) * (rows + 1)).reshape(columns + 1, rows + 1)
    a, b = corner[:-1, :-1].ravel(), corner[1:, :-1].ravel()
    c, d = corner[1:, 1:].ravel(), corner[:-1, 1:].ravel()
    return np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)]).astype(np.int32)


def grid_points(columns: int, rows: int) -> Float:
    """Points of the unit square, shape (k, 3)."""
    u, v = np.meshgrid(np.linspace(0, 1, columns + 1), np.linspace(0, 1, rows + 1), indexing="ij")
    return np.stack([u.ravel(), v.ravel(), np.zeros(u.size)], axis=1)


def right_grid(count: int) -> ClothMesh:
    """A waving unit square."""
    rest = grid_points(count, count)
    return cloth(rest, grid_faces(count, count), positions=waving(rest))


def random_delaunay(count: int, seed: int = 1) -> ClothMesh:
    """A waving unit square with random points inside."""
    side = np.arange(count) / count
    zero, one = np.zeros(count), np.ones(count)
    u = np.concatenate([side, one, 1 - side, zero])
    v = np.concatenate([zero, side, one, 1 - side])
    inside = np.random.default_rng(seed).uniform(0.3 / count, 1 - 0.3 / count, (count * count, 2))
    points = np.concatenate([np.stack([u, v], axis=1), inside])
    rest = np.concatenate([points, np.zeros((len(points), 1))], axis=1)
    return cloth(rest, delaunay_faces(points), positions=waving(rest))


def jittered(count: int, seed: int = 1) -> ClothMesh:
    """A flat unit square with an irregular mesh of even density."""
    rest = grid_points(count, count)
    inside = (np.abs(rest[:, :2] - 0.5) < 0.5 - 1e-9).all(axis=1)
    rest[inside, :2] += np.random.default_rng(seed).uniform(-0.3, 0.3, (int(inside.sum()), 2)) / count
    return cloth(rest, delaunay_faces(rest[:, :2]))


def delaunay_faces(points: Float) -> Int:
    """Counter-clockwise triangles with an area."""
    faces = Delaunay(points).simplices
    sides = points[faces[:, 1:]] - points[faces[:, :1]]
    area = sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]
    faces[area < 0] = faces[area < 0, ::-1]
    return np.asarray(faces[np.abs(area) > 1e-12], np.int32)


def waving(rest: Float) -> Float:
    x, y, _ = rest.T
    return np.stack([x, 0.05 * np.sin(9 * x) * np.cos(7 * y), y], axis=1)


def sewn_panels(count: int, blocks: int = 2) -> ClothMesh:
    """`blocks` x `blocks` panels of `count` cells a side, sewn; each placed and scaled on its own."""
    cells = count * blocks
    points, faces = grid_points(cells, cells), grid_faces(cells, cells)
    middle = points[faces].mean(axis=1)
    column, row = np.minimum((middle[:, :2] * blocks).astype(int), blocks - 1).T
    panel = column * blocks + row
    pairs, inverse = np.unique(
        np.stack([np.repeat(panel, 3), faces.ravel()], axis=1), axis=0, return_inverse=True
    )
    angle, scale = 0.4 * pairs[:, 0], 1.0 + 0.1 * pairs[:, 0]
    u, v, _ = points[pairs[:, 1]].T
    rest = np.stack([u * np.cos(angle) - v * np.sin(angle), u * np.sin(angle) + v * np.cos(angle), 0 * u])
    rest = np.ascontiguousarray((rest * scale).T) + pairs[:, :1] * [0.3, -0.2, 0.0]
    return cloth(
        rest,
        inverse.reshape(-1, 3).astype(np.int32),
        node=pairs[:, 1],
        positions=waving(points),
        region=panel,
    )


def dart(count: int) -> ClothMesh:
    """One panel with a sewn wedge from the middle of its lower side to its centre."""
    rest, faces = grid_points(2 * count, 2 * count), grid_faces(2 * count, 2 * count)
    slit = np.flatnonzero((rest[:, 0] == 0.5) & (rest[:, 1] < 0.5 - 1e-9))
    node = np.concatenate([np.arange(len(rest)), slit]).astype(np.int32)
    twin = np.arange(len(rest), dtype=np.int32)
    twin[slit] = len(rest) + np.arange(len(slit), dtype=np.int32)
    right = rest[faces].mean(axis=1)[:, 0] > 0.5
    faces[right] = twin[faces[right]]
    positions = waving(rest)
    rest = np.concatenate([rest, rest[slit]])
    opening = 0.1 * (0.5 - rest[len(positions) :, 1])
    rest[len(positions) :, 0] += opening
    return cloth(rest, faces, node=node, positions=positions)


def sphere_cap(count: int) -> ClothMesh:
    """A curved rest shape, every face with a frame of its own."""
    points, faces = grid_points(count, count), grid_faces(count, count)
    x, y = points[:, 0] - 0.5, points[:, 1] - 0.5
    rest = np.stack([x, y, np.sqrt(1.0 - x * x - y * y)], axis=1)
    return cloth(rest, faces, frames=own_frames(rest, faces), positions=1.1 * rest)


def own_frames(rest: Float, faces: Int) -> Float:
    a, b, c = rest[faces[:, 0]], rest[faces[:, 1]], rest[faces[:, 2]]
    warp = (b - a) / np.linalg.norm(b - a, axis=1)[:, None]
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    return np.stack([warp, np.cross(normal, warp)], axis=2)


def uniform(mesh: ClothMesh, size: float) -> Float:
    """The same wanted length [m] everywhere in all directions."""
    return np.tile(np.eye(3) / size**2, (len(mesh.rest), 1, 1))


def ridge(mesh: ClothMesh, finest: float = 0.005, coarsest: float = 0.1) -> Float:
    """Fine across a curved line through the unit square, four times longer along it, coarse elsewhere."""
    x, y, _ = mesh.rest.T
    across = np.stack([-0.6 * np.cos(3 * x), np.ones_like(x)], axis=1)
    steepness = np.linalg.norm(across, axis=1)
    across /= steepness[:, None]
    along = np.stack([-across[:, 1], across[:, 0]], axis=1)
    distance = np.abs(y - 0.5 - 0.2 * np.sin(3 * x)) / steepness
    short = np.clip(finest + 0.25 * distance, finest, coarsest)
    long = np.minimum(4.0 * short, coarsest)
    tensors = np.zeros((len(x), 3, 3))
    tensors[:, :2, :2] = across[:, :, None] * across[:, None, :] / (short**2)[:, None, None]
    tensors[:, :2, :2] += along[:, :, None] * along[:, None, :] / (long**2)[:, None, None]
    return tensors


def euler_characteristic(mesh: ClothMesh) -> int:
    topology = triangle_topology(mesh.face_nodes)
    return len(mesh.positions) - len(topology.edges) + len(mesh.faces)


def check_surface(mesh: ClothMesh) -> None:
    """Check that a mesh is a surface without inverted faces, and that nothing is left over."""
    assert mesh.rest_area.min() > 0.0
    nodes = mesh.face_nodes
    assert (nodes[:, 0] != nodes[:, 1]).all() and (nodes[:, 1] != nodes[:, 2]).all()
    assert (nodes[:, 2] != nodes[:, 0]).all()
    assert len(np.unique(np.sort(nodes, axis=1), axis=0)) == len(nodes)
    assert triangle_topology(nodes).edge_face_count.max() <= 2
    assert np.array_equal(np.unique(mesh.node), np.arange(len(mesh.positions)))
    assert np.array_equal(np.unique(mesh.faces), np.arange(len(mesh.rest)))
    plane = mesh.rest_corners
    lifted = mesh.rest[mesh.faces[:, :1]] + np.einsum("tcj,tij->tci", plane, mesh.frames)
    assert np.abs(lifted - mesh.rest[mesh.faces]).max() < 1e-9


def panel_areas(mesh: ClothMesh) -> Float:
    return np.asarray(np.bincount(mesh.region, weights=mesh.rest_area))


def with_pins(mesh: ClothMesh, *, pinned: list[int], kept: list[int]) -> ClothMesh:
    nodes = np.arange(len(mesh.positions))
    return replace(mesh, pinned=np.isin(nodes, pinned), kept=np.isin(nodes, kept))
