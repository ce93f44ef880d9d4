"""What is read: valid small inputs of every kind, and the functions that read them."""

import io
import json
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import meshio
import numpy as np
import trimesh
from scipy.spatial.transform import Rotation

from tests.dressing.files.gltf_writer import Glb
from tests.fuzz import drawn, garments, measured
from tests.fuzz.usd_text import usds
from toile.dressing.batch.jobs_file import JobsFile
from toile.dressing.body.animated_avatar import is_animated, load_animated_avatar, load_posed_avatar
from toile.dressing.body.avatar import load_avatar
from toile.dressing.body.reading import Reading
from toile.dressing.garment.mesh_garment import read_mesh_garment
from toile.dressing.pattern.garmentcode import read_garmentcode
from toile.dressing.run.resolved_scene import resolve
from toile.dressing.run.scene_file import load_scene

Read = Callable[[Path], object]
SCENE = """
quality = "preview"
default_fabric = "cotton-poplin"
friction_between = [["my denim", "body", 0.6]]
max_frames = 20

[avatar]
file = "body.obj"
units = "cm"
time = 1.5
clip = "walk"

[air]
velocity = [0, 0, 2.5]
gusts = 0.1

[remesh]
size_min = 0.01
size_max = 0.05

[[garment]]
source = "tshirt"
fabric = "my denim"
pins = ["lower_interface", 3]
warp_angle = { front = 45.0 }

[fabric."my denim"]
like = "denim-12oz"
shear = 99
"""
TABLE = (
    "name,avatar,garment,fabric,quality,edge_length,units\n"
    "a,body.ply,tshirt,canvas,preview,0.02,m\nb,,tshirt; trousers,canvas; denim-12oz,,,\n"
)
LINES = (
    '{"name": "a", "avatar": "b.ply", "garment": ["tshirt"], "fabric": "canvas"}\n'
    '{"garment": [{"source": "tshirt", "pins": [3]}], "avatar": {"file": "b.glb", "time": 0.5}}\n'
)


@dataclass(frozen=True)
class Reader:
    """A kind of input: its valid files by ending, and every way in which it is read."""

    files: Callable[[], Iterable[tuple[str, bytes]]]
    reads: tuple[Read, ...]


def body() -> trimesh.Trimesh:
    """An egg as large as a body."""
    shape = trimesh.creation.icosphere(subdivisions=1)
    shape.apply_scale((0.2, 0.85, 0.12))
    shape.apply_translation((0.0, 0.85, 0.0))
    return shape


def patterns() -> Iterable[tuple[str, bytes]]:
    """Two panels with straight and curved edges, sewn together, with labels."""

    def panel(x: float) -> dict[str, Any]:
        edges: list[dict[str, Any]] = [{"endpoints": [i, (i + 1) % 4]} for i in range(4)]
        edges[0]["label"] = "lower_interface"
        edges[1]["curvature"] = {"type": "quadratic", "params": [[0.5, 0.1]]}
        edges[2]["curvature"] = {"type": "circle", "params": [15.0, 0, 1]}
        edges[3]["curvature"] = {"type": "cubic", "params": [[0.3, 0.1], [0.6, -0.1]]}
        return {
            "vertices": [[0, 0], [20, 0], [20, 20], [0, 20]], "edges": edges, "translation": [x, 100, 30],
            "rotation": [0, 10, 0], "label": "body",
        }  # fmt: skip

    document = {
        "pattern": {
            "panels": {"left": panel(-25), "right": panel(5)}, "panel_order": ["left", "right"],
            "stitches": [[{"panel": "left", "edge": 1}, {"panel": "right", "edge": 3}]],
        },
        "properties": {"units_in_meter": 100, "curvature_coords": "relative", "normalized_edge_loops": True},
    }  # fmt: skip
    return [(".json", json.dumps(document).encode())]


def objs() -> Iterable[tuple[str, bytes]]:
    """A body, and a panel of one polygon with texture."""
    panel = "o panel\n" + "".join(
        f"v {x} {1 + y} 0.3\nvt {x} {y}\n" for x, y in [(0, 0), (2, 0), (2, 1), (1, 1), (0, 2)]
    )
    panel += "g front # the front\nf 1/1 2/2 3/3 \\\n 4/4 -1/-1\n"
    return [(".obj", str(body().export(file_type="obj")).encode()), (".obj", panel.encode())]


def plys() -> Iterable[tuple[str, bytes]]:
    """A body in text and in bytes."""
    quads = (
        "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
        "property float s\nproperty float t\nelement face 6\nproperty list uchar int vertex_indices\n"
    )
    quads += "end_header\n"
    quads += "".join(f"{x} {y} {z} {x} {y}\n" for x in (-0.3, 0.3) for y in (0, 1.6) for z in (-0.15, 0.15))
    quads += "4 0 1 3 2\n4 4 6 7 5\n4 0 4 5 1\n4 2 3 7 6\n4 0 2 6 4\n4 1 5 7 3\n"
    return [
        (".ply", bytes(body().export(file_type="ply"))),
        (".ply", bytes(body().export(file_type="ply", encoding="ascii"))),
        (".ply", quads.encode()),
    ]


def gltfs() -> Iterable[tuple[str, bytes]]:
    """A body on two bones with morph targets, texture and two animations; one of instances and strips."""
    shape = body()
    count = len(shape.vertices)
    glb = Glb()
    share = np.clip(shape.vertices[:, 1], 0.0, 1.0)
    attributes = {
        "JOINTS_0": glb.numbers(np.tile([0, 1, 0, 0], (count, 1)), "<u1"),
        "WEIGHTS_0": glb.numbers(np.column_stack([1.0 - share, share, 0 * share, 0 * share])),
        "TEXCOORD_0": glb.numbers(shape.vertices[:, :2]),
    }
    targets = [{"POSITION": glb.numbers(0.01 * shape.vertices)}]
    mesh = glb.mesh(shape.vertices, shape.faces, attributes=attributes, targets=targets, material=0)
    glb.add("materials", name="skin")
    tip = glb.node(root=False, translation=[0.0, 0.5, 0.0], rotation=[0.0, 0.0, 0.0, 1.0])
    base = glb.node(children=[tip], scale=[1.0, 1.0, 1.0])
    bind = np.stack([np.eye(4), np.eye(4)])
    bind[1, 1, 3] = -0.5
    skin = glb.add("skins", joints=[base, tip], inverseBindMatrices=glb.numbers(bind.swapaxes(1, 2)))
    skinned = glb.node(mesh=mesh, skin=skin, weights=[0.5])
    glb.animate(tip, "rotation", [0.0, 0.2], Rotation.from_euler("z", [[0.0], [0.3]]).as_quat())
    glb.animate(skinned, "weights", [0.0, 0.2], [0.0, 1.0], "STEP")
    glb.animate(base, "translation", [0.0, 0.2], np.zeros((6, 3)), "CUBICSPLINE")
    other = Glb()
    strip = other.mesh(np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0.1]]), np.arange(4), mode=5)
    shifts = {"TRANSLATION": other.numbers([[0.0, 0.0, 0.0], [0.0, 0.0, 0.5]])}
    other.node(mesh=strip, extensions={"EXT_mesh_gpu_instancing": {"attributes": shifts}})
    other.node(mesh=other.mesh(), matrix=np.eye(4).ravel().tolist())
    with TemporaryDirectory() as folder:
        return [
            (suffix, file.write(Path(folder) / f"a{suffix}").read_bytes())
            for file in (glb, other)
            for suffix in (".glb", ".gltf")
        ]


def vrms() -> Iterable[tuple[str, bytes]]:
    """The same bodies as avatars."""
    return [(".vrm", data) for suffix, data in gltfs() if suffix == ".glb"]


def npzs() -> Iterable[tuple[str, bytes]]:
    """A body that moves, one that stands still, and a garment."""
    shape = body()
    moving, still, garment = io.BytesIO(), io.BytesIO(), io.BytesIO()
    np.savez(still, v=shape.vertices, f=shape.faces)
    frames = np.stack([shape.vertices, np.add(shape.vertices, (0.0, 0.0, 0.01))])
    np.savez(moving, vertices=frames, faces=shape.faces, fps=24.0)
    corners = np.array([[0.0, 1.0, 0.3], [0.2, 1.0, 0.3], [0.2, 1.2, 0.3], [0.0, 1.2, 0.3]])
    np.savez_compressed(
        garment, vertices=corners, faces=np.array([[0, 1, 2], [0, 2, 3]]), uv=corners[:, :2],
        uv_faces=np.array([[0, 1, 2], [0, 2, 3]]), panel=np.array([0, 0]), pins=np.array([1.0, 0.5, 0, 0]),
        stitches=np.array([[0, 3]]), held_lower_interface=np.array([0, 1]), fps=24.0,
        motion=np.stack([corners, corners]),
    )  # fmt: skip
    return [(".npz", stream.getvalue()) for stream in (moving, still, garment)]


def vtus() -> Iterable[tuple[str, bytes]]:
    """A body with cell data, in text, in bytes, and compressed."""
    shape = body()
    mesh = meshio.Mesh(
        shape.vertices, [("triangle", shape.faces)],
        cell_data={"panel": [np.zeros(len(shape.faces), np.int32)]},
        point_data={"uv": shape.vertices[:, :2].copy()},
    )  # fmt: skip
    files = []
    with TemporaryDirectory() as folder:
        path = Path(folder) / "a.vtu"
        for options in ({"binary": False}, {"compression": None}, {"compression": "zlib"}):
            meshio.vtu.write(path, mesh, **options)
            files.append((".vtu", path.read_bytes()))
    return files


def pattern(path: Path) -> object:
    """Read a pattern, and mesh it coarsely."""
    from toile.dressing.garment.pattern_mesh import mesh_pattern

    return mesh_pattern(read_garmentcode(path), edge_length=0.05, curve_edge_length=0.05)


def moving_body(path: Path) -> object:
    """Read a body in motion where there is one, and at a time."""
    if not is_animated(path):
        return None
    load_posed_avatar(path, time=0.1, reading=Reading(units="m", up="y"))
    return load_animated_avatar(path, reading=Reading(units="m", up="y"))


BODY: Read = load_avatar
MESH: tuple[Read, ...] = (BODY, lambda path: read_mesh_garment(path, edge_length=0.5))
READERS: dict[str, Reader] = {
    "pattern": Reader(patterns, (pattern,)),
    "scene": Reader(lambda: [(".toml", SCENE.encode())], (lambda path: resolve(load_scene(path)),)),
    "jobs": Reader(
        lambda: [(".csv", TABLE.encode()), (".jsonl", LINES.encode())],
        (lambda path: list(JobsFile(path, {})),),
    ),
    "dxf": Reader(drawn.dxfs, (drawn.drawn, drawn.drawn_in_a_size)),
    "svg": Reader(drawn.svgs, (drawn.drawn,)),
    "seams": Reader(drawn.seams, (drawn.seams_file,)),
    "measurements": Reader(measured.measurements, (measured.measured_body,)),
    "placed": Reader(garments.placed_patterns, (garments.placed_pattern,)),
    "dirty": Reader(garments.dirty_meshes, (garments.one_layer, garments.two_layers)),
    "obj": Reader(objs, MESH),
    "ply": Reader(plys, MESH),
    "glb": Reader(gltfs, (*MESH, moving_body)),
    "vrm": Reader(vrms, (BODY, moving_body)),
    "npz": Reader(npzs, (moving_body, MESH[1])),
    "vtu": Reader(vtus, MESH),
}  # fmt: skip


if find_spec("pxr") is not None:
    READERS["usd"] = Reader(lambda: usds(body()), (moving_body,))


@cache
def valid_files(name: str) -> tuple[tuple[str, bytes], ...]:
    """Return the valid inputs of a reader: ending and content."""
    return tuple(READERS[name].files())
