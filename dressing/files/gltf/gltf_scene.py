"""Where the nodes, instances, bones and morph weights of a glTF file are, at given times or at rest.

Khronos Group, glTF 2.0 specification, sections 3.5 to 3.7; EXT_mesh_gpu_instancing and KHR_node_visibility.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from toile.dressing.files.gltf.gltf_channel import Channel, unit_quaternions
from toile.dressing.files.gltf.gltf_file import GltfFile
from toile.geometry.arrays import Float

AT_REST = {"translation": (0.0, 0.0, 0.0), "rotation": (0.0, 0.0, 0.0, 1.0), "scale": (1.0, 1.0, 1.0)}
INSTANCING = "EXT_mesh_gpu_instancing"
INSTANCE_TYPES = {"translation": "VEC3", "rotation": "VEC4", "scale": "VEC3"}
VISIBILITY = "KHR_node_visibility"


class GltfScene:
    """The nodes of a file over time.

    Attributes
    ----------
    file
        The file.
    times
        Times [s], shape (k,).
    world
        Where every node is: matrices of shape (k, 4, 4), or (1, 4, 4) where it stays.

    Raises
    ------
    InputError
        If nodes are not a forest or a value is not finite.
    """

    def __init__(self, file: GltfFile, times: Float, channels: Mapping[tuple[int, str], Channel]) -> None:
        self.file = file
        self.times = times
        self._channels = channels
        self.world = self._world()

    def shown(self) -> list[int]:
        """Nodes of the default scene that are visible, parents first; all nodes where there is no scene."""
        if not self.file.content.get("scenes"):
            return list(range(len(self.world)))
        scene = self.file.entry("scenes", self.file.content.get("scene", 0))
        waiting = list(reversed(scene.get("nodes", [])))
        shown: list[int] = []
        while waiting:
            entry = self.file.entry("nodes", node := waiting.pop())
            if entry.get("extensions", {}).get(VISIBILITY, {}).get("visible") is False:
                continue
            shown.append(node)
            waiting += reversed(entry.get("children", []))
        return shown

    def places(self, node: int) -> list[Float]:
        """Where the mesh of a node is, (k or 1, 4, 4): once for each instance."""
        extension = self.file.entry("nodes", node).get("extensions", {}).get(INSTANCING)
        if extension is None:
            return [self.world[node]]
        attributes = extension["attributes"]
        parts = {
            path: self.file.numbers(attributes[path.upper()], kind)
            for path, kind in INSTANCE_TYPES.items()
            if path.upper() in attributes
        }
        counts = {len(part) for part in parts.values()}
        if len(counts) != 1:
            raise self.file.error(f"nodes[{node}]: its instances are not as many in every attribute")
        count = counts.pop()
        shift, turn, scale = (parts.get(path, np.tile(rest, (count, 1))) for path, rest in AT_REST.items())
        turn = unit_quaternions(turn)
        if not np.isfinite(turn).all():
            raise self.file.error(f"nodes[{node}]: the rotation of an instance is of length zero")
        return [np.asarray(self.world[node] @ matrix) for matrix in matrices(shift, turn, scale)]

    def bones(self, skin: Any) -> Float:
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

    def morph_weights(self, node: int, mesh: dict[str, Any], count: int, place: str) -> Float:
        """Weights of a primitive's morph targets over time, shape (k or 1, count)."""
        if (node, "weights") in self._channels:
            weights = self._channels[node, "weights"].at(self.times)
        else:
            still = self.file.entry("nodes", node).get("weights", mesh.get("weights", [0.0] * count))
            weights = np.array(still, np.float64)[None]
        if count and weights.shape[1] != count:
            raise self.file.error(f"{place} has {count} morph targets, but {weights.shape[1]} weights")
        return weights[:, :count]

    def _world(self) -> list[Float]:
        """Where every node is over time."""
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
        if "matrix" in entry and not any((node, path) in self._channels for path in AT_REST):
            matrix = np.array(entry["matrix"], np.float64).reshape(1, 4, 4).swapaxes(1, 2)
            if not np.isfinite(matrix).all():
                raise self.file.error(f"nodes[{node}].matrix is not finite")
            return matrix
        return matrices(*(self._moved(node, path) for path in AT_REST))

    def _moved(self, node: int, path: str) -> Float:
        """Value of a node's property over time, shape (k, c), or (1, c) where it stays."""
        if (node, path) not in self._channels:
            still = self.file.entry("nodes", node).get(path, AT_REST[path])
            found = np.array(still, np.float64).reshape(1, len(AT_REST[path]))
            found = unit_quaternions(found) if path == "rotation" else found
        else:
            found = self._channels[node, path].at(self.times)
        if not np.isfinite(found).all():
            raise self.file.error(f"nodes[{node}].{path} is of length zero or not finite")
        return found


def matrices(shift: Float, turn: Float, scale: Float) -> Float:
    """Return transforms, shape (k, 4, 4), from k or 1 shifts, unit quaternions (x, y, z, w) and scales."""
    matrix = np.zeros((max(len(shift), len(turn), len(scale)), 4, 4))
    matrix[:, :3, :3] = _rotation(turn) * scale[:, None, :]
    matrix[:, :3, 3] = shift
    matrix[:, 3, 3] = 1.0
    return matrix


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
