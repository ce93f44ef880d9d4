"""Reads a glTF file as a surface that stands still: what a viewer shows, at rest or at a time."""

from collections import Counter
from pathlib import Path

import numpy as np

from toile.dressing.files.corner_surface import MeshFile, Surface
from toile.dressing.files.gltf.gltf_clip import Clip, read_clip
from toile.dressing.files.gltf.gltf_file import GltfFile, checked_shape
from toile.dressing.files.gltf.gltf_pieces import GltfPiece, gltf_pieces
from toile.dressing.files.gltf.gltf_scene import GltfScene
from toile.geometry.errors import InputError


def read_still_gltf(path: Path, *, time: float | None = None, clip: str | None = None) -> MeshFile:
    """Return the triangles of the default scene in file units; objects and materials are panels.

    Nodes, bones, morph weights and instances count as they rest, or as an animation has them at a time.

    Parameters
    ----------
    path
        A .glb or .gltf file.
    time
        Seconds on the clock of the animation's keys; None takes the pose at rest.
    clip
        Name of the animation; None takes the first.

    Raises
    ------
    InputError
        Naming what is broken, compressed or missing, and what to do.
    """
    with checked_shape(path):
        file = GltfFile(path)
        animation: Clip | None = None
        notes: tuple[str, ...] = ()
        if time is not None:
            if not np.isfinite(time):
                raise InputError(f"{path}: time must be finite, got {time}", file=path, field="time")
            animation = read_clip(file, clip)
            notes = (animation.note(f"was read at {time:g} s"),)
        scene = GltfScene(
            file, np.array([0.0 if time is None else time]), {} if animation is None else animation.channels
        )
        pieces = [piece for piece in gltf_pieces(scene, np.float64) if len(piece.faces)]
        return MeshFile(surface_of_pieces(pieces), notes)


def surface_of_pieces(pieces: list[GltfPiece]) -> Surface:
    """Return pieces in their first frame as one surface; objects and materials are its panels."""
    starts = np.cumsum([0, *(piece.frames.shape[1] for piece in pieces)])
    faces = np.concatenate([piece.faces + start for piece, start in zip(pieces, starts, strict=False)])
    faces = faces.astype(np.int32)
    uv = [piece.uv for piece in pieces if piece.uv is not None]
    textured = len(uv) == len(pieces)
    return Surface(
        positions=np.concatenate([np.asarray(piece.frames[0], np.float64) for piece in pieces]),
        faces=faces,
        uv=np.concatenate(uv) if textured else np.empty((0, 2)),
        uv_faces=faces if textured else np.full(faces.shape, -1, np.int32),
        panel=np.repeat(np.arange(len(pieces)), [len(piece.faces) for piece in pieces]).astype(np.int32),
        panel_names=_names(pieces),
        file_face=np.arange(len(faces), dtype=np.int32),
    )


def _names(pieces: list[GltfPiece]) -> tuple[str, ...]:
    """Return names of panels that the file gives: of the object, its material, and a number where alike."""
    if len(pieces) == 1:
        return ("garment",)
    objects = Counter(piece.node for piece in pieces)
    names: dict[str, None] = {}
    for piece in pieces:
        parts = [piece.node, piece.material if objects[piece.node] > 1 else ""]
        name = base = "_".join(part for part in parts if part) or "object"
        number = 2
        while name in names:
            name, number = f"{base}_{number}", number + 1
        names[name] = None
    return tuple(names)
