"""A lead-in to a glTF animation: from a pose of rest to its first frame, in the space of the joints.

Rotations go the shorter way by spherical interpolation (Shoemake 1985), translations, scales and morph
weights along straight lines; all ease in and out.
"""

from pathlib import Path

import numpy as np

from toile.dressing.files.gltf.gltf_channel import Channel, unit_quaternions
from toile.dressing.files.gltf.gltf_clip import Clip, read_clip
from toile.dressing.files.gltf.gltf_file import GltfFile, checked_shape
from toile.dressing.files.gltf.gltf_pieces import GltfPiece, gltf_pieces
from toile.dressing.files.gltf.gltf_scene import GltfScene
from toile.dressing.files.gltf.rest_pose import Pose, bind_pose, carried, own_pose
from toile.dressing.files.leading.standing import eased, standing
from toile.geometry.arrays import Bool, Float

Channels = dict[tuple[int, str], Channel]
SAME = 1e-9
"""Values of two poses that differ by less are the same."""


def has_skeleton(path: Path) -> bool:
    """Whether a glTF file holds a skin with joints."""
    with checked_shape(path):
        return any(skin.get("joints") for skin in GltfFile(path).content.get("skins", []))


def read_lead_in(path: Path, clip: str | None, count: int, up: int) -> list[Float]:
    """Return what leads to a clip's first frame from each pose of rest: the nodes' own, that of binding.

    Parameters
    ----------
    path, clip
        The file, and the animation's name; None takes the first.
    count
        Frames of the lead-in; the clip's first is none of them.
    up
        Number of the axis that points up.

    Returns
    -------
    list of ndarray
        Vertices in file units, shape (count, v, 3), the same as those of `read_animated_gltf`; from the
        first frame on the body stands where the clip begins, and faces where it does.
    """
    with checked_shape(path):
        file = GltfFile(path)
        animation, goes = read_clip(file, clip), carried(file)
        found: list[Float] = []
        for pose in (own_pose(file), bind_pose(file)):
            if pose is not None:
                scene = GltfScene(file, np.append(eased(count), 1.0), joint_channels(file, animation, pose))
                frames, moves = _used_vertices(gltf_pieces(scene, np.float64), goes)
                if moves.any():
                    frames[:, moves] = standing(frames[:, moves], up)
                    found.append(frames[:-1])
        return found


def _used_vertices(pieces: list[GltfPiece], goes: set[int]) -> tuple[Float, Bool]:
    """Return the vertices that triangles use, (k, v, 3), and which of them belong to certain nodes, (v,)."""
    shown = [piece for piece in pieces if len(piece.faces)]
    used = [np.unique(piece.faces) for piece in shown]
    frames = [
        np.asarray(piece.frames[:, vertices], np.float64) for piece, vertices in zip(shown, used, strict=True)
    ]
    moves = [
        np.full(len(vertices), piece.number in goes) for piece, vertices in zip(shown, used, strict=True)
    ]
    return np.concatenate(frames, axis=1), np.concatenate(moves)


def joint_channels(file: GltfFile, clip: Clip, pose: Pose) -> Channels:
    """Return channels from a pose, at 0, to the first frame of a clip, at 1."""
    first = np.array([clip.start])
    own = own_pose(file)
    channels: Channels = {}
    for place in {**own, **clip.channels}:
        node, path = place
        if path == "weights":
            end = clip.channels[place].at(first)[0]
            start = _still_weights(file, node, len(end))
        else:
            start = pose[place]
            end = clip.channels[place].at(first)[0] if place in clip.channels else own[place]
        turns = path == "rotation"
        if turns:
            start, end = unit_quaternions(start[None])[0], unit_quaternions(end[None])[0]
        if place not in clip.channels and np.abs(start - end).max() < SAME:
            continue
        channels[place] = Channel(
            times=np.array([0.0, 1.0]), values=np.stack([start, end]), tangents=None, is_step=False,
            is_rotation=turns,
        )  # fmt: skip
    return channels


def _still_weights(file: GltfFile, node: int, count: int) -> Float:
    """Return the morph weights of a node without animation, shape (count,)."""
    entry = file.entry("nodes", node)
    mesh = file.entry("meshes", entry["mesh"]) if "mesh" in entry else {}
    weights = np.zeros(count)
    still = np.array(entry.get("weights", mesh.get("weights", [])), np.float64)[:count]
    weights[: len(still)] = still
    return weights
