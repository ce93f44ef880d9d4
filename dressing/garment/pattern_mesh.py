"""From a sewing pattern to a triangulated garment with open seams."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TypeVar

import numpy as np

from toile.dressing.garment.fields.cut_mesh import Level, cut_along
from toile.dressing.garment.folded_panel import FoldedMesh, fold_cuts, folded_mesh, joined_cuts
from toile.dressing.garment.garment_mesh import Border, GarmentMesh
from toile.dressing.pattern.pattern import Edge, Panel, Pattern
from toile.dressing.pattern.pattern_curve import edge_length as length_of
from toile.dressing.pattern.pattern_curve import sagitta
from toile.dressing.pattern.pattern_outline import crossing_sides, outline, signed_area, to_world
from toile.dressing.pattern.split_seams import EdgeKey, split_seams
from toile.engine.cloth.folds import FoldLine, Folds
from toile.geometry.arrays import Float, Int
from toile.geometry.errors import InputError
from toile.remesh.panel.panel_mesh import triangulate_panel

Segments = dict[str, list[int]]
"""Segments per edge of each panel; 0 where an edge shrinks to one vertex."""
Key = TypeVar("Key", bound=str)
"""Label or role of an edge."""

NEGLIGIBLE = 0.2
"""Edges shorter than this part of the edge length shrink to one vertex, unless sewn to a longer one.

A side of half a millimetre among sides of ten would ask for a nest of tiny triangles.
"""
ROUND = 0.00025
"""How far a curved edge may lie from the straight sides that stand for it without shorter ones [m]."""


def mesh_pattern(
    pattern: Pattern,
    *,
    edge_length: float,
    curve_edge_length: float | None = None,
    cuts: Mapping[EdgeKey, Sequence[float]] | None = None,
    lines: Mapping[str, Sequence[Level]] | None = None,
) -> GarmentMesh:
    """Triangulate every panel at about `edge_length` [m], place it, and match vertices along the stitches.

    Curved edges may have shorter sides, down to `curve_edge_length` [m]: an adaptive mesh splits its border,
    but never rounds it. `cuts` are fractions at which edges get a corner, together with what is sewn to
    them; panels are cut into regions along `lines`, by the panel's name, in its own coordinates.

    Raises
    ------
    InputError
        `edge_length` is not positive, or an outline crosses itself (the panel and its edges are named).
    """
    if not (math.isfinite(edge_length) and edge_length > 0.0):
        raise InputError(
            f"edge_length must be a positive number of metres, got {edge_length}", field="edge_length"
        )
    cuts = joined_cuts(cuts, fold_cuts(pattern))
    pattern = split_seams(pattern, cuts)
    segments = matched_segments(
        pattern, edge_length, curve_edge_length or edge_length, keep_pieces=cuts is not None
    )
    positions, uv, faces, panel_of, rest, first, parts = [], [], [], [], [], {}, list[Folds | None]()
    count = 0
    for index, panel in enumerate(pattern.panels):
        border, clockwise = _border(pattern.name, panel, segments[panel.name])
        # Seen from the right side of the fabric every loop runs counter-clockwise.
        mirror = np.array([-1.0 if clockwise else 1.0, 1.0])
        mesh = _filled(pattern.name, panel, border * mirror, edge_length, mirror)
        parts.append(_folds(panel, mesh, mirror))
        if lines is not None and lines.get(panel.name):
            mesh = _cut(pattern.name, panel, mesh, len(border), lines[panel.name], mirror)
        flat = mesh[0] * mirror
        first[panel.name] = count
        positions.append(to_world(panel, flat))
        uv.append(flat)
        faces.append(mesh[1] + count)
        panel_of.append(np.full(len(mesh[1]), index, dtype=np.int32))
        rest.append(in_warp_frame(mesh[0], panel.warp_degrees * mirror[0])[mesh[1]])
        count += len(flat)
    all_faces = np.ascontiguousarray(np.concatenate(faces), dtype=np.int32)
    rest_corners = np.ascontiguousarray(np.concatenate(rest))
    stitches, seam = stitch_pairs(pattern, segments, first)
    return GarmentMesh(
        name=pattern.name,
        positions=np.ascontiguousarray(np.concatenate(positions)),
        uv=np.ascontiguousarray(np.concatenate(uv)),
        faces=all_faces,
        panel=np.concatenate(panel_of),
        panel_names=tuple(panel.name for panel in pattern.panels),
        panel_roles=tuple(panel.role for panel in pattern.panels),
        rest_corners=rest_corners,
        stitches=stitches,
        seam=seam,
        seam_names=tuple(stitch.name for stitch in pattern.stitches),
        held=vertices_on(pattern, segments, first, lambda edge: edge.label),
        edges=vertices_on(pattern, segments, first, lambda edge: edge.role),
        minimum_angle=float(np.degrees(corner_angles(rest_corners).min())),
        folds=Folds.together(parts, [len(some) for some in faces]),
        borders=tuple(_borders(pattern, segments, first)),
    )


def _cut(
    pattern: str, panel: Panel, mesh: FoldedMesh, border: int, lines: Sequence[Level], mirror: Float
) -> FoldedMesh:
    """Return the mesh of a panel cut along lines in its own coordinates, the `mirror` of these."""
    if panel.folds:
        raise InputError(
            f"{pattern}: panel '{panel.name}' has folds, and fields with a border within it; give it "
            "fields of the whole panel only",
            field=f"pattern.panels.{panel.name}",
        )

    def seen(line: Level) -> Level:
        return lambda points: line(points * mirror)

    vertices, faces = mesh.vertices, mesh.faces
    for line in lines:
        vertices, faces = cut_along(vertices, faces, np.arange(len(vertices)) < border, seen(line))
    return FoldedMesh(vertices, faces, np.zeros(len(faces), np.int32), ())


def _borders(pattern: Pattern, segments: Segments, first: dict[str, int]) -> Iterator[Border]:
    """Yield the edges of all panels, by their numbers before they were cut."""
    for panel in pattern.panels:
        for number, edge in enumerate(panel.edges):
            piece = edge.piece or (number, 0.0, 1.0)
            vertices = edge_vertices(segments, first, panel.name, number)
            yield Border(panel.name, *piece, edge.label, edge.role, vertices)


def matched_segments(
    pattern: Pattern, edge_length: float, curve_edge_length: float, keep_pieces: bool = False
) -> Segments:
    """Segments per edge: as many as the lengths ask for; on both sides of a stitch those of the longer.

    With `keep_pieces` no piece of an edge that was cut shrinks to a vertex, however short it is.
    """
    segments = {
        panel.name: _wanted_segments(panel, edge_length, curve_edge_length, keep_pieces)
        for panel in pattern.panels
    }
    for stitch in pattern.stitches:
        most = max(segments[stitch.panel_a][stitch.edge_a], segments[stitch.panel_b][stitch.edge_b])
        segments[stitch.panel_a][stitch.edge_a] = most
        segments[stitch.panel_b][stitch.edge_b] = most
    return segments


def _wanted_segments(
    panel: Panel, edge_length: float, curve_edge_length: float, keep_pieces: bool
) -> list[int]:
    counts = [_sides(panel, i, edge_length, curve_edge_length) for i in range(len(panel.edges))]
    if keep_pieces:
        cut = [edge.piece is not None and edge.piece[1:] != (0.0, 1.0) for edge in panel.edges]
        counts = [max(count, piece) for count, piece in zip(counts, cut, strict=True)]
    return counts if sum(counts) >= 4 else [max(1, count) for count in counts]


def _sides(panel: Panel, edge: int, edge_length: float, curve_edge_length: float) -> int:
    """Segments of one edge by its own length and roundness; 0 where it shrinks to one vertex."""
    length = length_of(panel, edge)
    if length / edge_length < NEGLIGIBLE:
        return 0
    # The slack keeps two edges that differ by rounding from getting different numbers.
    count, most = (max(1, math.ceil(length / side - 1e-6)) for side in (edge_length, curve_edge_length))
    while count < most and sagitta(panel, edge, count) > ROUND:
        count += 1
    return count


def stitch_pairs(pattern: Pattern, segments: Segments, first: dict[str, int]) -> tuple[Int, Int]:
    """Vertex pairs to be sewn, shape (s, 2), and the stitch each belongs to, shape (s,).

    A corner that would be sewn to itself (dart tip) and pairs that an earlier stitch has made are left out.
    """
    pairs, seams = [], []
    seen: set[tuple[int, int]] = set()
    for number, stitch in enumerate(pattern.stitches):
        side_a = edge_vertices(segments, first, stitch.panel_a, stitch.edge_a)
        side_b = edge_vertices(segments, first, stitch.panel_b, stitch.edge_b)
        if not stitch.right_wrong:
            side_b = side_b[::-1]
        for a, b in zip(side_a.tolist(), side_b.tolist(), strict=True):
            key = (min(a, b), max(a, b))
            if a != b and key not in seen:
                seen.add(key)
                pairs.append((a, b))
                seams.append(number)
    return np.array(pairs, dtype=np.int32).reshape(-1, 2), np.array(seams, dtype=np.int32)


def edge_vertices(segments: Segments, first: dict[str, int], panel: str, edge: int) -> Int:
    """Vertices along one edge from its start to its end, shape (segments + 1,)."""
    counts = segments[panel]
    start = sum(counts[:edge])
    return ((start + np.arange(counts[edge] + 1)) % sum(counts) + first[panel]).astype(np.int32)


def vertices_on(
    pattern: Pattern, segments: Segments, first: dict[str, int], key_of: Callable[[Edge], Key | None]
) -> dict[Key, Int]:
    """Label or role of edges, as `key_of` an edge returns, to the sorted vertices on such edges."""
    found: dict[Key, list[Int]] = {}
    for panel in pattern.panels:
        for number, edge in enumerate(panel.edges):
            if key := key_of(edge):
                found.setdefault(key, []).append(edge_vertices(segments, first, panel.name, number))
    return {key: np.unique(np.concatenate(vertices)) for key, vertices in found.items()}


def in_warp_frame(points: Float, warp_degrees: float) -> Float:
    """Coordinates along (warp, weft) [m], shape (n, 2), of points seen from the right side of the fabric.

    The warp lies `warp_degrees` counter-clockwise from +y, the weft a quarter turn further, so that triangles
    keep their sense.
    """
    angle = math.radians(warp_degrees)
    warp = np.array([-math.sin(angle), math.cos(angle)])
    weft = np.array([-math.cos(angle), -math.sin(angle)])
    return np.ascontiguousarray(np.column_stack([points @ warp, points @ weft]))


def corner_angles(triangles: Float) -> Float:
    """Angles [rad] at the corners of plane triangles, shape (t, 3, 2) to (t, 3)."""
    ahead = np.roll(triangles, -1, axis=1) - triangles
    back = np.roll(triangles, 1, axis=1) - triangles
    cross = ahead[..., 0] * back[..., 1] - ahead[..., 1] * back[..., 0]
    return np.asarray(np.arctan2(cross, np.einsum("tij,tij->ti", ahead, back)))


def _border(pattern: str, panel: Panel, segments: list[int]) -> tuple[Float, bool]:
    """Border points [m] in the order of the loop, and whether they run clockwise."""
    polygon, owner = outline(panel, segments)
    crossing = crossing_sides(polygon) if len(polygon) > 2 else (0, 1)
    if crossing is not None:
        a, b = (int(owner[side]) for side in crossing)
        raise InputError(
            f"{pattern}: panel '{panel.name}' crosses itself at edges {a} and {b} when cut into segments; "
            "use a smaller edge length",
            field=f"pattern.panels.{panel.name}",
        )
    return polygon, signed_area(polygon) < 0.0


def _filled(pattern: str, panel: Panel, border: Float, edge_length: float, mirror: Float) -> FoldedMesh:
    """Vertices and faces inside a border; the border's vertices come first, in the order of the loop."""
    try:
        if panel.folds:
            folds = {f"fold {n}": np.array(fold.points) * mirror for n, fold in enumerate(panel.folds)}
            return folded_mesh(border, folds, edge_length)
        mesh = triangulate_panel(border, edge_length=edge_length)
    except ValueError as error:
        raise InputError(
            f"{pattern}: panel '{panel.name}': {error}", field=f"pattern.panels.{panel.name}"
        ) from None
    return FoldedMesh(mesh.vertices, mesh.faces, np.zeros(len(mesh.faces), np.int32), ())


def _folds(panel: Panel, mesh: FoldedMesh, mirror: Float) -> Folds | None:
    """Return the folds of a panel in its own coordinates, None if it has none."""
    if not panel.folds:
        return None
    parts = tuple(range(int(mesh.part.max()) + 1))
    lines = tuple(
        FoldLine(
            line * mirror,
            math.radians(fold.degrees),
            math.nan if fold.stiffness is None else fold.stiffness,
            parts,
        )
        for fold, line in zip(panel.folds, mesh.lines, strict=True)
    )
    return Folds(part=mesh.part, lines=lines)
