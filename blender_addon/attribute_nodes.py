"""Geometry nodes behind toile's modifier that put back attributes which travel under other names."""

from typing import Any

import bpy

from toile.blender_addon.snapshot.carriers import ALPHA

NAME = "toile attributes"
"""Name of the modifier, and of its node groups."""


def put_back(obj: Any, behind: Any, carriers: list[list[str]]) -> None:
    """Let an object have its own attributes behind a modifier; `carriers` is from `snapshot.carriers`."""
    remove_nodes(obj)
    if not carriers:
        return
    place = list(obj.modifiers).index(behind) + 1
    modifier = obj.modifiers.new(NAME, "NODES")
    modifier.name, modifier.node_group = NAME, _group(carriers)
    obj.modifiers.move(len(obj.modifiers) - 1, place)


def is_nodes(modifier: Any) -> bool:
    """Whether a modifier puts attributes back."""
    return bool(modifier.type == "NODES" and modifier.name == NAME)


def remove_nodes(obj: Any) -> None:
    """Remove the modifier, and its nodes if nobody else uses them."""
    for modifier in [modifier for modifier in obj.modifiers if is_nodes(modifier)]:
        group = modifier.node_group
        obj.modifiers.remove(modifier)
        if group is not None and not group.users:
            bpy.data.node_groups.remove(group)


def _group(carriers: list[list[str]]) -> Any:
    """Return nodes that store every attribute under its own name, as its own type."""
    group = bpy.data.node_groups.new(NAME, "GeometryNodeTree")
    for way in ("INPUT", "OUTPUT"):
        group.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
    nodes, links = group.nodes, group.links
    last = nodes.new("NodeGroupInput").outputs[0]
    for name, kind, domain, own_name, own_kind in carriers:
        names = [name, name + ALPHA] if own_kind.endswith("COLOR") else [name]
        value = _read(group, name, kind)
        if len(names) > 1:
            colour, parts = nodes.new("FunctionNodeCombineColor"), nodes.new("ShaderNodeSeparateXYZ")
            links.new(value, parts.inputs[0])
            for part in range(3):
                links.new(parts.outputs[part], colour.inputs[part])
            links.new(_read(group, names[1], "FLOAT"), colour.inputs["Alpha"])
            value = colour.outputs[0]
        store = nodes.new("GeometryNodeStoreNamedAttribute")
        store.data_type, store.domain = own_kind, domain
        store.inputs["Name"].default_value = own_name
        links.new(value, _enabled(store.inputs, "Value"))
        links.new(last, store.inputs["Geometry"])
        last = store.outputs["Geometry"]
        for done in names:
            remove = nodes.new("GeometryNodeRemoveAttribute")
            remove.inputs["Name"].default_value = done
            links.new(last, remove.inputs["Geometry"])
            last = remove.outputs["Geometry"]
    links.new(last, nodes.new("NodeGroupOutput").inputs[0])
    return group


def _read(group: Any, name: str, kind: str) -> Any:
    """Return the values of an attribute, as the output of a new node."""
    node = group.nodes.new("GeometryNodeInputNamedAttribute")
    node.data_type = kind
    node.inputs["Name"].default_value = name
    return _enabled(node.outputs, "Attribute")


def _enabled(sockets: Any, name: str) -> Any:
    """Return the socket of that name for the type that the node has."""
    return next(socket for socket in sockets if socket.name == name and socket.enabled)
