"""Motion of a glTF file: the vertices under its first animation, sampled at regular times.

Nodes move by translation, rotation and scale; joints carry skinned vertices along; morph targets add to
positions. Khronos Group, glTF 2.0 specification, sections 3.5 to 3.7 and 3.11.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.sparse import csr_array

from toile.dressing.files.gltf_channel import Channel, unit_quaternions
from toile.dressing.files.gltf_file import GltfFile
from toile.dressing.files.surface_check import check_vertex_numbers
from toile.geometry.arrays import Float, Int
from toile.geometry.errors import InputError

KINDS = {"translation": "VEC3", "rotation": "VEC4", "scale": "VEC3", "weights": "SCALAR"}
"""What a channel can move, to the type of its values."""
AT_REST = {"translation": (0.0, 0.0, 0.0), "rotation": (0.0, 0.0, 0.0, 1.0), "scale": (1.0, 1.0, 1.0)}
TRIANGLES = 4
DRAWN_FLAT = (5, 6)
"""Modes of primitives that are triangles too, but strips and fans."""
STILL = 1e-6
"""Motion below this share of the size of the body is none: positions are single precision."""
MOST_FRAMES = 100_000
STAND_STILL = "; export it without animation to dress the body as it stands"


@dataclass(frozen=True, kw_only=True)
class SampledGltf:
    """Vertices over time in file units, shape (k, v, 3), faces, shape (f, 3), and a note on what was read."""

    frames: npt.NDArray[np.float32]
    faces: Int
    note: str


def read_animated_gltf(path: Path, fps: float) -> SampledGltf:
    """Return all triangles of the default scene, from the first to the last key of the first animation.

    Raises InputError naming what is broken, unsupported or missing, and what to do.
    """
    try:
        return _Motion(GltfFile(path), fps).sampled()
    except InputError:
        raise
    except (LookupError, TypeError, ValueError, AttributeError, OverflowError) as error:
        # JSON of any other shape than glTF's.
        reason = " ".join(f"{type(error).__name__}: {error}".split())
        raise InputError(f"{path}: is not valid glTF ({reason}); export it again", file=path) from error


class _Motion:
    """The first animation of a file, sampled."""

    def __init__(self, file: GltfFile, fps: float) -> None:
        self.file = file
        animation = file.entry("animations", 0)
        self.name = (
            f'the first animation ("{animation["name"]}")' if "name" in animation else "the first animation"
        )
        self.channels = self._channels(animation)
        keys = [channel.times for channel in self.channels.values()]
        start, end = min(times[0] for times in keys), max(times[-1] for times in keys)
        if end <= start:
            raise file.error(f"{self.name} has only one key and thus no motion", STAND_STILL)
        # Keys are single precision: the last may lie a hair before its frame.
        count = (end - start) * fps + 1e-3
        if count < 1.0:
            raise file.error(
                f"{self.name} lasts {end - start:.3g} s, less than a frame at {fps:g} per second",
                "; give more frames per second",
            )
        if count > MOST_FRAMES:
            raise file.error(f"{self.name} lasts {end - start:.4g} s, too long at {fps:g} frames per second")
        self.times = start + np.arange(int(count) + 1) / fps
        self.world = self._world()

    def sampled(self) -> SampledGltf:
        """Vertices over time, those that no triangle uses dropped, and faces."""
        pieces: list[npt.NDArray[np.float32]] = []
        triangles: list[Int] = []
        count = 0
        for node in self._shown():
            entry = self.file.entry("nodes", node)
            if "mesh" not in entry:
                continue
            mesh = self.file.entry("meshes", entry["mesh"])
            for number, primitive in enumerate(mesh["primitives"]):
                place = f"meshes[{entry['mesh']}].primitives[{number}]"
                mode = primitive.get("mode", TRIANGLES)
                if mode in DRAWN_FLAT:
                    raise self.file.error(f"{place} is a strip or fan", "; export it as triangles")
                if mode != TRIANGLES or "POSITION" not in primitive["attributes"]:
                    continue
                vertices, faces = self._primitive(node, mesh, primitive, place)
                pieces.append(vertices)
                triangles.append(faces + np.int32(count))
                count += vertices.shape[1]
        if not any(map(len, triangles)):
            raise self.file.error("holds no triangles", "; export the body as a surface mesh")
        used, corners = np.unique(np.concatenate(triangles), return_inverse=True)
        frames = np.concatenate(pieces, axis=1)[:, used]
        size = np.ptp(frames[0], axis=0).max()
        if not max(np.abs(frame - frames[0]).max() for frame in frames[1:]) > STILL * size:
            raise self.file.error(f"{self.name} moves no vertex", STAND_STILL)
        count = len(self.file.content["animations"])
        note = f"{self.name} of {self.times[-1] - self.times[0]:.3g} s was read"
        note += f", {count - 1} more not: what belongs together must be one animation." if count > 1 else "."
        return SampledGltf(
            frames=frames, faces=corners.reshape(-1, 3).astype(np.int32), note=note[0].upper() + note[1:]
        )

    def _channels(self, animation: dict[str, Any]) -> dict[tuple[int, str], Channel]:
        """Channels of the animation by node and what they move; those of other things are left out."""
        channels: dict[tuple[int, str], Channel] = {}
        for number, entry in enumerate(animation["channels"]):
            target = entry["target"]
            if "node" not in target or target["path"] not in KINDS:
                continue
            node = self.file.entry("nodes", target["node"])
            if "matrix" in node and target["path"] != "weights":
                raise self.file.error(
                    f"nodes[{target['node']}] is animated but has a matrix",
                    "; export it with translation, rotation and scale",
                )
            sampler = animation["samplers"][entry["sampler"]]
            place = f"animations[0].channels[{number}]"
            channels[target["node"], target["path"]] = self._channel(sampler, target["path"], place)
        if not channels:
            raise self.file.error(f"{self.name} moves neither nodes nor morph targets", STAND_STILL)
        return channels

    def _channel(self, sampler: dict[str, Any], path: str, place: str) -> Channel:
        """Keys of one channel."""
        times = self.file.numbers(sampler["input"], "SCALAR")[:, 0]
        if not len(times) or (np.diff(times) <= 0.0).any():
            raise self.file.error(f"{place}: the times of its keys do not rise")
        values = self.file.numbers(sampler["output"], KINDS[path])
        way = sampler.get("interpolation", "LINEAR")
        if way not in ("LINEAR", "STEP", "CUBICSPLINE"):
            raise self.file.error(
                f"{place}: unknown interpolation {way!r}; use LINEAR, STEP or CUBICSPLINE", ""
            )
        per_key = 3 if way == "CUBICSPLINE" else 1
        # Several morph weights per key are so many scalars.
        width = values.size // (per_key * len(times)) if path == "weights" else values.shape[1]
        if width < 1 or values.size != per_key * len(times) * width:
            raise self.file.error(f"{place} has {len(times)} keys, but {len(values)} values")
        keyed = values.reshape(len(times), per_key, width)
        return Channel(
            times=times,
            values=np.ascontiguousarray(keyed[:, per_key // 2]),
            tangents=np.ascontiguousarray(keyed[:, [0, 2]].swapaxes(0, 1)) if per_key == 3 else None,
            is_step=way == "STEP",
            is_rotation=path == "rotation",
        )

    def _moved(self, node: int, path: str) -> Float:
        """Value of a node's property over time, shape (k, c), or (1, c) where it stays."""
        if (node, path) not in self.channels:
            still = self.file.entry("nodes", node).get(path, AT_REST[path])
            found = np.array(still, np.float64).reshape(1, len(AT_REST[path]))
            found = unit_quaternions(found) if path == "rotation" else found
        else:
            found = self.channels[node, path].at(self.times)
        if not np.isfinite(found).all():
            raise self.file.error(f"nodes[{node}].{path} is of length zero or not finite")
        return found

    def _world(self) -> list[Float]:
        """Where every node is over time: matrices of shape (k or 1, 4, 4)."""
        entries = self.file.content.get("nodes", [])
        world: list[Float] = [np.empty(0)] * len(entries)
        children = {child for entry in entries for child in entry.get("children", ())}
        open_nodes = [(node, np.eye(4)[None]) for node in range(len(entries)) if node not in children]
        placed = 0
        while open_nodes:
            node, parent = open_nodes.pop()
            entry = self.file.entry("nodes", node)
            if len(world[node]):
                raise self.file.error(f"nodes[{node}] is the child of two nodes")
            world[node] = np.asarray(parent @ self._local(node, entry))
            placed += 1
            open_nodes += [(child, world[node]) for child in entry.get("children", ())]
        if placed < len(entries):
            raise self.file.error("its nodes are each other's children")
        return world

    def _local(self, node: int, entry: dict[str, Any]) -> Float:
        """Place of a node relative to its parent over time, shape (k or 1, 4, 4)."""
        if "matrix" in entry:
            return np.array(entry["matrix"], np.float64).reshape(1, 4, 4).swapaxes(1, 2)
        shift, turn, scale = (self._moved(node, path) for path in AT_REST)
        matrix = np.zeros((max(len(shift), len(turn), len(scale)), 4, 4))
        matrix[:, :3, :3] = _rotation(turn) * scale[:, None, :]
        matrix[:, :3, 3] = shift
        matrix[:, 3, 3] = 1.0
        return matrix

    def _shown(self) -> list[int]:
        """Nodes of the default scene, parents first; all nodes where there is no scene."""
        if not self.file.content.get("scenes"):
            return list(range(len(self.world)))
        waiting = list(
            reversed(self.file.entry("scenes", self.file.content.get("scene", 0)).get("nodes", []))
        )
        shown: list[int] = []
        while waiting:
            shown.append(waiting.pop())
            waiting += reversed(self.file.entry("nodes", shown[-1]).get("children", []))
        return shown

    def _primitive(
        self, node: int, mesh: dict[str, Any], primitive: dict[str, Any], place: str
    ) -> tuple[npt.NDArray[np.float32], Int]:
        """Vertices over time, in the world, and faces of one primitive of a node's mesh."""
        attributes = primitive["attributes"]
        rest = self.file.numbers(attributes["POSITION"], "VEC3")
        targets = [
            self.file.numbers(target["POSITION"], "VEC3") if "POSITION" in target else np.zeros_like(rest)
            for target in primitive.get("targets", ())
        ]
        if any(len(target) != len(rest) for target in targets):
            raise self.file.error(f"{place}: a morph target has not as many vertices as the mesh")
        weights = self._morph_weights(node, mesh, len(targets), place)
        faces = self._faces(primitive, len(rest), place)
        entry = self.file.entry("nodes", node)
        skin = None
        if "skin" in entry and "JOINTS_0" in attributes:
            skin = self._influences(attributes, len(rest), np.unique(faces), entry["skin"], place)
        bones = None if skin is None else self._bones(entry["skin"])
        frames = np.empty((len(self.times), len(rest), 3), np.float32)
        for k in range(len(self.times)):
            shape = rest.copy()
            for weight, target in zip(_of(weights, k), targets, strict=True):
                shape += weight * target
            if skin is None or bones is None:
                world = _of(self.world[node], k)
                frames[k] = np.einsum("ij,vj->vi", world[:3, :3], shape) + world[:3, 3]
            else:
                blended = (skin @ _of(bones, k)[:, :3].reshape(-1, 12)).reshape(-1, 3, 4)
                frames[k] = np.einsum("vij,vj->vi", blended[:, :, :3], shape) + blended[:, :, 3]
        if skin is None and np.linalg.det(self.world[node][0, :3, :3]) < 0.0:
            faces = faces[:, ::-1]
        return frames, faces

    def _faces(self, primitive: dict[str, Any], count: int, place: str) -> Int:
        """Triangles of a primitive of `count` vertices, shape (f, 3)."""
        corners = np.arange(count, dtype=np.float64)
        if "indices" in primitive:
            corners = self.file.numbers(primitive["indices"], "SCALAR").ravel()
        if len(corners) % 3:
            raise self.file.error(f"{place}.indices are {len(corners)}, which makes no whole triangles")
        faces = corners.reshape(-1, 3)
        check_vertex_numbers(self.file.path, faces.astype(np.int64), count, "export the body again")
        return faces.astype(np.int32)

    def _morph_weights(self, node: int, mesh: dict[str, Any], count: int, place: str) -> Float:
        """Weights of a primitive's morph targets over time, shape (k or 1, count)."""
        if (node, "weights") in self.channels:
            weights = self.channels[node, "weights"].at(self.times)
        else:
            still = self.file.entry("nodes", node).get("weights", mesh.get("weights", [0.0] * count))
            weights = np.array(still, np.float64)[None]
        if count and weights.shape[1] != count:
            raise self.file.error(f"{place} has {count} morph targets, but {weights.shape[1]} weights")
        return weights[:, :count]

    def _influences(
        self, attributes: dict[str, Any], count: int, used: Int, skin: Any, place: str
    ) -> csr_array:
        """Weights of the joints on every vertex, shape (v, joints); rows of `used` vertices have sum 1."""
        joints = len(self.file.entry("skins", skin)["joints"])
        numbers: list[Float] = []
        weights: list[Float] = []
        while f"JOINTS_{len(numbers)}" in attributes:
            numbers.append(self.file.numbers(attributes[f"JOINTS_{len(numbers)}"], "VEC4"))
            weights.append(self.file.numbers(attributes[f"WEIGHTS_{len(weights)}"], "VEC4"))
        joint, weight = np.hstack(numbers).astype(np.int64), np.hstack(weights)
        if len(joint) != count or joint.shape != weight.shape:
            raise self.file.error(f"{place}: JOINTS and WEIGHTS are not as many as its vertices")
        joint = np.where(weight == 0.0, 0, joint)
        if (joint >= joints).any():
            raise self.file.error(
                f"{place}: JOINTS reach {joint.max()}, but skins[{skin}] has {joints} joints"
            )
        total = weight.sum(axis=1)
        loose = used[total[used] <= 0.0]
        if len(loose):
            raise self.file.error(f"{place}: vertex {loose[0]} has no joint", "; weight it and export again")
        weight /= np.where(total > 0.0, total, 1.0)[:, None]
        rows = np.repeat(np.arange(count), joint.shape[1])
        return csr_array((weight.ravel(), (rows, joint.ravel())), shape=(count, joints))

    def _bones(self, skin: Any) -> Float:
        """Motion of the joints of a skin from where they were bound, shape (k or 1, joints, 4, 4)."""
        entry = self.file.entry("skins", skin)
        joints = entry["joints"]
        bind = np.broadcast_to(np.eye(4), (len(joints), 4, 4))
        if "inverseBindMatrices" in entry:
            bind = self.file.numbers(entry["inverseBindMatrices"], "MAT4").reshape(-1, 4, 4).swapaxes(1, 2)
        if len(bind) < len(joints):
            raise self.file.error(f"skins[{skin}] has {len(joints)} joints, but {len(bind)} matrices")
        for joint in joints:
            self.file.entry("nodes", joint)
        moved = [self.world[joint] @ inverse for joint, inverse in zip(joints, bind, strict=False)]
        count = max(len(matrices) for matrices in moved)
        return np.stack([np.broadcast_to(matrices, (count, 4, 4)) for matrices in moved], axis=1)


def _of(values: Float, k: int) -> Float:
    """Value of sample k of what moves, or the only one of what stays."""
    return np.asarray(values[min(k, len(values) - 1)])


def _rotation(quaternions: Float) -> Float:
    """Rotation matrices, shape (k, 3, 3), of unit quaternions (x, y, z, w), shape (k, 4)."""
    x, y, z, w = np.ascontiguousarray(quaternions.T)
    return np.stack(
        [
            np.stack([1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)], axis=1),
            np.stack([2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)], axis=1),
            np.stack([2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)], axis=1),
        ],
        axis=1,
    )
