"""How garments fit, in colours, by geometry nodes that leave mesh and materials alone; nodes for users."""

from typing import Any, NamedTuple

import bpy

from toile.blender_addon.attribute_nodes import is_nodes
from toile.dressing.files.palette import linear
from toile.dressing.fit.colour_scale import STOPS, ColourScale
from toile.geometry.arrays import Float

NAME = "toile fit"
"""Name of the modifier, and of its node group."""
ASSET = "Toile Fit"
"""Name of the nodes that users may build on."""


class Map(NamedTuple):
    """A map as it is shown: its label, and the least value of the last colour."""

    label: str
    least: float


MAPS = {
    "pressure_Pa": Map("Pressure [Pa]", 100.0),
    "stretch_warp_percent": Map("Stretch Warp [%]", 1.0),
    "stretch_weft_percent": Map("Stretch Weft [%]", 1.0),
    "shear_percent": Map("Shear [%]", 1.0),
    "tension_N_m": Map("Tension [N/m]", 10.0),
    "ease_mm": Map("Gap to Body [mm]", 10.0),
}
"""Maps by the names of their attributes."""


def show_fit(obj: Any, shows_frames: Any, name: str, values: Float) -> float:
    """Colour an object by a map, behind the modifier that shows its frames.

    Colours go from 0 to a round number over nearly all `values`, as in fit.png; it is returned.
    """
    hide_fit(obj)
    top = ColourScale.of(values, MAPS[name].least).top
    modifiers = list(obj.modifiers)
    place = 1 + max(index for index, each in enumerate(modifiers) if each == shows_frames or is_nodes(each))
    modifier = obj.modifiers.new(NAME, "NODES")
    modifier.name, modifier.node_group = NAME, _painted(_material(name, top))
    obj.modifiers.move(len(obj.modifiers) - 1, place)
    return top


def hide_fit(obj: Any) -> None:
    """Show an object in its own materials again."""
    for modifier in [each for each in obj.modifiers if each.type == "NODES" and each.name == NAME]:
        group = modifier.node_group
        obj.modifiers.remove(modifier)
        if group is not None and not group.users:
            bpy.data.node_groups.remove(group)


def cloth_nodes() -> Any:
    """Return nodes that read the cloth of an object, and its maps as fields; an asset of this file."""
    found = bpy.data.node_groups.get(ASSET)
    if found is not None:
        return found
    group = bpy.data.node_groups.new(ASSET, "GeometryNodeTree")
    group.interface.new_socket("Garment", in_out="INPUT", socket_type="NodeSocketObject")
    group.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    for each in MAPS.values():
        group.interface.new_socket(each.label, in_out="OUTPUT", socket_type="NodeSocketFloat")
    nodes, links = group.nodes, group.links
    given, made = nodes.new("NodeGroupInput"), nodes.new("NodeGroupOutput")
    info = nodes.new("GeometryNodeObjectInfo")
    info.transform_space = "RELATIVE"
    links.new(given.outputs[0], info.inputs["Object"])
    links.new(info.outputs["Geometry"], made.inputs[0])
    for name, each in MAPS.items():
        field = nodes.new("GeometryNodeInputNamedAttribute")
        field.data_type = "FLOAT"
        field.inputs["Name"].default_value = name
        links.new(field.outputs["Attribute"], made.inputs[each.label])
    group.asset_mark()
    group.asset_data.description = "The cloth that toile simulated, and how it fits"
    return group


def _painted(material: Any) -> Any:
    """Return nodes that give everything one material."""
    group = bpy.data.node_groups.new(NAME, "GeometryNodeTree")
    for way in ("INPUT", "OUTPUT"):
        group.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
    paint = group.nodes.new("GeometryNodeSetMaterial")
    paint.inputs["Material"].default_value = material
    group.links.new(group.nodes.new("NodeGroupInput").outputs[0], paint.inputs["Geometry"])
    group.links.new(paint.outputs[0], group.nodes.new("NodeGroupOutput").inputs[0])
    return group


def _material(name: str, top: float) -> Any:
    """Return the material that shows a map up to a value, the same for all objects."""
    found = bpy.data.materials.get(f"{NAME} {name}")
    if found is not None:
        share = next(node for node in found.node_tree.nodes if node.type == "MAP_RANGE")
        share.inputs["From Max"].default_value = top
        return found
    material = bpy.data.materials.new(f"{NAME} {name}")
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    read, share = nodes.new("ShaderNodeAttribute"), nodes.new("ShaderNodeMapRange")
    read.attribute_name = name
    share.inputs["From Max"].default_value = top
    ramp = nodes.new("ShaderNodeValToRGB")
    elements = ramp.color_ramp.elements
    while len(elements) < len(STOPS):
        elements.new(0.5)
    for index, (element, colour) in enumerate(zip(elements, STOPS, strict=True)):
        element.position = index / (len(STOPS) - 1)
        element.color = (*linear(colour), 1.0)
    surface = next(node for node in nodes if node.type == "BSDF_PRINCIPLED")
    surface.inputs["Roughness"].default_value = 0.9
    links.new(read.outputs["Fac"], share.inputs["Value"])
    links.new(share.outputs["Result"], ramp.inputs["Fac"])
    links.new(ramp.outputs["Color"], surface.inputs["Base Color"])
    return material
