"""Properties that a .blend file stores: roles of objects, fabrics, settings of a scene."""

from typing import Any

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)  # fmt: skip

from toile.dressing.garment.fabrics import DEFAULT_FABRIC, fabrics
from toile.dressing.pattern.drafts import built_in_names

FABRICS = fabrics()
OWN_VALUES = {
    "areal_density": ("Weight", "Mass per area [kg/m²]", 0.001, 5.0),
    "stretch_warp": ("Stretch Warp", "Stiffness along the warp [N/m]", 1.0, 1e5),
    "stretch_weft": ("Stretch Weft", "Stiffness along the weft [N/m]", 1.0, 1e5),
    "shear": ("Shear", "Shear stiffness [N/m]", 0.0, 1e5),
    "bending_warp": ("Bending Warp", "Rigidity when bent along the warp [µN·m]", 0.0, 1e4),
    "bending_weft": ("Bending Weft", "Rigidity when bent along the weft [µN·m]", 0.0, 1e4),
    "bending_bias": ("Bending Bias", "Rigidity when bent along the diagonal [µN·m]", 0.0, 1e4),
    "friction_body": ("Friction on Body", "Coulomb coefficient against the avatar", 0.0, 2.0),
    "friction_self": ("Friction on Cloth", "Coulomb coefficient against cloth", 0.0, 2.0),
}
"""Values of a fabric that an object may have of its own: label, meaning, limits."""


NOT_DRAFTED = -1_000_000
"""Draft frame of garments whose panels were not drafted."""


def shown(name: str, value: float) -> float:
    """Value of a fabric [SI] as the panel shows it: bending in micronewton metres."""
    return value * 1e6 if name.startswith("bending") else value


def _on_fabric(self: Any, context: Any) -> None:
    """Take over the values of a preset that was chosen."""
    for name in OWN_VALUES:
        setattr(self, name, shown(name, getattr(FABRICS[self.fabric], name)))


def _overridable(properties: dict[str, Any]) -> dict[str, Any]:
    """Return properties that library overrides may change."""
    return {
        name: made.function(**made.keywords, override={"LIBRARY_OVERRIDABLE"})
        for name, made in properties.items()
    }


def _is_mesh(self: Any, obj: Any) -> bool:
    """Whether an object can be a body."""
    return bool(obj.type == "MESH")


QUANTITIES = (*OWN_VALUES, "thickness", "damping", "rest_warp", "rest_weft", "pressure", "pull")
"""What a field of an object may set."""


class TOILE_PG_field(bpy.types.PropertyGroup):
    """A value of the fabric that is painted, or that changes with the animation."""

    __annotations__ = _overridable({
        "quantity": EnumProperty(
            name="Quantity", default="stretch_warp",
            items=[(name, name.replace("_", " ").capitalize(), "") for name in QUANTITIES],
        ),
        "source": StringProperty(
            name="Painted By",
            description="Vertex group, or attribute of points, from 0 to 1; empty: the same everywhere",
        ),
        "low": FloatProperty(name="At 0", description="Value where it is painted 0", precision=4),
        "high": FloatProperty(
            name="At 1", default=1.0, precision=4,
            description="Value where it is painted 1, or everywhere; keyframes count if nothing is painted",
        ),
    })  # fmt: skip


class TOILE_PG_object(bpy.types.PropertyGroup):
    """The role of an object, and its settings as a garment."""

    __annotations__ = _overridable({
        "role": EnumProperty(
            name="Role", default="NONE",
            items=[
                ("NONE", "None", "Takes no part"),
                ("AVATAR", "Avatar", "A body that garments are put on; it moves as it is animated"),
                ("GARMENT", "Garment", "Cloth: modifiers above toile's feed it, those below refine it"),
                ("OBSTACLE", "Obstacle", "A solid that cloth meets and nobody wears; it may move and deform"),
            ],
        ),
        "fabric": EnumProperty(
            name="Fabric", default=DEFAULT_FABRIC, update=_on_fabric,
            items=[(name, name.replace("-", " ").capitalize(), "") for name in FABRICS],
        ),
        "use_own_values": BoolProperty(name="Own Values", description="Change values of the fabric"),
        **{
            name: FloatProperty(
                name=label, description=text, min=low, max=high, precision=3,
                default=shown(name, getattr(FABRICS[DEFAULT_FABRIC], name)),
            )
            for name, (label, text, low, high) in OWN_VALUES.items()
        },
        "thickness": FloatProperty(
            name="Thickness", description="Distance that layers keep; 0 is the fabric's own", min=0.0,
            max=0.02, subtype="DISTANCE", precision=4, step=0.01,
        ),
        "friction": FloatProperty(
            name="Friction", default=0.3, min=0.0, max=2.0, precision=3,
            description="Coulomb coefficient of all cloth on this obstacle",
        ),
        "use_friction": BoolProperty(
            name="Own Friction", description="Its own friction; else cloth has what it has on the body"
        ),
        "warp_map": StringProperty(name="Warp", description="UV map whose V axis is the warp"),
        "pin_group": StringProperty(
            name="Pins", description="Weight 1 goes where the modifiers above take it, less is drawn there"
        ),
        "pin_stiffness": FloatProperty(
            name="Pin Stiffness", default=1000.0, min=0.0, max=1e6, soft_max=1e5, precision=0, step=1000,
            description="Pressure per distance of pins that give way, times their weight [N/m³]",
        ),
        "use_sewing": BoolProperty(
            name="Sew Loose Edges", default=True, description="Loose edges are stitches: they draw shut"
        ),
        "layer": IntProperty(name="Layer", description="From the body outwards", min=0, max=50),
        "keep_topology": BoolProperty(
            name="Keep My Topology", description="Show the original vertices on the simulated surface"
        ),
        "body": PointerProperty(
            type=bpy.types.Object, name="Body", poll=_is_mesh,
            description="The avatar that it belongs to; it is dressed apart from other characters then",
        ),
        "pattern": StringProperty(name="Pattern", description="What it was drafted of"),
        "draft_key": StringProperty(name="Draft", description="What its draft depends on"),
        "fields": CollectionProperty(type=TOILE_PG_field, name="Fields"),
        "state": StringProperty(name="State"),
        "notes": StringProperty(name="Notes", description="What was said in the last run, line by line"),
        "draft_frame": IntProperty(
            name="Draft Frame", default=NOT_DRAFTED, description="Frame in which the panels fit the avatar"
        ),
    })  # fmt: skip


class TOILE_PG_scene(bpy.types.PropertyGroup):
    """Settings of a scene."""

    __annotations__ = _overridable({
        "mode": EnumProperty(
            name="Result", default="DRAPE",
            items=[
                ("DRAPE", "Drape", "Garments at rest on the body as it is in this frame"),
                ("SIMULATE", "Simulate", "At rest in the first frame, then they follow the body"),
            ],
        ),
        "frame_start": IntProperty(name="Start", default=1, description="First frame of a simulation"),
        "frame_end": IntProperty(name="End", default=50, description="Last frame of a simulation"),
        "quality": EnumProperty(
            name="Quality", default="standard",
            items=[(name, name.capitalize(), "") for name in ("preview", "standard", "accurate")],
        ),
        "threads": IntProperty(
            name="Threads", default=2, min=1, max=64,
            description="Threads that share the work; the result is the same with any number",
        ),
        "use_fit": BoolProperty(
            name="Fit Maps",
            description="Attributes of stretch in all frames; of pressure, tension and gap in the last one",
        ),
        "use_remesh": BoolProperty(
            name="Adaptive Mesh", default=True, description="Fine where cloth folds, coarse where it is flat"
        ),
        "size_min": FloatProperty(
            name="Finest", description="Shortest edges; 0 is the quality's", min=0.0, max=1.0,
            subtype="DISTANCE", precision=4, step=0.1,
        ),
        "size_max": FloatProperty(
            name="Coarsest", description="Longest edges; 0 is twenty times the shortest", min=0.0, max=5.0,
            subtype="DISTANCE", precision=3, step=1,
        ),
        "pattern": EnumProperty(
            name="Pattern", default="tshirt",
            items=[(name, name.replace("_", " ").capitalize(), "") for name in built_in_names()],
        ),
    })  # fmt: skip
