"""Seams between runs of edges as stitches between whole ones: both sides are split at corners.

Both runs are walked together. Where both have a corner within `SAME_PLACE`, or both have the same number of
notches, these places meet, and in between lengths are in proportion.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from toile.dressing.files.suggestion import unknown_name
from toile.dressing.pattern.pattern import Edge, Panel, Pattern, Stitch
from toile.dressing.pattern.pattern_curve import cut_curve, edge_length
from toile.dressing.pattern.seam import EdgePart, Seam
from toile.geometry.arrays import Float
from toile.geometry.errors import InputError

SAME_PLACE = 0.004
"""Corners of the two sides of a seam closer than this along it meet [m]."""
NOTCH_SHARE = 0.1
"""Notches of the two sides are no pair if they lie farther apart than this share of the seam."""
_SAME = 1e-7
"""Fractions of an edge closer than this are one."""

EdgeKey = tuple[str, int]


@dataclass(frozen=True)
class _Run:
    """One side of a seam: its parts, where each begins and the last ends [m], and its notches [m]."""

    parts: tuple[EdgePart, ...]
    bounds: Float
    notches: Float

    @property
    def length(self) -> float:
        return float(self.bounds[-1])

    def between(self, low: float, high: float) -> EdgePart:
        """Return the stretch between two lengths of the walk, which lie in one part."""
        middle = 0.5 * (low + high)
        index = int(np.clip(np.searchsorted(self.bounds, middle) - 1, 0, len(self.parts) - 1))
        part, (first, last) = self.parts[index], self.bounds[index : index + 2]
        start, end = (
            part.start + (part.end - part.start) * min(max((at - first) / (last - first), 0.0), 1.0)
            for at in (low, high)
        )
        return EdgePart(part.panel, part.edge, float(start), float(end))


def split_seams(pattern: Pattern, more_cuts: Mapping[EdgeKey, Sequence[float]] | None = None) -> Pattern:
    """Return the pattern with stitches between whole edges only; one without seams comes back as it is.

    `more_cuts` are fractions at which edges are cut besides, together with what is stitched to them.

    Raises
    ------
    InputError
        A seam names a panel or an edge that does not exist, or runs overlap.
    """
    if not pattern.seams and not more_cuts:
        return pattern
    panels = {panel.name: panel for panel in pattern.panels}
    seams = list(pattern.seams)
    stitched = [_as_seam(stitch) for stitch in pattern.stitches]
    for seam in seams:
        _check_edges(pattern.name, seam, panels)
    _check_overlap(pattern.name, [*stitched, *seams])
    cuts: dict[EdgeKey, list[float]] = {key: list(at) for key, at in (more_cuts or {}).items()}
    pairs = [pair for seam in [*stitched, *seams] for pair in _matched(seam, panels, more_cuts or {})]
    for pair in pairs:
        for part in pair:
            cuts.setdefault((part.panel, part.edge), []).extend((part.start, part.end))
    tidy = {key: _tidy(at) for key, at in cuts.items()}
    numbers = _edge_numbers(pattern, tidy)
    return replace(
        pattern,
        panels=tuple(_cut_panel(panel, tidy) for panel in pattern.panels),
        stitches=tuple(_stitch(a, b, tidy, numbers) for a, b in pairs),
        seams=(),
    )


def run_length(parts: Sequence[EdgePart], panels: Mapping[str, Panel]) -> float:
    """Return the length of a run [m]."""
    return sum(edge_length(panels[p.panel], p.edge) * abs(p.end - p.start) for p in parts)


def _as_seam(stitch: Stitch) -> Seam:
    b = EdgePart(stitch.panel_b, stitch.edge_b)
    return Seam((EdgePart(stitch.panel_a, stitch.edge_a),), (b if stitch.right_wrong else b.turned(),))


def _check_edges(name: str, seam: Seam, panels: Mapping[str, Panel]) -> None:
    for part in (*seam.a, *seam.b):
        if part.panel not in panels:
            raise InputError(
                f"{name}: seam '{seam.name}': {unknown_name('panel', part.panel, list(panels))}",
                field="seams",
            )
        count = len(panels[part.panel].edges)
        if not 0 <= part.edge < count:
            raise InputError(
                f"{name}: seam '{seam.name}': panel '{part.panel}' has no edge {part.edge}, "
                f"only 0..{count - 1}",
                field="seams",
            )


def _check_overlap(name: str, seams: Sequence[Seam]) -> None:
    """Raise InputError if two parts of all runs share a stretch of an edge."""
    taken: dict[EdgeKey, list[tuple[float, float, str]]] = {}
    for seam in seams:
        for part in (*seam.a, *seam.b):
            low, high = sorted((part.start, part.end))
            for other_low, other_high, other in taken.get((part.panel, part.edge), []):
                if min(high, other_high) - max(low, other_low) > _SAME:
                    raise InputError(
                        f"{name}: seams '{other}' and '{seam.name}' overlap on {part.panel}.{part.edge}; "
                        "sew every stretch of an edge once, or give parts such as "
                        f"{part.panel}.{part.edge}[0:0.5]",
                        field="seams",
                    )
            taken.setdefault((part.panel, part.edge), []).append((low, high, seam.name))


def _run(parts: tuple[EdgePart, ...], panels: Mapping[str, Panel]) -> _Run:
    bounds, notches = [0.0], []
    for part in parts:
        length = edge_length(panels[part.panel], part.edge)
        for notch in panels[part.panel].edges[part.edge].notches:
            if min(part.start, part.end) < notch < max(part.start, part.end):
                notches.append(bounds[-1] + length * abs(notch - part.start))
        bounds.append(bounds[-1] + length * abs(part.end - part.start))
    return _Run(parts, np.array(bounds), np.array(sorted(notches)))


def _matched(
    seam: Seam, panels: Mapping[str, Panel], more_cuts: Mapping[EdgeKey, Sequence[float]]
) -> list[tuple[EdgePart, EdgePart]]:
    """Return the stretches of both runs that meet, in order."""
    a, b = _run(seam.a, panels), _run(seam.b, panels)
    meet = _meeting_places(a, b)
    marks_a = np.concatenate([a.bounds, _cut_places(a, panels, more_cuts)])
    marks_b = np.concatenate([b.bounds, _cut_places(b, panels, more_cuts)])
    at_a, at_b = (np.array(side) for side in zip(*meet, strict=True))
    places = [(float(s), float(np.interp(s, at_a, at_b))) for s in marks_a]
    places += [(float(np.interp(s, at_b, at_a)), float(s)) for s in marks_b]
    least = _SAME * max(a.length, b.length)
    kept = list(meet)
    for place in sorted(places):
        if all(min(abs(place[0] - s), abs(place[1] - t)) > least for s, t in kept):
            kept.append(place)
    kept.sort()
    return [
        (a.between(s0, s1), b.between(t0, t1)) for (s0, t0), (s1, t1) in pairwise(kept) if s1 > s0 and t1 > t0
    ]


def _cut_places(
    run: _Run, panels: Mapping[str, Panel], more_cuts: Mapping[EdgeKey, Sequence[float]]
) -> list[float]:
    """Return where the edges of a run are cut besides, along its walk [m]."""
    return [
        float(first) + edge_length(panels[part.panel], part.edge) * abs(at - part.start)
        for part, first in zip(run.parts, run.bounds, strict=False)
        for at in more_cuts.get((part.panel, part.edge), ())
        if min(part.start, part.end) < at < max(part.start, part.end)
    ]


def _meeting_places(a: _Run, b: _Run) -> list[tuple[float, float]]:
    """Return pairs of lengths along the two walks that meet, rising in both: ends, corners and notches."""
    meet = [(0.0, 0.0), (a.length, b.length)]
    scale = b.length / a.length
    for s in a.bounds[1:-1]:
        inner = b.bounds[1:-1]
        if len(inner):
            t = inner[np.abs(inner - s * scale).argmin()]
            if abs(t - s * scale) < SAME_PLACE:
                meet.append((float(s), float(t)))
    if len(a.notches) == len(b.notches):
        for s, t in zip(a.notches.tolist(), b.notches.tolist(), strict=True):
            if abs(s / a.length - t / b.length) < NOTCH_SHARE:
                meet.append((s, t))
    meet.sort()
    kept = meet[:1]
    for place in meet[1:-1]:
        # Places closer than a corner's reach, or out of order, would ask for slivers.
        if all(here - before > SAME_PLACE for here, before in zip(place, kept[-1], strict=True)) and all(
            end - here > SAME_PLACE for end, here in zip(meet[-1], place, strict=True)
        ):
            kept.append(place)
    return [*kept, meet[-1]]


def _tidy(fractions: Sequence[float]) -> list[float]:
    """Return fractions strictly within an edge, rising, each once."""
    kept: list[float] = []
    for at in sorted(fractions):
        if _SAME < at < 1.0 - _SAME and (not kept or at - kept[-1] > _SAME):
            kept.append(at)
    return kept


def _edge_numbers(pattern: Pattern, cuts: Mapping[EdgeKey, list[float]]) -> dict[EdgeKey, int]:
    """Return the new number of the first piece of every edge."""
    numbers: dict[EdgeKey, int] = {}
    for panel in pattern.panels:
        number = 0
        for edge in range(len(panel.edges)):
            numbers[panel.name, edge] = number
            number += len(cuts.get((panel.name, edge), ())) + 1
    return numbers


def _cut_panel(panel: Panel, cuts: Mapping[EdgeKey, list[float]]) -> Panel:
    """Return the panel with its edges cut; new corners follow the old ones."""
    vertices, edges = list(panel.vertices), list[Edge]()
    for index, edge in enumerate(panel.edges):
        at = cuts.get((panel.name, index), [])
        if not at:
            edges.append(replace(edge, piece=(index, 0.0, 1.0)))
            continue
        start, bounds = edge.start, [0.0, *at, 1.0]
        for number, (curve, point) in enumerate(cut_curve(panel, index, at)):
            low, high = bounds[number : number + 2]
            end = edge.end
            if number < len(at):
                end = len(vertices)
                vertices.append(point)
            notches = tuple((n - low) / (high - low) for n in edge.notches if low + _SAME < n < high - _SAME)
            piece = (index, low, high)
            edges.append(replace(edge, start=start, end=end, curve=curve, notches=notches, piece=piece))
            start = end
    return replace(panel, vertices=tuple(vertices), edges=tuple(edges))


def _stitch(
    a: EdgePart, b: EdgePart, cuts: Mapping[EdgeKey, list[float]], numbers: Mapping[EdgeKey, int]
) -> Stitch:
    """Return the stitch of two stretches, each of which is now a whole edge."""
    edges = []
    for part in (a, b):
        key = part.panel, part.edge
        middle = 0.5 * (part.start + part.end)
        edges.append(numbers[key] + int(np.searchsorted(cuts.get(key, []), middle)))
    same_way = (a.start < a.end) == (b.start < b.end)
    return Stitch(a.panel, edges[0], b.panel, edges[1], right_wrong=same_way)
