"""Repair of a triangle soup: one watertight, outward-oriented surface of the same shape."""

import manifold3d
import numpy as np

from toile.dressing.body.avatar_crossings import crossing_pairs, describe_places
from toile.dressing.body.avatar_holes import boundary_loops, fill_loop
from toile.dressing.body.avatar_topology import join_corners, orient_faces, weld_open_edges
from toile.geometry.arrays import Float, Int
from toile.geometry.connected import connected_vertices
from toile.geometry.errors import InputError
from toile.geometry.normals import area_normals

SMALLEST_VOLUME = 1e-9
"""A closed part below this volume [m3] is a sheet or a crumb, not a part of a body."""
LEAST_OUTSIDE = 0.05
"""A part of which no more than this share lies outside the others is inside them."""
CARD = 0.7
"""What closes the one hole of a card (hair, lashes) is more than this share of its own area."""


Part = tuple[Float, Int]
"""Vertices [m], shape (v, 3), and faces, shape (f, 3), of a closed, outward-oriented surface."""


def repaired_surface(file_name: str, vertices: Float, faces: Int) -> tuple[Float, Int, tuple[str, ...]]:
    """Return vertices [m], faces and notes of one closed surface around everything a soup encloses.

    Parts are closed as `closed_parts` does, and united. Vertices are never moved. A surface that crosses
    itself is kept as it is; the places are named in the notes. Raises InputError as `closed_parts` does.
    """
    parts, notes = closed_parts(file_name, vertices, faces)
    (vertices, faces), said = united(file_name, parts)
    return vertices, faces, (*notes, *said, *crossing_notes(vertices, faces))


def crossing_notes(vertices: Float, faces: Int) -> tuple[str, ...]:
    """Say where a surface [m] crosses itself, if it does."""
    pairs = crossing_pairs(vertices, faces)
    if not len(pairs):
        return ()
    centres = vertices[faces[pairs]].mean(axis=(1, 2))
    return (
        f"The body crosses itself in {len(pairs)} pairs of faces, kept as they are, near "
        f"{describe_places(centres)}.",
    )


def closed_parts(file_name: str, vertices: Float, faces: Int) -> tuple[list[Part], list[str]]:
    """Return the closed parts of a triangle soup, vertices in metres, and notes.

    Duplicate vertices along open edges are welded, duplicate and collapsed faces dropped, windings made
    consistent and outward, and holes filled. Raises InputError naming the place if a part is one-sided, a
    hole cannot be filled, or nothing encloses a volume.
    """
    notes: list[str] = []
    vertices, faces, welded = weld_open_edges(vertices, faces)
    if welded:
        notes.append(f"{welded} duplicate vertices were merged.")
    faces, dropped = _without_useless_faces(faces)
    if dropped:
        notes.append(f"{dropped} collapsed or duplicate faces were dropped.")
    if not len(faces):
        raise InputError(f"{file_name}: every face is collapsed to a line or point; export the body again")

    vertices, faces, split = join_corners(vertices, faces)
    if split:
        notes.append(f"{split} vertices where surfaces only touch were taken apart.")
    faces, part, turned, one_sided = orient_faces(faces)
    if one_sided >= 0:
        place = describe_places(vertices[faces[part == one_sided]].mean(axis=1))
        raise InputError(
            f"{file_name}: the surface near {place} has only one side (like a Moebius strip), so it has no "
            "inside; remove or repair that part"
        )
    parts, repairs, turned_parts = _closed_parts(file_name, vertices, faces, part)
    turned += turned_parts
    if turned:
        notes.append(f"{turned} faces were turned outward.")
    return parts, notes + repairs


def _without_useless_faces(faces: Int) -> tuple[Int, int]:
    """Drop faces that use a vertex twice and all but the first of faces on the same three vertices."""
    distinct = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
    kept = faces[distinct]
    _, first = np.unique(np.sort(kept, axis=1), axis=0, return_index=True)
    kept = np.ascontiguousarray(kept[np.sort(first)])
    return kept, len(faces) - len(kept)


def _volume(vertices: Float, faces: Int) -> float:
    """Signed volume [m3] enclosed by a closed surface, positive if faces look outward."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


def _area(vertices: Float, faces: Int) -> float:
    """Area of triangles [m2]."""
    return 0.5 * float(np.linalg.norm(area_normals(vertices[faces]), axis=1).sum())


def _closed_parts(
    file_name: str, vertices: Float, faces: Int, part: Int
) -> tuple[list[Part], list[str], int]:
    """Fill the holes of every connected part and turn it outward.

    Returns the closed parts, the notes, and how many faces were turned.
    """
    parts: list[Part] = []
    filled_places: list[Float] = []
    filled_edges: list[int] = []
    sheets = turned = 0
    largest = int(np.bincount(part).argmax())
    for index in range(int(part.max()) + 1):
        members = faces[part == index]
        used, local = np.unique(members, return_inverse=True)
        points = np.ascontiguousarray(vertices[used])
        triangles = np.ascontiguousarray(local.reshape(-1, 3), dtype=np.int32)
        centre = points.mean(axis=0)
        points_closed, triangles_closed = points, triangles
        loops = boundary_loops(triangles)
        for loop in loops:
            patch = loop[fill_loop(points[loop])].astype(np.int32)
            triangles_closed = np.concatenate([triangles_closed, patch])
        volume = _volume(points_closed - centre, triangles_closed)
        own, closing = (_area(points, some) for some in (triangles, triangles_closed[len(triangles) :]))
        is_card = len(loops) == 1 and closing > CARD * own and index != largest
        if abs(volume) < SMALLEST_VOLUME or is_card:
            sheets += 1
            continue
        for loop in loops:
            filled_places.append(points[loop].mean(axis=0))
            filled_edges.append(len(loop))
        if volume < 0.0:
            turned += len(triangles)
            triangles_closed = np.ascontiguousarray(triangles_closed[:, ::-1])
        parts.append((points_closed, triangles_closed))
    if not parts:
        raise InputError(
            f"{file_name}: the mesh encloses no volume (it is flat or made of loose faces); "
            "an avatar must be a solid body"
        )
    notes: list[str] = []
    if filled_places:
        holes = "1 hole" if len(filled_places) == 1 else f"{len(filled_places)} holes"
        notes.append(
            f"{holes} of {min(filled_edges)} to {max(filled_edges)} edges filled, near "
            f"{describe_places(np.array(filled_places))}."
        )
    if sheets:
        notes.append(f"{sheets} sheets that enclose no volume (cards of hair, lashes) were left out.")
    return parts, notes, turned


def side_by_side(file_name: str, parts: list[Part]) -> tuple[Part, list[str]]:
    """Return closed parts as one mesh of several shells, without those that lie inside others, and notes."""
    solids = [_solid(file_name, points, triangles) for points, triangles in parts]
    order = sorted(range(len(parts)), key=lambda index: -solids[index].volume())
    around, shells = solids[order[0]], [order[0]]
    for index in order[1:]:
        if (solids[index] - around).volume() > LEAST_OUTSIDE * solids[index].volume():
            shells.append(index)
            around += solids[index]
    shells.sort()
    starts = np.cumsum([0, *(len(parts[index][0]) for index in shells)])
    vertices = np.concatenate([parts[index][0] for index in shells])
    pieces = [parts[index][1] + start for index, start in zip(shells, starts, strict=False)]
    inside = len(parts) - len(shells)
    notes = [f"{inside} closed parts inside others (eyes, teeth) were left out."] if inside else []
    if len(shells) > 1:
        notes.append(f"{len(shells)} closed parts move apart from each other.")
    return (vertices, np.ascontiguousarray(np.concatenate(pieces), np.int32)), notes


def united(file_name: str, parts: list[Part]) -> tuple[Part, list[str]]:
    """Return closed parts as one surface, and notes; a single part is returned untouched."""
    solids = [_solid(file_name, points, triangles) for points, triangles in parts]
    if len(solids) == 1:
        return parts[0], []
    union = manifold3d.Manifold.batch_boolean(solids, manifold3d.OpType.Add)
    mesh = union.to_mesh64()
    vertices = np.ascontiguousarray(mesh.vert_properties[:, :3], dtype=np.float64)
    faces = np.ascontiguousarray(mesh.tri_verts, dtype=np.int32)
    if not len(faces):
        raise InputError(f"{file_name}: uniting its {len(parts)} parts left nothing; export one closed body")
    vertices, faces, pieces, hollows = _without_hollows(vertices, faces)
    inside = f"{hollows} hollows inside were filled" if hollows else ""
    loose = f"{pieces} pieces that do not touch remain" if pieces > 1 else ""
    details = "; ".join(text for text in (inside, loose) if text)
    note = f"{len(parts)} closed parts were united into one body" + (f" ({details})." if details else ".")
    return (vertices, faces), [note]


def _solid(file_name: str, points: Float, triangles: Int) -> manifold3d.Manifold:
    """Return a manifold3d solid of one closed part. Raises InputError if it is none."""
    solid = manifold3d.Manifold(
        manifold3d.Mesh64(vert_properties=points, tri_verts=triangles.astype(np.uint64))
    )
    if solid.status() != manifold3d.Error.NoError:
        raise InputError(
            f"{file_name}: the part near {describe_places(points)} is no closed surface "
            f"({solid.status().name}); repair it in a mesh editor"
        )
    return solid


def _without_hollows(vertices: Float, faces: Int) -> tuple[Float, Int, int, int]:
    """Drop inward-looking shells; returns vertices, faces, how many shells stay and how many went."""
    label = connected_vertices(faces, len(vertices))
    count = int(label.max(initial=-1)) + 1
    shell = label[faces[:, 0]]
    a, b, c = (vertices[faces[:, k]] - vertices.mean(axis=0) for k in range(3))
    six_volumes = np.bincount(shell, np.einsum("ij,ij->i", a, np.cross(b, c)), minlength=count)
    kept = np.ascontiguousarray(faces[six_volumes[shell] > 0.0])
    used, local = np.unique(kept, return_inverse=True)
    stay = int(np.count_nonzero(six_volumes > 0.0))
    return (
        np.ascontiguousarray(vertices[used]),
        np.ascontiguousarray(local.reshape(-1, 3), dtype=np.int32),
        stay,
        count - stay,
    )
