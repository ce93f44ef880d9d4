"""Patterns drawn about another origin: moved to the body by the edges whose place on it is known."""

import numpy as np

from toile.dressing.body.dress_form import DressForm
from toile.dressing.pattern.pattern import Pattern
from toile.dressing.pattern.pattern_outline import edge_ends, to_world
from toile.dressing.pattern.roles import EdgeRole
from toile.geometry.arrays import Float
from toile.geometry.errors import InputError

TOO_FAR = 0.4
"""Distance from its place on the body from which the whole pattern is taken to have another origin [m]."""
LEVELS: dict[EdgeRole, tuple[str, float]] = {
    "collar": ("neck_height", 0.05),
    "armhole": ("shoulder_height", 0.0),
    "waist": ("waist_height", 0.03),
}
"""Role of an edge to the level of the body, and how far below it the edge's top starts, as in 57 GarmentCode
patterns with collars and waists (by 6 cm more or less) [m]; the first role that a pattern has counts."""


def moved_to_body(pattern: Pattern, form: DressForm) -> Pattern:
    """Return a pattern moved to its level and to the body's axis if farther off than TOO_FAR; say so."""
    body = form.measured
    found = {role: _on_edges(pattern, role) for role in LEVELS}
    role = next((role for role in LEVELS if len(found[role])), None)
    if role is None or isinstance(body, InputError):
        return pattern
    every = np.concatenate([to_world(panel, np.array(panel.vertices)) for panel in pattern.panels])
    low, high = form.avatar.vertices.min(axis=0), form.avatar.vertices.max(axis=0)
    level, below = LEVELS[role]
    top = float(low[1]) + getattr(body, level) - below
    # Patterns are as good as symmetric: their middle is the body's.
    shift = 0.5 * (low + high) - 0.5 * (every.min(axis=0) + every.max(axis=0))
    shift[1] = top - found[role][:, 1].max()
    shift[2] += 0.5 * sum(body.torso_depth) - 0.5 * (low[2] + high[2])
    shift[np.abs(shift) < TOO_FAR] = 0.0
    if not shift.any():
        return pattern
    said = ", ".join(
        f"{100.0 * abs(size):.0f} cm {words[int(size > 0.0)]}"
        for size, words in zip(shift, (("to -X", "to +X"), ("down", "up"), ("back", "forward")), strict=True)
        if size
    )
    note = f"The pattern lies about another origin (by its {role} edges) and is moved {said}."
    x, y, z = shift.tolist()
    return pattern.moved((x, y, z), note)


def _on_edges(pattern: Pattern, role: EdgeRole) -> Float:
    """Corners of edges of a role where the pattern places them [m], shape (k, 3)."""
    places = [
        edge_ends(panel, number)
        for panel in pattern.panels
        for number, edge in enumerate(panel.edges)
        if edge.role == role
    ]
    return np.concatenate(places) if places else np.empty((0, 3))
