"""Poses of rest of a skeleton in glTF, as the value of every property of every node.

Two are at hand: the nodes' own transforms, and where the skins were bound (inverse bind matrices). Khronos
Group, glTF 2.0 specification, sections 3.5 and 3.7.3.
"""

import numpy as np
from scipy.spatial.transform import Rotation

from toile.dressing.files.gltf.gltf_channel import unit_quaternions
from toile.dressing.files.gltf.gltf_file import GltfFile
from toile.dressing.files.gltf.gltf_scene import AT_REST, GltfScene
from toile.geometry.arrays import Float

Pose = dict[tuple[int, str], Float]
"""Values by number of the node and property, shape (c,)."""


def own_pose(file: GltfFile) -> Pose:
    """Return the transforms that the nodes have without animation."""
    pose: Pose = {}
    for node, entry in enumerate(file.content.get("nodes", [])):
        if "matrix" in entry:
            matrix = np.array(entry["matrix"], np.float64).reshape(4, 4).T
            pose |= {(node, path): value for path, value in parts_of(matrix).items()}
            continue
        for path, rest in AT_REST.items():
            pose[node, path] = np.array(entry.get(path, rest), np.float64)
    return pose


def bind_pose(file: GltfFile) -> Pose | None:
    """Return the pose in which the skins were bound; None where no skin says it.

    The topmost joint of the largest skin stays where its node rests; the others stand to it as they were
    bound, those of other skins by joints that they share with it.
    """
    scene = GltfScene(file, np.zeros(1), {})
    world = [matrices[0] for matrices in scene.world]
    parents = parents_of(file)
    bound: dict[int, Float] = {}
    skins = enumerate(file.content.get("skins", []))
    for number, skin in sorted(skins, key=lambda one: -len(one[1]["joints"])):
        if "inverseBindMatrices" not in skin:
            continue
        inverse = file.numbers(skin["inverseBindMatrices"], "MAT4").reshape(-1, 4, 4).swapaxes(1, 2)
        joints = skin["joints"]
        if len(inverse) < len(joints):
            raise file.error(f"skins[{number}] has {len(joints)} joints, but {len(inverse)} matrices")
        if (np.abs(np.linalg.det(inverse[: len(joints)])) < 1e-30).any():
            continue
        shared = next((place for place, joint in enumerate(joints) if joint in bound), None)
        if shared is not None:
            here = bound[joints[shared]] @ inverse[shared]
        else:
            top = min(range(len(joints)), key=lambda place: _depth(parents, joints[place]))
            here = world[joints[top]] @ inverse[top]
        for joint, matrix in zip(joints, inverse, strict=False):
            bound.setdefault(joint, here @ np.linalg.inv(matrix))
    if not bound:
        return None
    pose = own_pose(file)
    placed: dict[int, Float] = {}
    for node in sorted(range(len(world)), key=lambda node: _depth(parents, node)):
        parent = placed[parents[node]] if node in parents else np.eye(4)
        if node in bound:
            placed[node] = bound[node]
            local = np.asarray(np.linalg.solve(parent, bound[node]), np.float64)
            pose |= {(node, path): value for path, value in parts_of(local).items()}
        else:
            above = world[parents[node]] if node in parents else np.eye(4)
            placed[node] = parent @ np.linalg.solve(above, world[node])
    return pose


def parts_of(matrix: Float) -> dict[str, Float]:
    """Return translation, rotation (x, y, z, w) and scale of a transform without shear, shape (4, 4)."""
    scale = np.linalg.norm(matrix[:3, :3], axis=0)
    if np.linalg.det(matrix[:3, :3]) < 0.0:
        scale = scale * (-1.0, 1.0, 1.0)
    turn = Rotation.from_matrix(matrix[:3, :3] / np.where(scale == 0.0, 1.0, scale)).as_quat()
    return {
        "translation": np.array(matrix[:3, 3]),
        "rotation": unit_quaternions(np.asarray(turn)[None])[0],
        "scale": np.asarray(scale),
    }


def parents_of(file: GltfFile) -> dict[int, int]:
    """Return the parent of every node that has one."""
    entries = file.content.get("nodes", [])
    return {child: node for node, entry in enumerate(entries) for child in entry.get("children", ())}


def carried(file: GltfFile) -> set[int]:
    """Return the nodes in the trees that hold joints, and those whose mesh hangs on a skin."""
    parents, entries = parents_of(file), file.content.get("nodes", [])
    tops = {_top(parents, joint) for skin in file.content.get("skins", []) for joint in skin["joints"]}
    return {node for node, entry in enumerate(entries) if "skin" in entry or _top(parents, node) in tops}


def _top(parents: dict[int, int], node: int) -> int:
    while node in parents:
        node = parents[node]
    return node


def _depth(parents: dict[int, int], node: int) -> int:
    depth = 0
    while node in parents:
        node, depth = parents[node], depth + 1
    return depth
