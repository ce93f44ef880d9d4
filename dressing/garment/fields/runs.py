"""Runs of edges by their names: a role, a label, or panels and numbers of edges."""

from collections.abc import Iterator, Sequence

import numpy as np

from toile.dressing.files.suggestion import unknown_name
from toile.dressing.garment.garment_mesh import Border, GarmentMesh
from toile.dressing.pattern.pattern import Panel, Pattern
from toile.dressing.pattern.seam import EdgePart, read_run
from toile.engine.cloth.fields.edge_runs import border_sides
from toile.geometry.arrays import Int
from toile.geometry.errors import InputError

_SLACK = 1e-6
"""Fractions of an edge closer than this are one."""


def run_parts(run: str, pattern: Pattern) -> tuple[EdgePart, ...]:
    """Return the stretches of edges that a run names. Raises InputError if there is none of that name."""
    named = tuple(_of_name(run, pattern.panels))
    if named:
        return named
    if "." not in run:
        raise InputError(
            f"run: {unknown_name('edge', run, _names(pattern))}; or write PANEL.NUMBER", field="run"
        )
    parts = read_run(run, "run")
    names = [panel.name for panel in pattern.panels]
    for part in parts:
        if part.panel not in names:
            raise InputError(f"run '{run}': {unknown_name('panel', part.panel, names)}", field="run")
        count = len(pattern.panel(part.panel).edges)
        if part.edge >= count:
            raise InputError(
                f"run '{run}': panel '{part.panel}' has no edge {part.edge}, only 0..{count - 1}", field="run"
            )
    return parts


def _of_name(run: str, panels: Sequence[Panel]) -> Iterator[EdgePart]:
    for panel in panels:
        for number, edge in enumerate(panel.edges):
            if run and run in (edge.label, edge.role):
                yield EdgePart(panel.name, number)


def _names(pattern: Pattern) -> list[str]:
    names = {
        name for panel in pattern.panels for edge in panel.edges for name in (edge.label, edge.role) if name
    }
    return sorted(names) or ["none that has a name in this garment"]


def run_sides(run: str, mesh: GarmentMesh) -> dict[int, Int]:
    """Return the sides of faces that lie on a run, as vertex pairs (k, 2), by the number of their panel.

    Of a garment that came as a mesh a run is a label: sides on its border between vertices that have it.
    Raises InputError if there is none of that name.
    """
    if not mesh.borders:
        return _labelled_sides(run, mesh)
    named = called_borders(run, mesh)
    if not named:
        if "." not in run:
            known = border_names(mesh)
            raise InputError(f"run: {unknown_name('edge', run, known)}; or write PANEL.NUMBER", field="run")
        named = [b for part in read_run(run, "run") for b in mesh.borders if is_within(b, part)]
        if not named:
            raise InputError(f"run '{run}': there is no such edge; see toile pattern FILE", field="run")
    found: dict[int, list[Int]] = {}
    for border in named:
        number = mesh.panel_names.index(border.panel)
        sides = np.stack([border.vertices[:-1], border.vertices[1:]], axis=1)
        found.setdefault(number, []).append(sides)
    return {number: np.concatenate(sides) for number, sides in found.items()}


def _labelled_sides(run: str, mesh: GarmentMesh) -> dict[int, Int]:
    labels: dict[str, Int] = {str(role): own for role, own in mesh.edges.items()} | mesh.held
    if run not in labels:
        known = sorted(labels) or ["none in this garment; an .npz garment has them as held_LABEL"]
        raise InputError(f"run: {unknown_name('edge', run, known)}", field="run")
    marked = np.zeros(len(mesh.positions), bool)
    marked[labels[run]] = True
    sides, face = border_sides(mesh.faces)
    panel, on = mesh.panel[face], marked[sides].all(axis=1)
    if not on.any():
        raise InputError(
            f"run '{run}': no border of the mesh lies between vertices of that label", field="run"
        )
    return {number: sides[on & (panel == number)] for number in np.unique(panel[on]).tolist()}


def called_borders(run: str, mesh: GarmentMesh) -> list[Border]:
    """Return the pieces of border that have a role or label."""
    return [border for border in mesh.borders if run in (border.label, border.role)]


def border_names(mesh: GarmentMesh) -> list[str]:
    """Return the roles and labels of a mesh's border, sorted."""
    return sorted({name for border in mesh.borders for name in (border.label, border.role) if name})


def is_within(border: Border, part: EdgePart) -> bool:
    """Whether a piece of border lies on a stretch of an edge."""
    low, high = sorted((part.start, part.end))
    return (border.panel, border.edge) == (part.panel, part.edge) and (
        low - _SLACK <= border.start and border.end <= high + _SLACK
    )
