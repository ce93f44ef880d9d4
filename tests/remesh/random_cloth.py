"""Random cloth, random metrics and random refusals, each from one generator."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import ConvexHull

from tests.remesh.cloth_samples import FLAT_FRAME, cloth, delaunay_faces, grid_faces, own_frames
from toile.geometry.arrays import Bool, Float, Int
from toile.remesh.adapt.acceptance import Accept, Proposals
from toile.remesh.mesh.cloth_mesh import ClothMesh

Random = np.random.Generator


def panel(random: Random) -> ClothMesh:
    """One flat panel whose jagged outline, holes and bow-ties are what a random choice of faces leaves."""
    points, faces = _planar(random)
    middle = points[faces].mean(axis=1)
    angle = np.arctan2(*(middle - points.mean(axis=0)).T)
    reach = np.linalg.norm(middle - points.mean(axis=0), axis=1) / np.ptp(points)
    inside = reach < 0.45 + 0.15 * np.sin(random.integers(2, 6) * angle + random.uniform(0, 6))
    inside &= random.random(len(faces)) < random.choice([1.0, 0.95])
    inside[np.argmin(reach)] = True
    return _cut(random, points, faces[inside], np.zeros(int(inside.sum()), np.int32), Flat(random))


def sewn(random: Random) -> ClothMesh:
    """Flat panels, each with a map of its own from the common plane: seams are gathered, some have darts."""
    points, faces = _planar(random)
    middle, region = points[faces].mean(axis=1), np.zeros(len(faces), np.int32)
    for _ in range(int(random.integers(1, 4))):
        across = random.normal(size=2)
        beyond = (middle - random.permutation(points)[0]) @ across > 0.0
        region = 2 * region + beyond
    region = np.unique(region, return_inverse=True)[1].astype(np.int32)
    return _cut(random, points, faces, region, Flat(random), darts=int(random.integers(0, 4)))


def grid(random: Random) -> ClothMesh:
    """Flat panels with straight seams along the lines of a grid, whose halves are gathered unevenly."""
    columns, rows = random.integers(4, 11, 2)
    u, v = np.meshgrid(np.arange(columns + 1.0), np.arange(rows + 1.0), indexing="ij")
    points, faces = np.stack([u.ravel(), v.ravel()], axis=1), grid_faces(int(columns), int(rows))
    middle = points[faces].mean(axis=1)
    region = (middle[:, 0] > columns // 2) + 2 * (middle[:, 1] > random.choice([rows // 2, rows]))
    region = np.unique(region, return_inverse=True)[1].astype(np.int32)
    return _cut(random, points, faces, region, Flat(random, affine=False), darts=int(random.integers(0, 3)))


def tube(random: Random) -> ClothMesh:
    """Flat panels sewn into a tube."""
    columns, rows = (int(count) for count in random.integers(4, 11, 2))
    faces = grid_faces(columns, rows)
    turn, height = np.meshgrid(np.arange(columns + 1), np.arange(rows + 1), indexing="ij")
    node = ((turn % columns) * (rows + 1) + height).ravel().astype(np.int32)
    flat = np.stack([turn.ravel() + 0.3 * height.ravel(), height.ravel()], axis=1).astype(float)
    region = (flat[faces].mean(axis=1)[:, 1] > random.choice([rows // 2, rows])).astype(np.int32)
    region = np.unique(region, return_inverse=True)[1].astype(np.int32)
    angle = 2 * np.pi * (node // (rows + 1)) / columns
    places = np.stack([np.cos(angle), node % (rows + 1) / columns, np.sin(angle)], axis=1)
    return _cut(random, flat, faces, region, Flat(random), node=node, places=places)


def pillow(random: Random) -> ClothMesh:
    """Two flat panels with few nodes inside, sewn together all around."""
    while True:
        ring = _polygon(random, int(random.integers(3, 6)), int(random.integers(1, 4)), 2.0)
        count = len(ring)
        front, faces = _filled(random, ring, int(random.integers(1, 6)))
        back, other_faces = _filled(random, ring, int(random.integers(0, 6)))
        points = np.concatenate([front, back * [-1.0, 1.0]])
        places = np.column_stack([points, np.zeros(len(points))])
        node = np.arange(len(points), dtype=np.int32)
        node[len(front) : len(front) + count] = np.arange(count)
        places[count : len(front), 2], places[len(front) + count :, 2] = 0.3, -0.3
        region = np.repeat([0, 1], [len(faces), len(other_faces)]).astype(np.int32)
        both = np.concatenate([faces, other_faces[:, ::-1] + np.int32(len(front))])
        mesh = _cut(random, points, both, region, Flat(random), node=node, places=places)
        sides = np.sort(mesh.face_nodes[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
        single = len(np.unique(np.sort(mesh.face_nodes, axis=1), axis=0)) == len(mesh.faces)
        if single and (np.unique(sides, axis=0, return_counts=True)[1] == 2).all():
            return mesh


def cap(random: Random) -> ClothMesh:
    """Part of a sphere or of a cone as a curved rest shape, some with flat parts, of one or two fabrics."""
    points, faces = _planar(random)
    points = 1.2 * (points - points.min(axis=0)) / np.ptp(points, axis=0).max() - 0.6
    distance = np.linalg.norm(points, axis=1)
    ball, cone = np.sqrt(1.0 - distance**2), 1.0 - 0.5 * distance
    height = [ball, cone, np.maximum(points[:, 0], 0.0), np.maximum(ball, 0.9)][random.integers(4)]
    rest = np.column_stack([points, height])
    region = (rest[faces].mean(axis=1)[:, 0] > random.choice([0.1, 9.0])).astype(np.int32)
    mesh = cloth(rest, faces, region=region, frames=own_frames(rest, faces))
    return replace(mesh, positions=1.1 * rest + 0.02 * random.normal(size=rest.shape))


def ball(random: Random) -> ClothMesh:
    """A closed surface of few faces as rest shape: no border at all."""
    rest = random.normal(size=(int(random.integers(5, 40)), 3))
    rest /= np.linalg.norm(rest, axis=1)[:, None]
    faces = ConvexHull(rest).simplices.astype(np.int32)
    a, b, c = rest[faces[:, 0]], rest[faces[:, 1]], rest[faces[:, 2]]
    inward = np.einsum("ti,ti->t", np.cross(b - a, c - a), a - rest.mean(axis=0)) < 0
    faces[inward] = faces[inward, ::-1]
    return cloth(rest, faces, frames=own_frames(rest, faces))


def tangled(random: Random) -> ClothMesh:
    """Panels with random nodes sewn together: faces on two nodes, edges of three or more faces.

    No two faces have the same three nodes: what such a pair encloses is nothing, and splits make more of it.
    """
    mesh = [panel, sewn, grid][random.integers(3)](random)
    count = len(mesh.positions)
    target = np.arange(count)
    near = np.argsort(np.linalg.norm(mesh.positions - mesh.positions[random.integers(count)], axis=1))
    chosen = near[: int(random.integers(2, 7))] if random.random() < 0.5 else random.integers(0, count, 4)
    target[chosen] = chosen[0]
    kept, node = np.unique(target, return_inverse=True)
    nodes = np.sort(node[mesh.node][mesh.faces], axis=1)
    if len(np.unique(nodes, axis=0)) < len(nodes):
        return mesh
    return cloth(
        mesh.rest,
        mesh.faces,
        node=node[mesh.node].astype(np.int32),
        positions=mesh.positions[kept],
        frames=mesh.frames,
        region=mesh.region,
    )


SURFACES: dict[str, Callable[[Random], ClothMesh]] = {
    entry.__name__: entry for entry in (panel, sewn, grid, tube, pillow, cap, ball)
}


def marked(random: Random, mesh: ClothMesh) -> ClothMesh:
    """The mesh with some nodes kept, some pinned (single ones, and all of one side), some edges frozen."""
    count = len(mesh.positions)
    kept = random.random(count) < random.choice([0.0, 0.05])
    pinned = random.random(count) < random.choice([0.0, 0.05])
    low = mesh.rest[:, int(random.integers(2))]
    side = np.zeros(count, bool)
    side[mesh.node[low <= low.min() + 1e-9]] = True
    pinned |= side & (random.random() < 0.5)
    sides = np.unique(np.sort(mesh.face_nodes[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)
    frozen = sides[random.random(len(sides)) < random.choice([0.0, 0.03])].astype(np.int32)
    return replace(mesh, kept=kept, pinned=pinned, frozen_edges=random.permuted(frozen, axis=1))


def renumbered(random: Random, mesh: ClothMesh) -> ClothMesh:
    """The same mesh with nodes, material vertices, faces and their first corners in random order."""
    nodes, vertices = random.permutation(len(mesh.positions)), random.permutation(len(mesh.rest))
    faces = random.permutation(len(mesh.faces))
    new_node, new_vertex = np.argsort(nodes).astype(np.int32), np.argsort(vertices).astype(np.int32)
    turn = (np.arange(3) + random.integers(0, 3, (len(faces), 1))) % 3
    return ClothMesh(
        rest=mesh.rest[vertices],
        node=new_node[mesh.node[vertices]],
        faces=np.take_along_axis(new_vertex[mesh.faces[faces]], turn, axis=1),
        frames=mesh.frames[faces],
        region=mesh.region[faces],
        positions=mesh.positions[nodes],
        kept=mesh.kept[nodes],
        pinned=mesh.pinned[nodes],
        frozen_edges=new_node[mesh.frozen_edges],
    )


def field(random: Random, mesh: ClothMesh, spacing: float) -> Float:
    """Metrics that want edges of about `spacing` [m], up to several times finer or coarser."""
    kind = random.choice(["even", "smooth", "rough", "needles", "singular"])
    size = spacing * random.choice([0.6, 1.0, 2.0, 4.0, 20.0])
    count = len(mesh.rest)
    if kind == "even":
        return np.tile(np.eye(3) / size**2, (count, 1, 1))
    if kind == "smooth":
        waves = random.normal(size=(3, 9)) / (6.0 * spacing)
        factors = np.sin(mesh.rest @ waves + random.uniform(0, 6, 9)).reshape(count, 3, 3)
        factors += 0.3 * np.eye(3)
    else:
        factors = random.normal(size=(count, 3, 3))
    if kind == "needles":
        factors = np.linalg.qr(factors)[0] * random.choice([1.0, 0.03, 0.001], (count, 1, 3))
    if kind == "singular":
        factors[:, random.integers(3)] = 0.0
        factors *= random.random((count, 1, 1)) < 0.7
    tensors = np.swapaxes(factors, 1, 2) @ factors / size**2
    return np.asarray(0.5 * (tensors + np.swapaxes(tensors, 1, 2)))


def refusals(random: Random) -> Accept | None:
    """No refusals, random ones, or all."""
    share = random.choice([0.0, 0.0, 0.3, 0.8, 1.0])

    def moody(positions: Float, proposals: Proposals) -> Bool:
        return np.asarray(random.random(proposals.proposal_count) >= share)

    return moody if share > 0.0 else None


class Flat:
    """A map of its own for every panel: from the plane they share to the plane they are cut in."""

    def __init__(self, random: Random, *, affine: bool = True) -> None:
        self._random, self._affine = random, affine

    def __call__(self, points: Float) -> Float:
        """Turned, sheared and scaled; or stretched unevenly along both axes, then turned."""
        random = self._random
        angle = random.uniform(0, 6)
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        stretch = np.diag(random.uniform(0.7, 1.4, 2))
        if self._affine:
            stretch[0, 1] = random.uniform(-0.4, 0.4)
        else:
            points = points + 0.2 * np.sin(points + random.uniform(0, 6, 2))
        return np.asarray(points @ stretch.T @ turn.T + random.uniform(-5, 5, 2))


def _planar(random: Random) -> tuple[Float, Int]:
    """Points (k, 2) about 1 apart and their triangulation, within a polygon with straight or jagged sides."""
    count, corners = int(random.integers(5, 90)), int(random.integers(3, 8))
    radius = 0.7 * np.sqrt(count)
    points = random.uniform(-radius, radius, (count, 2))
    if random.random() < 0.6:
        outline = _polygon(random, corners, int(random.integers(1, 5)), radius)
        return _without_slivers(np.concatenate([outline, _within(points, outline)]))
    return _without_slivers(points)


def _polygon(random: Random, corners: int, parts: int, radius: float) -> Float:
    """Points counter-clockwise around a convex polygon whose sides have `parts` parts, shape (k, 2)."""
    angle = 2 * np.pi * (np.arange(corners) + random.uniform(-0.3, 0.3, corners)) / corners
    corner = radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    share = np.arange(parts)[:, None] / parts
    sides = corner[:, None] + share * (np.roll(corner, -1, axis=0) - corner)[:, None]
    return np.asarray(sides.reshape(-1, 2))


def _within(points: Float, outline: Float) -> Float:
    """Those of the points that are well within a convex outline."""
    along = np.roll(outline, -1, axis=0) - outline
    inward = np.stack([-along[:, 1], along[:, 0]], axis=1) / np.linalg.norm(along, axis=1)[:, None]
    return np.asarray(points[(np.einsum("kci,ci->kc", points[:, None] - outline, inward) > 0.1).all(axis=1)])


def _filled(random: Random, ring: Float, count: int) -> tuple[Float, Int]:
    """Points of a convex ring and up to `count` within it, and a triangulation bordered by the ring."""
    rim = np.stack([np.arange(len(ring)), (np.arange(len(ring)) + 1) % len(ring)], axis=1)
    while True:
        inside = _within(random.uniform(ring.min(axis=0), ring.max(axis=0), (count, 2)), ring)
        points, faces = _without_slivers(np.concatenate([ring, inside]))
        sides = faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
        keys = sides @ [1000, 1]
        border = keys[~np.isin(keys, sides @ [1, 1000])]
        if np.array_equal(np.sort(border), np.sort(rim @ [1000, 1])):
            return points, faces


def _without_slivers(points: Float) -> tuple[Float, Int]:
    faces = delaunay_faces(points)
    sides = points[faces[:, [1, 2, 0]]] - points[faces]
    twice = sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]
    faces = faces[twice > 1e-3 * (sides**2).sum(axis=(1, 2))]
    used, inverse = np.unique(faces, return_inverse=True)
    return points[used], inverse.reshape(-1, 3).astype(np.int32)


def _cut(
    random: Random,
    points: Float,
    faces: Int,
    region: Int,
    place: Callable[[Float], Float],
    *,
    node: Int | None = None,
    places: Float | None = None,
    darts: int = 0,
) -> ClothMesh:
    """Cut the faces (t, 3) of plane points (k, 2) into panels, and sew them together again, some unevenly.

    `node` (k,) are the nodes of the points if several points share one, `places` their 3-D places. Corners
    are one material vertex where they are joined across edges that are not cut.
    """
    used, inverse = np.unique(faces, return_inverse=True)
    points, faces = points[used], inverse.reshape(-1, 3).astype(np.int32)
    if places is None:
        x, y = points.T
        places = np.stack([x, 0.3 * np.sin(x) * np.cos(y), y], axis=1)
    else:
        places = places[used]
    along = _paths(random, faces, darts)
    vertex = _joined_corners(faces, region, along)
    first = np.unique(vertex, return_index=True)[1]
    corner_point, corner_region = faces.ravel()[first], np.repeat(region, 3)[first]
    flat = points[corner_point]
    for panel_number in range(int(region.max()) + 1):
        here = corner_region == panel_number
        flat[here] = place(flat[here])
    own = np.arange(len(points), dtype=np.int32) if node is None else node[used]
    _, first, row = np.unique(own, return_index=True, return_inverse=True)
    vertex_node = row[corner_point].astype(np.int32)
    uneven = random.random(int(region.max()) + 1) < 0.3
    loose = (np.bincount(vertex_node)[vertex_node] > 1) & uneven[corner_region]
    flat = _shaken(random, flat, vertex.reshape(-1, 3), loose)
    return cloth(
        np.column_stack([flat, np.zeros(len(flat))]),
        vertex.reshape(-1, 3),
        node=vertex_node,
        positions=places[first],
        frames=np.tile(FLAT_FRAME, (len(faces), 1, 1)),
        region=region,
    )


def _paths(random: Random, faces: Int, count: int) -> set[tuple[int, int]]:
    """Edges along random walks from the border, which never turn back.

    A slit within a panel is left out: once it is straight it is no seam but an edge like any other.
    """
    sides = {(p, q) for a, b, c in faces.tolist() for p, q in ((a, b), (b, c), (c, a))}
    border = sorted(p for p, q in sides if (q, p) not in sides)
    beside: dict[int, list[int]] = {}
    for p, q in sorted(sides):
        beside.setdefault(p, []).append(q)
    cut: set[tuple[int, int]] = set()
    for _ in range(count):
        here, seen = int(random.choice(border)), set[int]()
        for _ in range(int(random.integers(2, 6))):
            seen.add(here)
            ahead = [q for q in beside[here] if q not in seen]
            if not ahead:
                break
            there = int(random.choice(ahead))
            cut |= {(here, there), (there, here)}
            here = there
    return cut


def _joined_corners(faces: Int, region: Int, cut: set[tuple[int, int]]) -> Int:
    """Material vertex of every corner, shape (3t,)."""
    at: dict[tuple[int, int], tuple[int, int]] = {}
    joins: list[tuple[int, int]] = []
    for t, corners in enumerate(faces.tolist()):
        for k in range(3):
            p, q = corners[k], corners[(k + 1) % 3]
            here, there = 3 * t + k, 3 * t + (k + 1) % 3
            other = at.get((q, p))
            if other is not None and (p, q) not in cut and region[other[0] // 3] == region[t]:
                joins += [(here, other[1]), (there, other[0])]
            at[p, q] = (here, there)
    pairs = np.array(joins, int).reshape(-1, 2)
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(faces.size, faces.size))
    return np.asarray(connected_components(graph, directed=False)[1], np.int32)


def _shaken(random: Random, flat: Float, faces: Int, loose: Bool) -> Float:
    """Move loose vertices at random, as far as no face comes near to turning over."""
    moved = flat + 0.2 * random.normal(size=flat.shape) * loose[:, None]
    for _ in range(60):
        sides = moved[faces[:, [1, 2, 0]]] - moved[faces]
        twice = sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]
        bad = twice < 1e-3 * (sides**2).sum(axis=(1, 2))
        if not bad.any():
            break
        moved[faces[bad]] = 0.5 * (moved[faces[bad]] + flat[faces[bad]])
    return moved
