"""Roles of panels and edges of a pattern, set by readers and drafts."""

from typing import Literal

PanelRole = Literal["torso", "sleeve", "leg"]
"""Part of the body that a panel covers; skirts are "leg", cuffs "sleeve"."""
EdgeRole = Literal["waist", "strapless_top", "collar", "armhole"]
"""What an edge lies on: the waist, the chest without straps above it, the neck, or the top of an arm."""
HANGS_FROM: tuple[EdgeRole, ...] = ("collar", "armhole")
"""Edges of garments that hang from the shoulders."""
SITS_ON: tuple[EdgeRole, ...] = ("waist", "strapless_top")
"""Edges by which other garments stay up, drawn tight."""
