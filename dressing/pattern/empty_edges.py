"""Edges without length in pattern files: left out where no seam needs them; seams keep their meaning."""

import math
from collections.abc import Mapping
from dataclasses import replace

from toile.dressing.pattern.pattern import Edge, Point
from toile.dressing.pattern.seam import EdgePart, Seam
from toile.geometry.errors import InputError

SHORTEST_EDGE = 1e-5
"""Edges shorter than this [m] are taken for mistakes."""

Numbers = tuple[int | None, ...]
"""What the edges of a panel, by their numbers in the file, are numbered now; None if left out."""


def same_place(a: Point, b: Point) -> bool:
    """Whether two corners [m] are one."""
    return math.dist(a, b) < SHORTEST_EDGE


def without_empty_edges(
    corners: list[Point], edges: list[Edge], where: str
) -> tuple[list[Edge], Numbers, tuple[str, ...]]:
    """Return the edges that have a length, the new numbers of all edges, and what was mended in words.

    Where an edge ends in the place in which the next one starts, both get the same corner. Raises InputError,
    beginning with `where`, if no edge has a length.
    """
    empty = [i for i, edge in enumerate(edges) if same_place(corners[edge.start], corners[edge.end])]
    if len(empty) == len(edges):
        raise InputError(f"{where} encloses no area: none of its edges has a length", field="edges")
    kept = [edge for i, edge in enumerate(edges) if i not in empty]
    count = iter(range(len(kept)))
    numbers = tuple(None if i in empty else next(count) for i in range(len(edges)))
    joined = False
    for i, edge in enumerate(kept):
        following = kept[(i + 1) % len(kept)]
        if following.start != edge.end and same_place(corners[edge.end], corners[following.start]):
            kept[(i + 1) % len(kept)] = replace(following, start=edge.end)
            joined = True
    if empty:
        listed = ", ".join(map(str, empty))
        word = f"edge {listed} is" if len(empty) == 1 else f"edges {listed} are"
        return kept, numbers, (f"{word} left out: no length",)
    return kept, numbers, ("corners in one place are joined",) if joined else ()


def new_number(numbers: Numbers, panel: str, edge: int, where: str) -> int:
    """Return what an edge is numbered now. Raises InputError, beginning with `where`, if it is left out."""
    number = numbers[edge]
    if number is None:
        raise InputError(
            f"{where} sews panel '{panel}', edge {edge}, which has no length; remove the edge and its seam, "
            "or move a vertex"
        )
    return number


def renumbered(seam: Seam, numbers: Mapping[str, Numbers], where: str) -> Seam:
    """Return a seam in the new numbers of edges. Raises InputError if one of them is left out."""

    def part_now(part: EdgePart) -> EdgePart:
        known = numbers.get(part.panel, ())
        # The check of seams names edges and panels that do not exist.
        if part.edge >= len(known):
            return part
        return replace(part, edge=new_number(known, part.panel, part.edge, where))

    return Seam(tuple(map(part_now, seam.a)), tuple(map(part_now, seam.b)))
