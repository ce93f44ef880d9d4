"""Roles of panels and edges from the names and labels of GarmentCode."""

from toile.dressing.pattern.roles import EdgeRole, PanelRole

EDGE_ROLES: dict[str, EdgeRole] = {
    "lower_interface": "waist",
    "strapless_top": "strapless_top",
    "left_collar": "collar",
    "right_collar": "collar",
    "left_armhole": "armhole",
    "right_armhole": "armhole",
}
"""Label of an edge to its role."""
PANEL_ROLES: dict[str, PanelRole] = {"body": "torso", "arm": "sleeve", "leg": "leg"}
"""Label of a panel to its role; older patterns have no labels."""


def edge_role(label: str) -> EdgeRole | None:
    """Return the role of an edge of that label, None if it has none."""
    return EDGE_ROLES.get(label)


def panel_role(name: str, label: str) -> PanelRole | None:
    """Return the role of a panel by its label, or by its name: "left_sleeve_f", or "sl_left_cuff_f"."""
    if "sleeve" in name or name.startswith("sl_"):
        return "sleeve"
    return PANEL_ROLES.get(label)
