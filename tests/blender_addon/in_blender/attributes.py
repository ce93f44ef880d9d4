"""A sheet with every type of attribute in every domain under many names; what the shown mesh has of them."""

import json
import sys
from pathlib import Path

import bpy
import numpy as np
import small_scene as small

import toile.blender_addon

folder = Path(sys.argv[1])
small.empty_file(folder)
small.body()
bpy.ops.mesh.primitive_grid_add(size=0.8, x_subdivisions=8, y_subdivisions=8, location=(0.0, 0.0, 1.262))
sheet = bpy.context.object
sheet.name, sheet.toile.role = "Sheet", "GARMENT"
mesh = sheet.data
KINDS = {
    "FLOAT": ("value", 1), "INT": ("value", 1), "BOOLEAN": ("value", 1), "FLOAT_VECTOR": ("vector", 3),
    "FLOAT2": ("vector", 2), "FLOAT_COLOR": ("color", 4), "BYTE_COLOR": ("color", 4), "INT8": ("value", 1),
    "QUATERNION": ("value", 4),
}  # fmt: skip
WHOLE = ("INT", "BOOLEAN", "INT8")
NAMES = ("plain", "with space", "a.b-c", "Tüll 1", "1st")
SINGLE = ("st", "displayColor", "normals", "displayOpacity", "Cd", "toile_0")
here = np.array([vertex.co for vertex in mesh.vertices]) / 0.8 + 0.5
corner = here[[loop.vertex_index for loop in mesh.loops]]
face = np.array([polygon.center for polygon in mesh.polygons]) / 0.8 + 0.5
PLACES = {"POINT": here, "CORNER": corner, "FACE": face}


def wanted(kind: str, places: np.ndarray, salt: float) -> np.ndarray:
    """Values that depend on the place on the sheet: linear, or steps of a constant value per sheet."""
    if kind in WHOLE:
        return np.full(len(places), 1 + int(salt * 100) % (1 if kind == "BOOLEAN" else 90))
    rows = [salt * places[:, 0], salt * places[:, 1], 0.5 * places[:, 0] + 0.25, np.ones(len(places))]
    if kind == "QUATERNION":
        return np.tile([0.5, 0.1, -0.5, salt], (len(places), 1)) / np.linalg.norm([0.5, 0.1, -0.5, salt])
    width = KINDS[kind][1]
    return np.column_stack(rows[:width]) if width > 1 else rows[0]


made: dict[str, tuple[str, str, float]] = {}
for domain, places in PLACES.items():
    for kind, (field, _) in KINDS.items():
        names = [f"{name} {domain} {kind}" if " " in name else f"{name}_{domain}_{kind}" for name in NAMES]
        names += SINGLE if (domain, kind) == ("POINT", "FLOAT") else ()
        for name in names:
            salt = 0.1 + 0.8 * ((len(made) * 37) % 100) / 100
            attribute = mesh.attributes.new(name, kind, domain)
            assert attribute.name == name, (attribute.name, name)
            values = wanted(kind, places, salt)
            attribute.data.foreach_set(
                field, values.astype(np.float32 if kind not in WHOLE else np.int32).ravel()
            )
            made[name] = domain, kind, salt
for name in ("Pin Group", "arm.L", "Group"):
    group = sheet.vertex_groups.new(name=name)
    for index, place in enumerate(here):
        group.add([index], float(place[0]), "REPLACE")
hold = sheet.vertex_groups.new(name="hold")
hold.add(np.flatnonzero(here[:, 0] < 0.01).tolist(), 1.0, "REPLACE")
sheet.toile.pin_group = "hold"
mesh.attributes.new("pair", "INT32_2D", "POINT")
number = mesh.attributes.new("number", "INT", "FACE")
number.data.foreach_set("value", np.arange(len(face), dtype=np.int32))
mesh.color_attributes.active_color_name = "plain_CORNER_BYTE_COLOR"
smooth = np.arange(len(face)) % 3 > 0
mesh.polygons.foreach_set("use_smooth", smooth)
small.settings("DRAPE")


def places_of(shown: bpy.types.Mesh) -> dict[str, np.ndarray]:
    """Where on the sheet the elements of the shown mesh are: by the UV map, 0 to 1."""
    uv = small.values(shown, "UVMap", "vector", 2)
    loops = np.array([loop.vertex_index for loop in shown.loops])
    vertex = np.zeros((len(shown.vertices), 2))
    vertex[loops] = uv
    return {"POINT": vertex, "CORNER": uv}


def wrong(shown: bpy.types.Mesh) -> list[str]:
    """Return what is not on the shown mesh as it is on the sheet."""
    found, places = [], places_of(shown)
    # A face has the values of one of the sheet's own.
    places["FACE"] = face[small.values(shown, "number", "value")[:, 0].astype(int)]
    for name, (domain, kind, salt) in made.items():
        attribute = shown.attributes.get(name)
        if attribute is None or (attribute.domain, attribute.data_type) != (domain, kind):
            found.append(f"{name}: {attribute and (attribute.domain, attribute.data_type)}")
            continue
        field, width = KINDS[kind]
        flat = np.empty(width * len(attribute.data), np.float32 if kind not in WHOLE else np.int32)
        if kind == "BOOLEAN":
            flat = flat.astype(bool)
        attribute.data.foreach_get(field, flat)
        off = flat.reshape(-1, width) - wanted(kind, places[domain], salt).reshape(-1, width).astype(float)
        limit = 0.02 if kind == "BYTE_COLOR" else 1e-5
        if np.abs(off).max() > limit:
            found.append(f"{name}: off by {np.abs(off).max():.3f}")
    added = {attribute.name for attribute in shown.attributes} - {
        attribute.name for attribute in mesh.attributes
    }
    found += [f"{name}: extra" for name in sorted(added)]
    return found


def flags(some: bpy.types.Mesh) -> list[object]:
    layers = some.uv_layers
    return [
        layers.active.name, [layer.name for layer in layers if layer.active_render],
        some.color_attributes.active_color_name, some.color_attributes.default_color_name,
        [layer.name for layer in layers if "UV" in layer.name],
    ]  # fmt: skip


found = {"count": len(made)}
bpy.ops.toile.dress()
shown = small.shown(sheet, 1)
found["faces"] = len(shown.polygons)
found["wrong"] = wrong(shown)
found["notes"] = sheet.toile.notes
own = small.values(shown, "number", "value")[:, 0].astype(int)
found["smooth"] = [polygon.use_smooth for polygon in shown.polygons] == smooth[own].tolist()
places = places_of(shown)["POINT"]
found["weights off"] = max(
    abs(entry.weight - places[vertex.index, 0])
    for vertex in shown.vertices
    for entry in vertex.groups
    if entry.group != hold.index
)
found["weights"] = min(len(vertex.groups) for vertex in shown.vertices if places[vertex.index, 0] > 0.01)

# Active and rendering UV maps, of plain and other names.
for name in [name for name in made if name != "plain_CORNER_BYTE_COLOR"]:
    mesh.attributes.remove(mesh.attributes[name])
for name in ("Second", "Another UV"):
    layer = mesh.uv_layers.new(name=name)
    layer.data.foreach_set("uv", (0.5 * corner[:, :2]).astype(np.float32).ravel())
found["flags"] = []
for active, renders in (("UVMap", "UVMap"), ("Second", "Second"), ("Another UV", "Another UV"),
                        ("UVMap", "Second"), ("Second", "Another UV")):  # fmt: skip
    mesh.uv_layers[renders].active_render = True
    mesh.uv_layers.active = mesh.uv_layers[active]
    bpy.ops.toile.dress()
    shown = small.shown(sheet, 1)
    uv = small.values(shown, "UVMap", "vector", 2)
    found["flags"].append(
        [
            flags(mesh), flags(shown),
            max(float(np.abs(small.values(shown, name, "vector", 2) - 0.5 * uv).max())
                for name in ("Second", "Another UV")),
        ]
    )  # fmt: skip
found["modifiers"] = [modifier.name for modifier in sheet.modifiers]
bpy.ops.toile.clear()
found["cleared"] = [len(sheet.modifiers), len(bpy.data.node_groups)]
toile.blender_addon.unregister()
print(json.dumps(found))
