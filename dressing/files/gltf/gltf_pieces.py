"""The triangles of a glTF scene, piece by piece: every primitive of every mesh that a node shows.

Joints carry skinned vertices along, whatever the place of their own node; morph targets add to positions.
Khronos Group, glTF 2.0 specification, section 3.7.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.sparse import csr_array

from toile.dressing.files.gltf.gltf_file import GltfFile
from toile.dressing.files.gltf.gltf_scene import GltfScene
from toile.dressing.files.surface_check import check_vertex_numbers
from toile.geometry.arrays import Float, Int

TRIANGLES, STRIP, FAN = 4, 5, 6
"""Modes of primitives that have area."""
MOST_NUMBERS = 400_000_000
"""Coordinates of vertices over time, of all instances, that are read: 3.2 GB in double precision."""


@dataclass(frozen=True, kw_only=True)
class GltfPiece:
    """One primitive where a node shows it.

    Attributes
    ----------
    number
        Number of the node.
    node
        Name of the node, of its mesh where it has none, or "" .
    material
        Name of the material, or "".
    frames
        Vertices over time in the world, shape (k, v, 3).
    faces
        Triangles, shape (f, 3).
    uv
        Texture coordinates of the vertices with v upwards, shape (v, 2), or None.
    """

    number: int
    node: str
    material: str
    frames: npt.NDArray[np.floating]
    faces: Int
    uv: Float | None


def gltf_pieces(scene: GltfScene, dtype: npt.DTypeLike) -> list[GltfPiece]:
    """Return the pieces in the order of nodes, instances and primitives, vertices in a precision.

    Raises InputError if there are no triangles.
    """
    pieces: list[GltfPiece] = []
    read = 0
    for node in scene.shown():
        entry = scene.file.entry("nodes", node)
        if "mesh" not in entry:
            continue
        mesh = scene.file.entry("meshes", entry["mesh"])
        places = scene.places(node)
        for number, primitive in enumerate(mesh["primitives"]):
            place = f"meshes[{entry['mesh']}].primitives[{number}]"
            if primitive.get("mode", TRIANGLES) not in (TRIANGLES, STRIP, FAN):
                continue
            if "POSITION" not in primitive["attributes"]:
                continue
            count = scene.file.size_of(primitive["attributes"]["POSITION"])
            read += 3 * count * len(places) * len(scene.times)
            if read > MOST_NUMBERS:
                raise scene.file.error("has too many vertices, frames or instances to be read", "")
            pieces += _instances(scene, node, mesh, primitive, places, place, dtype)
    if not any(len(piece.faces) for piece in pieces):
        raise scene.file.error(
            "holds no triangles (an empty mesh or a point cloud)", "; export a surface mesh"
        )
    return pieces


def _instances(
    scene: GltfScene, node: int, mesh: dict[str, Any], primitive: dict[str, Any], places: list[Float],
    place: str, dtype: npt.DTypeLike,
) -> list[GltfPiece]:  # fmt: skip
    """One primitive of a node's mesh at each of its places."""
    file, attributes = scene.file, primitive["attributes"]
    file.refuse_compression(primitive)
    # Of a surface that stands still, the vertices at fault are named once all are read.
    rest = file.numbers(attributes["POSITION"], "VEC3", finite=len(scene.times) > 1)
    targets = [
        file.numbers(target["POSITION"], "VEC3") if "POSITION" in target else np.zeros_like(rest)
        for target in primitive.get("targets", ())
    ]
    if any(len(target) != len(rest) for target in targets):
        raise file.error(f"{place}: a morph target has not as many vertices as the mesh")
    weights = scene.morph_weights(node, mesh, len(targets), place)
    faces = _faces(file, primitive, len(rest), place)
    entry = file.entry("nodes", node)
    skin = bones = None
    if "skin" in entry and "JOINTS_0" in attributes:
        skin = _influences(file, attributes, len(rest), np.unique(faces), entry["skin"], place)
        bones = scene.bones(entry["skin"])
        if len(places) != 1:
            raise file.error(f"nodes[{node}] is skinned and has instances", "; export it without instancing")
    names = {
        "node": str(entry.get("name", mesh.get("name", ""))),
        "material": str(file.entry("materials", primitive["material"]).get("name", ""))
        if "material" in primitive
        else "",
    }
    uv = _texture(file, attributes, len(rest), place)
    pieces: list[GltfPiece] = []
    for where in places:
        frames = np.empty((len(scene.times), len(rest), 3), dtype)
        for k in range(len(scene.times)):
            shape = rest.copy()
            for weight, target in zip(_of(weights, k), targets, strict=True):
                shape += weight * target
            if skin is None or bones is None:
                world = _of(where, k)
                # Where nothing moves, coordinates stay as they are, bit by bit.
                moved = shape if np.array_equal(world, np.eye(4)) else shape @ world[:3, :3].T + world[:3, 3]
                frames[k] = moved
            else:
                blended = (skin @ _of(bones, k)[:, :3].reshape(-1, 12)).reshape(-1, 3, 4)
                frames[k] = np.einsum("vij,vj->vi", blended[:, :, :3], shape) + blended[:, :, 3]
        mirrored = skin is None and np.linalg.det(where[0, :3, :3]) < 0.0
        pieces.append(
            GltfPiece(number=node, frames=frames, faces=faces[:, ::-1] if mirrored else faces, uv=uv, **names)
        )
    return pieces


def _faces(file: GltfFile, primitive: dict[str, Any], count: int, place: str) -> Int:
    """Triangles of a primitive of `count` vertices, shape (f, 3)."""
    corners = np.arange(count, dtype=np.int64)
    if "indices" in primitive:
        corners = file.numbers(primitive["indices"], "SCALAR").ravel().astype(np.int64)
    mode = primitive.get("mode", TRIANGLES)
    if mode == TRIANGLES:
        if len(corners) % 3:
            raise file.error(f"{place}.indices are {len(corners)}, which makes no whole triangles")
        faces = corners.reshape(-1, 3)
    elif mode == STRIP:
        faces = np.stack([corners[:-2], corners[1:-1], corners[2:]], axis=1)
        faces[1::2] = faces[1::2][:, [0, 2, 1]]
    else:
        faces = np.stack([np.full_like(corners[2:], corners[0]), corners[1:-1], corners[2:]], axis=1)
    if mode != TRIANGLES:
        # Strips turn corners by triangles without area.
        a, b, c = faces.T
        faces = faces[(a != b) & (b != c) & (c != a)]
    check_vertex_numbers(file.path, faces, count, "export it again")
    return faces.astype(np.int32)


def _texture(file: GltfFile, attributes: dict[str, Any], count: int, place: str) -> Float | None:
    """Texture coordinates of a primitive's vertices, v upwards as in OBJ, shape (v, 2)."""
    if "TEXCOORD_0" not in attributes:
        return None
    uv = file.numbers(attributes["TEXCOORD_0"], "VEC2")
    if len(uv) != count:
        raise file.error(f"{place}: TEXCOORD_0 are not as many as its vertices")
    return np.column_stack([uv[:, 0], 1.0 - uv[:, 1]])


def _influences(
    file: GltfFile, attributes: dict[str, Any], count: int, used: Int, skin: Any, place: str
) -> csr_array:
    """Weights of the joints on every vertex, shape (v, joints); rows of `used` vertices have sum 1."""
    joints = len(file.entry("skins", skin)["joints"])
    numbers: list[Float] = []
    weights: list[Float] = []
    while f"JOINTS_{len(numbers)}" in attributes:
        numbers.append(file.numbers(attributes[f"JOINTS_{len(numbers)}"], "VEC4"))
        weights.append(file.numbers(attributes[f"WEIGHTS_{len(weights)}"], "VEC4"))
    joint, weight = np.hstack(numbers).astype(np.int64), np.hstack(weights)
    if len(joint) != count or joint.shape != weight.shape:
        raise file.error(f"{place}: JOINTS and WEIGHTS are not as many as its vertices")
    joint = np.where(weight == 0.0, 0, joint)
    if (joint >= joints).any() or (joint < 0).any():
        raise file.error(f"{place}: JOINTS reach {joint.max()}, but skins[{skin}] has {joints} joints")
    total = weight.sum(axis=1)
    loose = used[total[used] <= 0.0]
    if len(loose):
        raise file.error(f"{place}: vertex {loose[0]} has no joint", "; weight it and export again")
    weight /= np.where(total > 0.0, total, 1.0)[:, None]
    rows = np.repeat(np.arange(count), joint.shape[1])
    return csr_array((weight.ravel(), (rows, joint.ravel())), shape=(count, joints))


def _of(values: Float, k: int) -> Float:
    """Value of sample k of what moves, or the only one of what stays."""
    return np.asarray(values[min(k, len(values) - 1)])
